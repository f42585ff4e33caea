// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The live editor: pcs::Point_set_deformation, compiled to WebAssembly, moves a cloud by handles.

const noHandle = 255, mostHandles = 200;
const restColor = [168, 160, 148];
const colorOfHandle = (h) => distinct[(h + 2) % distinct.length];

/// The product of two quaternions x, y, z, w: first `b`, then `a`.
function productOfTurns(a, b) {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]
  ];
}
function turnAbout(axis, angle) {
  const s = Math.sin(angle / 2);
  return [s * axis[0], s * axis[1], s * axis[2], Math.cos(angle / 2)];
}
const motionAtRest = () => ({scale: 1, turn: [0, 0, 0, 1], offset: [0, 0, 0]});

/// The session of pcs in WebAssembly. Every call throws an Error with the sentence of pcs.
class Session {
  static async load() {
    return new Session(await createEditor());
  }
  constructor(module) {
    this.module = module;
  }
  check(result) {
    if (result < 0) throw new Error(this.module.UTF8ToString(this.module._editor_error()));
    return result;
  }
  start(positions, numberOfSamples) {
    const n = positions.length / 3;
    this.check(this.module._editor_allocate(n));
    this.numberOfPoints = n;
    this.points().set(positions);
    this.numberOfSamples = this.check(this.module._editor_start(numberOfSamples));
  }
  /// The points of the session. Valid until the next call, which may move the memory.
  points() {
    const at = this.module._editor_points() / 4;
    return this.module.HEAPF32.subarray(at, at + 3 * this.numberOfPoints);
  }
  addHandle(indices) {
    this.check(this.module._editor_allocate_indices(indices.length));
    this.module.HEAPU32.set(indices, this.module._editor_indices() / 4);
    return this.check(this.module._editor_add_handle());
  }
  removeHandle(handle) {
    this.check(this.module._editor_remove_handle(handle));
  }
  move(handle, {scale, turn, offset}) {
    this.check(this.module._editor_move(handle, scale, ...turn, ...offset));
  }
  /// Makes the present shape the rest shape.
  accept() {
    this.check(this.module._editor_accept());
  }
  /// Solves and writes the points. `isWarm` continues from the last result.
  deform(isWarm) {
    const names =
        ['converged', 'iteration limit', 'nothing to do', 'cancelled', 'numerical failure'];
    return names[this.check(this.module._editor_deform(isWarm ? 1 : 0))];
  }
}

class LiveEditor {
  constructor(renderer, controls, cloud, showError) {
    Object.assign(this, {renderer, controls, cloud, showError});
    this.handles = [];  // {id of the session, indices, motion, center}
    this.past = [];
    this.tool = 'move';
    this.rest = cloud.positions;
    this.owner = new Uint8Array(this.rest.length / 3).fill(noHandle);
    this.frames = [];
  }

  /// Shows the cloud, and starts the session if the page has one.
  async open() {
    const {renderer, cloud} = this;
    renderer.frame(...boundsOf(this.rest), cloud.up);
    const size = sizeOfPoints(this.rest, renderer.camera.radius);
    this.layer = renderer.addPoints(this.rest, this.colors(), size);
    if (typeof createEditor === 'undefined') {
      this.controls.note(
          'The live editor is not part of this page. ./run web builds it. It needs ' +
          'Debian’s package emscripten.');
      return;
    }
    const note = this.controls.note(`Preparing ${count(this.owner.length)} points …`);
    await new Promise((resolve) => setTimeout(resolve, 30));  // the note appears before the work
    if (this.isClosed) return;
    const session = LiveEditor.session ??= await Session.load();
    if (this.isClosed) return;
    const begin = performance.now();
    try {
      session.start(this.rest, 2000);
    } catch (error) {
      note.textContent = 'These points cannot be deformed.';
      throw error;
    }
    this.session = session;
    this.secondsToStart = (performance.now() - begin) / 1000;
    note.remove();
    this.makeControls();
    this.renderer.afterDraw = () => this.measure();
    this.useDefaultHandles();
    this.past = [];
    this.undoButton.disabled = true;
  }

  close() {
    this.isClosed = true;
    this.renderer.afterDraw = () => {};
  }

  makeControls() {
    const {controls} = this;
    const tools =
        [['move', 'Move'], ['turn', 'Turn'], ['scale', 'Scale'], ['select', 'New handle']];
    const buttons = tools.map(([tool, label]) => controls.button(label, () => this.setTool(tool)));
    this.toolButtons = tools.map(([tool], i) => [tool, buttons[i]]);
    controls.buttons('Drag a coloured handle to', ...buttons);
    this.handleChoice = controls.select('Handle for the keyboard', [], (h) => {
      this.current = h;
    });
    this.undoButton = controls.button('Undo', () => this.undo());
    this.removeButton = controls.button('Remove handle', () => this.removeHandle());
    controls.buttons(
        '', this.undoButton, controls.button('Reset', () => this.reset()), this.removeButton);
    this.endSize = controls.slider(
        'Size of the ends', {
          min: 5,
          max: 45,
          step: 1,
          value: 15,
          format: (x) => `${x} %`,
        },
        () => this.useEnds());
    controls.buttons(
        '', controls.button('Hold both ends', () => this.useEnds()),
        controls.button('Change the up axis', () => this.turnUp()),
        controls.button('Save as PLY', () => this.save()));
    this.status = controls.element('output', {id: 'status', className: 'note'});
    this.status.setAttribute('aria-live', 'off');  // changes in every frame
    controls.row(this.status);
    this.setTool('move');
  }

