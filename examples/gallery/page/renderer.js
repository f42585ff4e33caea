// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Draws points, tubes and triangles with WebGL 2, and turns the camera around a target.
'use strict';

const fieldOfView = 40 * Math.PI / 180;

// The scene is drawn into a texture with depth. A second pass darkens pixels that lie behind their
// neighbours (eye-dome lighting: C. Boucheny, 2009), because points have no normals.
const shaders = {
  points: [
    `
    layout(location = 0) in vec3 position;
    layout(location = 1) in vec3 color;
    uniform mat4 view, projection;
    uniform float size, smallest;
    out vec3 shade;
    void main() {
      gl_Position = projection * (view * vec4(position, 1.0));
      gl_PointSize = clamp(size / gl_Position.w, smallest, 12.0);
      shade = color;
    }`,
    `
    in vec3 shade;
    out vec4 result;
    void main() {
      result = vec4(shade, 1.0);
    }`
  ],
  // A segment between two circles: a rectangle that faces the camera, shaded as a cylinder.
  tubes: [
    `
    layout(location = 0) in vec4 start;
    layout(location = 1) in vec4 end;
    layout(location = 2) in vec3 color;
    uniform mat4 view, projection;
    uniform float pixel;
    out vec3 shade;
    out float across;
    void main() {
      bool is_end = gl_VertexID > 1;
      vec3 a = (view * vec4(start.xyz, 1.0)).xyz, b = (view * vec4(end.xyz, 1.0)).xyz;
      vec3 here = is_end ? b : a;
      vec3 side = cross(b - a, here);
      side = length(side) > 0.0 ? normalize(side) : vec3(1.0, 0.0, 0.0);
      across = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
      float radius = max(is_end ? end.w : start.w, -0.7 * pixel * here.z);
      if (start == end) radius = 0.0;
      gl_Position = projection * vec4(here + across * radius * side, 1.0);
      shade = color;
    }`,
    `
    in vec3 shade;
    in float across;
    out vec4 result;
    void main() {
      result = vec4(shade * (0.55 + 0.45 * sqrt(max(0.0, 1.0 - across * across))), 1.0);
    }`
  ],
  triangles: [
    `
    layout(location = 0) in vec3 position;
    uniform mat4 view, projection;
    out vec3 place;
    void main() {
      vec4 p = view * vec4(position, 1.0);
      place = p.xyz;
      gl_Position = projection * p;
    }`,
    `
    in vec3 place;
    uniform vec3 color;
    out vec4 result;
    void main() {
      vec3 n = normalize(cross(dFdx(place), dFdy(place)));
      float light = abs(dot(n, normalize(vec3(0.3, 0.5, 0.8))));
      result = vec4(color * (0.35 + 0.65 * light), 1.0);
    }`
  ],
  lighting: [
    `
    void main() {
      gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
    }`,
    `
    uniform sampler2D scene, depths;
    uniform vec3 background;
    uniform vec2 range;
    uniform int reach, skipped; // of the neighbours
    out vec4 result;
    float depth(ivec2 at) {
      return texelFetch(depths, clamp(at, ivec2(0), textureSize(depths, 0) - 1), 0).r;
    }
    // Pixels with nearer pixels almost all around them are holes between points, and are filled.
    void main() {
      ivec2 at = ivec2(gl_FragCoord.xy), nearest = at;
      // the inverse distance from the camera is linear in the depth
      float a = 1.0 / range.x, b = 1.0 / range.x - 1.0 / range.y;
      float least = depth(at), own = 1.0 / (a - b * least), behind = 0.0;
      int nearer = 0;
      for (int k = 0; k < 9; k += skipped) {
        ivec2 other = at + reach * ivec2(k % 3 - 1, k / 3 - 1);
        float d = depth(other), step = max(0.0, own * (a - b * d) - 1.0);
        behind += step;
        nearer += step > 0.01 ? 1 : 0;
        if (d < least) { least = d; nearest = other; }
      }
      bool is_hole = nearer * skipped > 5;
      if (is_hole) at = nearest;
      bool is_empty = texelFetch(depths, at, 0).r == 1.0;
      vec3 color = is_empty ? background : texelFetch(scene, at, 0).rgb;
      float light = is_empty || is_hole ? 1.0 : exp(-min(behind * 10.0 * float(skipped), 0.9));
      result = vec4(color * light, 1.0);
    }`
  ],
};