  setTool(tool) {
    this.tool = tool;
    for (const [name, button] of this.toolButtons)
      button.setAttribute('aria-pressed', String(name === tool));
    this.renderer.canvas.classList.toggle('select', tool === 'select');
  }

  // ---- handles

  colors() {
    const colors = colorsOf(this.owner.length, () => restColor);
    this.handles.forEach(({indices}, h) => {
      const color = colorOfHandle(h);
      for (const i of indices) colors.set(color, 4 * i);
    });
    return colors;
  }

  /// Makes handles of lists of indices, at rest or with given motions, instead of the present ones.
  setHandles(lists, motions = []) {
    const begin = performance.now();
    this.handles.forEach(({id}) => this.session.removeHandle(id));
    this.handles = [];
    this.owner.fill(noHandle);
    lists.forEach((indices, h) => {
      const center = [0, 0, 0];
      for (const i of indices) {
        this.owner[i] = h;
        for (let c = 0; c < 3; ++c) center[c] += this.rest[3 * i + c] / indices.length;
      }
      const id = this.session.addHandle(indices);
      this.handles.push({id, indices, center, motion: motions[h] || motionAtRest()});
      this.session.move(id, this.handles[h].motion);
    });
    this.layer.update(1, this.colors());
    this.solve(false);
    this.secondsToFactorize = (performance.now() - begin) / 1000;
    this.handleChoice.replaceChildren(...lists.map(
        (list, h) => this.controls.element(
            'option', {value: h}, `handle ${h + 1}, ${count(list.length)} points`)));
    this.current = Math.max(0, lists.length - 1);
    this.handleChoice.value = this.current;
    this.removeButton.disabled = lists.length === 0;
    this.undoButton.disabled = this.past.length === 0;
  }

  /// The boxes of the edit that comes with a model, or both ends.
  useDefaultHandles() {
    const boxes = ((this.cloud.edit || {}).handles || []).map(({select}) => select && select.box);
    if (boxes.length < 2 || !boxes.every(Boolean)) return this.useEnds();
    const {origin} = this.cloud;
    const inBox = ([low, high]) => this.indicesWhere(
        (...p) => p.every((x, c) => x + origin[c] >= low[c] && x + origin[c] <= high[c]));
    return this.setHandles(boxes.map(inBox).filter((list) => list.length));
  }

  useEnds() {
    const [low, high] = boundsOf(this.rest), size = low.map((x, c) => high[c] - x);
    const axis = size.indexOf(Math.max(...size)), share = Number(this.endSize.value) / 100;
    const at = (value) => (value - low[axis]) / size[axis];
    this.remember();
    this.setHandles([(t) => t <= share, (t) => t >= 1 - share].map(
        (isEnd) => this.indicesWhere((...p) => isEnd(at(p[axis])))));
  }

  indicesWhere(isInside) {
    const indices = [], {rest} = this;
    for (let i = 0; i < this.owner.length; ++i)
      if (isInside(rest[3 * i], rest[3 * i + 1], rest[3 * i + 2])) indices.push(i);
    return indices;
  }

  /// Makes a handle of the points in a rectangle of the page that belong to no handle.
  selectBox(x0, y0, x1, y1) {
    const project = this.renderer.projector(), at = [0, 0, 0], points = this.session.points();
    const indices = [];
    for (let i = 0; i < this.owner.length; ++i) {
      if (this.owner[i] !== noHandle) continue;
      project(points[3 * i], points[3 * i + 1], points[3 * i + 2], at);
      if (at[2] > 0 && at[0] >= x0 && at[0] <= x1 && at[1] >= y0 && at[1] <= y1) indices.push(i);
    }
    if (indices.length === 0)
      throw new Error(
          'The rectangle contains no points that are free. Draw it around uncoloured points.');
    if (this.handles.length >= mostHandles)
      throw new Error(`There are ${mostHandles} handles, the most that the page shows.`);
    this.remember();
    this.acceptShape();
    this.setHandles([...this.handles.map(({indices: list}) => list), indices]);
    this.setTool('move');
  }

  /// Makes the present shape the rest shape, so that a new handle starts from it.
  acceptShape() {
    this.rest = this.session.points().slice();
    this.session.accept();
  }

  removeHandle() {
    this.remember();
    const kept = this.handles.filter((handle, h) => h !== this.current);
    this.setHandles(kept.map(({indices}) => indices), kept.map(({motion}) => motion));
  }

  // ---- motions

  remember() {
    this.past.push({
      rest: this.rest,
      lists: this.handles.map(({indices}) => indices),
      motions: this.handles.map(({motion}) => structuredClone(motion))
    });
    if (this.past.length > 50) this.past.shift();
    this.undoButton.disabled = false;
  }

  /// Starts again from another rest shape.
  restart(rest) {
    if (rest === this.rest) return;
    this.rest = rest;
    this.session.start(rest, 2000);
    this.handles = [];
  }

  undo() {
    const state = this.past.pop();
    if (!state) return;
    this.restart(state.rest);
    this.setHandles(state.lists, state.motions);
  }

  reset() {
    this.remember();
    const lists = this.handles.map(({indices}) => indices);
    this.restart(this.cloud.positions);
    this.setHandles(lists);
  }

  /// Applies the tool to a handle, by pixels of the page to the right and downwards.
  drag(h, x, y, isAboutView = false) {
    const {renderer} = this, {motion, center} = this.handles[h];
    const {right, above, back} = renderer.axes(), at = [0, 0, 0];
    if (this.tool === 'turn') {
      const turn = isAboutView ?
          turnAbout(back, -0.01 * x) :
          productOfTurns(turnAbout(above, 0.01 * x), turnAbout(right, 0.01 * y));
      const product = productOfTurns(turn, motion.turn), length = Math.hypot(...product);
      motion.turn = product.map((q) => q / length);
    } else if (this.tool === 'scale') {
      motion.scale = Math.max(0.05, Math.min(20, motion.scale * Math.exp(0.005 * (x - y))));
    } else {
      renderer.projector()(...center.map((p, c) => p + motion.offset[c]), at);
      const size = renderer.unitOfPixel(Math.max(at[2], 0.1 * renderer.camera.distance));
      motion.offset = motion.offset.map((o, c) => o + size * (x * right[c] - y * above[c]));
    }
    this.isDirty = true;
    renderer.redraw();
  }

  /// Solves for the present motions before the next frame is drawn.
  beforeDraw() {
    if (!this.isDirty || !this.session) return;
    this.isDirty = false;
    this.frames.push(performance.now());
    this.handles.forEach(({id, motion}) => this.session.move(id, motion));
    this.solve(true);
  }

  solve(isWarm) {
    const begin = performance.now();
    const status = this.session.deform(isWarm);
    this.solveTime = performance.now() - begin;
    this.isSolved = status !== 'numerical failure';
    this.layer.update(0, this.session.points());
    this.showStatus();
    if (!this.isSolved)
      throw new Error('The matrices of these handles cannot be factorised. Choose other handles.');
  }

  measure() {
    const now = performance.now();
    this.frames = this.frames.filter((time) => now - time < 1000);
  }

  showStatus() {
    const rate = this.frames.length > 1 ?
        (this.frames.length - 1) / (this.frames[this.frames.length - 1] - this.frames[0]) * 1000 :
        0;
    this.frameRate = rate;
    this.status.value =
        `${count(this.owner.length)} points, ${count(this.session.numberOfSamples)} ` +
        `samples. Solved in ${this.solveTime.toFixed(0)} ms` +
        (rate ? `, ${rate.toFixed(0)} frames per second.` : '.');
  }

  // ---- other controls

  turnUp() {
    this.cloud.up = this.cloud.up === 'y' ? 'z' : 'y';
    this.renderer.frame(...boundsOf(this.session.points()), this.cloud.up);
  }

  save() {
    const points = this.session.points(), {origin = [0, 0, 0], name} = this.cloud;
    const n = this.owner.length, isFar = origin.some((x) => x !== 0);
    const type = isFar ? 'double' : 'float', bytes = isFar ? 8 : 4;
    const header = new TextEncoder().encode(
        `ply\nformat binary_little_endian 1.0\nelement vertex ${n}\n` +
        ['x', 'y', 'z'].map((axis) => `property ${type} ${axis}\n`).join('') + 'end_header\n');
    const view = new DataView(new ArrayBuffer(3 * n * bytes));
    for (let i = 0; i < 3 * n; ++i)
      view[isFar ? 'setFloat64' : 'setFloat32'](i * bytes, points[i] + origin[i % 3], true);
    const link = this.controls.element('a', {
      href: URL.createObjectURL(new Blob([header, view])),
      download: `${name.replace(/\.[^.]*$/, '')}_deformed.ply`
    });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  /// The handle under a position of the page, or -1.
  handleAt(x, y) {
    if (!this.session || !this.session.numberOfPoints) return -1;
    const i = this.renderer.pick(this.session.points(), x, y);
    return i >= 0 && this.owner[i] !== noHandle ? this.owner[i] : -1;
  }
}