class Renderer {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', {antialias: false, alpha: false});
    if (!this.gl)
      throw new Error(
          'This browser does not offer WebGL 2, which the gallery needs. ' +
          'Enable hardware acceleration, or use another browser.');
    this.layers = [];
    this.camera = {
      target: [0, 0, 0],
      radius: 1,
      distance: 4,
      size: [1, 1, 1],
      yaw: 0.6,
      pitch: 0.25,
      up: 'z'
    };
    this.background = [1, 1, 1];
    this.afterDraw = () => {};
    this.thinning = 1;  // every how many points are drawn
    this.programs = {};
    for (const [name, [vertex, fragment]] of Object.entries(shaders))
      this.programs[name] = this.link(vertex, fragment);
    this.gl.enable(this.gl.DEPTH_TEST);
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }

  link(...sources) {
    const gl = this.gl, program = gl.createProgram();
    sources.forEach((source, i) => {
      const shader = gl.createShader(i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(
          shader, '#version 300 es\nprecision highp float;\nprecision highp int;\n' + source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error('The graphics driver refused a shader: ' + gl.getProgramInfoLog(program));
    program.at = (name) => program[name] ??= gl.getUniformLocation(program, name);
    return program;
  }

  // ---- layers

  clear() {
    for (const layer of this.layers) {
      layer.buffers.forEach((buffer) => this.gl.deleteBuffer(buffer));
      this.gl.deleteVertexArray(layer.array);
    }
    this.layers = [];
    this.redraw();
  }

  /// Adds a layer with attributes [numbers, components, is normalised, divisor].
  add(kind, count, attributes) {
    const gl = this.gl, layer = {kind, count, visible: true, buffers: []};
    layer.array = gl.createVertexArray();
    gl.bindVertexArray(layer.array);
    attributes.forEach(([numbers, size, isNormalized, divisor], i) => {
      const buffer = gl.createBuffer();
      layer.buffers.push(buffer);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
      const type = numbers instanceof Float32Array ? gl.FLOAT : gl.UNSIGNED_BYTE;
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, type, isNormalized, 0, 0);
      gl.vertexAttribDivisor(i, divisor);
    });
    layer.update = (i, numbers) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, layer.buffers[i]);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, numbers);
      this.redraw();
    };
    this.layers.push(layer);
    this.redraw();
    return layer;
  }

  /// Points with three coordinates and four bytes of colour each; `size` in the unit of the scene.
  addPoints(positions, colors, size) {
    return Object.assign(
        this.add('points', positions.length / 3, [[positions, 3, false, 0], [colors, 4, true, 0]]),
        {size});
  }

  /// Tubes: x, y, z, radius of both ends, and four bytes of colour each.
  addTubes(ends, colors) {
    const gl = this.gl;
    const layer = this.add(
        'tubes', ends.length / 8,
        [[ends, 4, false, 1], [new Float32Array(4), 4, false, 1], [colors, 4, true, 1]]);
    gl.bindVertexArray(layer.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, layer.buffers[0]);  // both ends are in one buffer
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 32, 0);
    gl.vertexAttribPointer(1, 4, gl.FLOAT, false, 32, 16);
    return layer;
  }

  addTriangles(positions, corners, color) {
    const gl = this.gl, layer = this.add('triangles', corners.length, [[positions, 3, false, 0]]);
    gl.bindVertexArray(layer.array);
    layer.buffers.push(gl.createBuffer());
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, layer.buffers[1]);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    const type = corners instanceof Uint16Array ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
    return Object.assign(layer, {type, color});
  }

  // ---- camera

  /// Looks at a box from a distance at which it is completely visible.
  frame(low, high, up) {
    const camera = this.camera;
    camera.target = low.map((x, c) => (x + high[c]) / 2);
    camera.size = low.map((x, c) => high[c] - x);
    camera.radius = Math.hypot(...camera.size) / 2 || 1;
    camera.yaw = up === 'y' ? 0 : 0.6;
    camera.pitch = 0.2;
    camera.up = up;
    this.resize();
    this.home = {...camera};
    this.fit();
  }

  fit() {
    const camera = Object.assign(this.camera, this.home), {width, height} = this.canvas;
    const {right, above} = this.axes(), half = Math.tan(fieldOfView / 2);
    const extent = (axis) => axis.reduce((sum, a, c) => sum + Math.abs(a) * camera.size[c] / 2, 0);
    const wide = extent(right) / Math.max(0.1, width / Math.max(1, height));
    camera.distance = 1.08 * Math.max(wide, extent(above)) / half + 0.42 * camera.radius;
    this.redraw();
  }

  turn(yaw, pitch) {
    const limit = Math.PI / 2 - 0.01;
    this.camera.yaw += yaw;
    this.camera.pitch = Math.max(-limit, Math.min(limit, this.camera.pitch + pitch));
    this.redraw();
  }

  zoom(factor) {
    const {radius} = this.camera;
    this.camera.distance =
        Math.max(0.02 * radius, Math.min(20 * radius, this.camera.distance * factor));
    this.redraw();
  }

  /// Moves the target by pixels of the page.
  shift(x, y) {
    const {right, above} = this.axes(), size = this.unitOfPixel(this.camera.distance);
    this.camera.target = this.camera.target.map((t, c) => t - size * (x * right[c] - y * above[c]));
    this.redraw();
  }

  /// Unit vectors of the camera: to the right, upwards, and towards the viewer.
  axes() {
    const {yaw, pitch, up} = this.camera;
    const [s, c, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    const turned = (x, y, z) => up === 'y' ? [x, z, -y] : [x, y, z];
    return {
      right: turned(c, s, 0),
      above: turned(-s * sp, c * sp, cp),
      back: turned(s * cp, -c * cp, sp)
    };
  }

  /// Length of a pixel of the page at a distance from the camera.
  unitOfPixel(distance) {
    return 2 * distance * Math.tan(fieldOfView / 2) / Math.max(1, this.canvas.clientHeight);
  }

  matrices() {
    const {right, above, back} = this.axes(), {target, distance, radius} = this.camera;
    const eye = target.map((t, c) => t + distance * back[c]);
    const dot = (a) => -(a[0] * eye[0] + a[1] * eye[1] + a[2] * eye[2]);
    const view = [
      right[0], above[0], back[0], 0, right[1], above[1], back[1], 0, right[2], above[2], back[2],
      0, dot(right), dot(above), dot(back), 1
    ];
    const near = Math.max(0.005 * radius, distance - 3 * radius), far = distance + 4 * radius;
    const f = 1 / Math.tan(fieldOfView / 2);
    const aspect = this.canvas.width / Math.max(1, this.canvas.height);
    const projection = [
      f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
      2 * far * near / (near - far), 0
    ];
    return {view, projection, range: [near, far]};
  }

  /// Returns a function from coordinates to [x, y, distance from the camera] in pixels of the page.
  projector() {
    const {view: v, projection: p} = this.matrices();
    const w = this.canvas.clientWidth / 2, h = this.canvas.clientHeight / 2;
    return (x, y, z, out) => {
      const d = -(v[2] * x + v[6] * y + v[10] * z + v[14]);
      out[0] = w + w * p[0] * (v[0] * x + v[4] * y + v[8] * z + v[12]) / d;
      out[1] = h - h * p[5] * (v[1] * x + v[5] * y + v[9] * z + v[13]) / d;
      out[2] = d;
      return out;
    };
  }

  /// Returns the index of the foremost point within a few pixels, or -1.
  pick(positions, x, y, reach = 6) {
    const project = this.projector(), at = [0, 0, 0];
    let found = -1, least = Infinity;
    for (let i = 0; i < positions.length; i += 3) {
      project(positions[i], positions[i + 1], positions[i + 2], at);
      if (at[2] > 0 && at[2] < least && Math.abs(at[0] - x) < reach &&
          Math.abs(at[1] - y) < reach) {
        least = at[2];
        found = i / 3;
      }
    }
    return found;
  }

  // ---- drawing

  redraw() {
    this.request ??= requestAnimationFrame(() => {
      try {
        this.draw();  // changes during the call are drawn by it
      } finally { this.request = null; }
    });
  }

  /// Textures of the size of the canvas for colour and depth.
  resize() {
    const gl = this.gl, {canvas} = this;
    const ratio = Math.min(2, window.devicePixelRatio || 1) * (this.thinning > 2 ? 0.5 : 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    this.ratio = ratio;
    if (this.scene && canvas.width === width && canvas.height === height) return;
    Object.assign(canvas, {width, height});
    for (const texture of this.textures || []) gl.deleteTexture(texture);
    this.scene ??= gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.scene);
    this.textures = [
      [gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]
    ].map(([format, attachment], i) => {
      const texture = gl.createTexture();
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, texture, 0);
      return texture;
    });
  }

  draw() {
    this.resize();
    const gl = this.gl, {view, projection, range} = this.matrices(), {width, height} = this.canvas;
    const scale = height / 2 / Math.tan(fieldOfView / 2);  // pixels of a length at distance 1
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.scene);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...this.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const layer of this.layers.filter((l) => l.visible && l.count)) {
      const program = this.programs[layer.kind];
      gl.useProgram(program);
      gl.uniformMatrix4fv(program.at('view'), false, view);
      gl.uniformMatrix4fv(program.at('projection'), false, projection);
      gl.bindVertexArray(layer.array);
      if (layer.kind === 'points') {
        const n = this.thinning;
        gl.uniform1f(program.at('size'), layer.size * scale);
        gl.uniform1f(program.at('smallest'), 1.5 * this.ratio);
        [[gl.FLOAT, 12], [gl.UNSIGNED_BYTE, 4]].forEach(([type, bytes], i) => {
          gl.bindBuffer(gl.ARRAY_BUFFER, layer.buffers[i]);
          gl.vertexAttribPointer(i, i ? 4 : 3, type, i === 1, n * bytes, 0);
        });
        gl.drawArrays(gl.POINTS, 0, Math.floor(layer.count / n));
      } else if (layer.kind === 'tubes') {
        gl.uniform1f(program.at('pixel'), 1 / scale);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, layer.count);
      } else {
        gl.uniform3fv(program.at('color'), layer.color);
        gl.drawElements(gl.TRIANGLES, layer.count, layer.type, 0);
      }
    }
    const program = this.programs.lighting;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.useProgram(program);
    gl.bindVertexArray(null);
    gl.uniform1i(program.at('scene'), 0);
    gl.uniform1i(program.at('depths'), 1);
    gl.uniform3fv(program.at('background'), this.background);
    gl.uniform2fv(program.at('range'), range);
    gl.uniform1i(program.at('reach'), Math.max(1, Math.round(this.ratio)));
    gl.uniform1i(program.at('skipped'), this.thinning > 2 ? 2 : 1);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    this.adaptThinning();
    this.afterDraw();
  }

  /// Draws fewer points, then fewer pixels, while the picture moves, if the browser is slow.
  adaptThinning() {
    const now = performance.now(), interval = now - (this.lastDraw ?? -1e9);
    this.lastDraw = now;
    const isMoving = interval < 1000 && !this.isRefining;
    this.slow = isMoving && interval > 45 ? (this.slow || 0) + 1 : 0;
    if (this.slow > 2 && this.thinning < 8) {
      this.thinning *= 2;
      this.slow = 0;
    }
    this.isRefining = false;
    clearTimeout(this.refinement);
    if (this.thinning > 1)
      this.refinement = setTimeout(() => {
        this.thinning = 1;
        this.isRefining = true;
        this.redraw();
      }, 400);
  }
}
