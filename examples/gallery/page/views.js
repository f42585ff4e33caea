// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The views of results. Each `show()` fills the scene and the controls, and returns functions that
// the page calls: `probe(index)` describes a point, `positions()` are the points that can be
// probed.

const count = (n) => n.toLocaleString('en');
const metres = (x, digits = 2) => x.toFixed(digits) + ' m';
/// A diameter is null or 0 if a tree ends below breast height.
const diameter = (x) => (x ? metres(x, 3) : 'not measured');
const millimetres = (x) => (1000 * x).toFixed(1) + ' mm';
const shareOf = (shown, all, what) =>
    shown < all ? `${count(shown)} of ${count(all)} ${what}` : `${count(all)} ${what}`;

/// Elements of the side panel, each with a label.
class Controls {
  constructor(parent) {
    this.parent = parent;
    parent.replaceChildren();
  }
  element(tag, properties, ...children) {
    const result = Object.assign(document.createElement(tag), properties);
    result.append(...children);
    return result;
  }
  row(...children) {
    const row = this.element('div', {className: 'row'}, ...children);
    this.parent.append(row);
    return row;
  }
  slider(label, {min, max, step, value, format = String}, change) {
    const id = 'slider' + this.parent.childElementCount;
    const output = this.element('output', {value: format(value)});
    output.setAttribute('for', id);
    const input = this.element('input', {id, type: 'range', min, max, step});
    input.value = value;
    input.addEventListener('input', () => {
      output.value = format(Number(input.value));
      input.setAttribute('aria-valuetext', output.value);
      change(Number(input.value));
    });
    input.setAttribute('aria-valuetext', output.value);
    this.row(this.element('label', {htmlFor: id}, label, output), input);
    return input;
  }
  checkbox(label, checked, change) {
    const input = this.element('input', {type: 'checkbox', checked});
    input.addEventListener('change', () => change(input.checked));
    this.row(this.element('label', {className: 'check'}, input, label));
    return input;
  }
  select(label, options, change) {
    const id = 'select' + this.parent.childElementCount;
    const input = this.element('select', {id});
    options.forEach((text, i) => input.append(this.element('option', {value: i}, text)));
    input.addEventListener('change', () => change(Number(input.value)));
    this.row(this.element('label', {htmlFor: id}, label), input);
    return input;
  }
  button(label, click) {
    const button = this.element('button', {type: 'button'}, label);
    button.addEventListener('click', click);
    return button;
  }
  buttons(legend, ...buttons) {
    const set = this.element('fieldset', {className: 'buttons'});
    if (legend) set.append(this.element('legend', {}, legend));
    set.append(...buttons);
    this.parent.append(set);
    return set;
  }
  note(text) {
    const note = this.element('p', {className: 'note'}, text);
    this.parent.append(note);
    return note;
  }
  /// A table; cells of the first column may have a colour as [text, colour].
  table(caption, heads, rows) {
    const head = this.element('tr', {}, ...heads.map((h) => this.element('th', {scope: 'col'}, h)));
    const body = rows.map(([first, ...cells]) => {
      const [text, color] = Array.isArray(first) ? first : [first];
      const name = this.element('th', {scope: 'row'});
      if (color) {
        const swatch = this.element('span', {className: 'swatch'});
        swatch.style.background = `rgb(${color})`;
        name.append(swatch);
      }
      name.append(text);
      return this.element('tr', {}, name, ...cells.map((cell) => this.element('td', {}, cell)));
    });
    this.parent.append(this.element(
        'table', {}, this.element('caption', {}, caption), this.element('thead', {}, head),
        this.element('tbody', {}, ...body)));
  }
}

/// Segments between consecutive nodes of branches, as both ends with radius.
function tubesOfBranches(nodes, radii, nodesOfBranch, offset = [0, 0, 0]) {
  const branches = nodes.length / 3 / nodesOfBranch;
  const ends = new Float32Array(8 * branches * (nodesOfBranch - 1));
  let at = 0;
  for (let b = 0; b < branches; ++b)
    for (let k = 0; k + 1 < nodesOfBranch; ++k)
      for (const i of [b * nodesOfBranch + k, b * nodesOfBranch + k + 1]) {
        for (let c = 0; c < 3; ++c) ends[at++] = nodes[3 * i + c] + offset[c];
        ends[at++] = radii[i];
      }
  return ends;
}

const colorOfOrder = (order) => distinct[Math.min(order, distinct.length - 1)];

const views = {
  scan: {
    tab: 'Skeleton',
    title: 'A scan and its skeleton',
    text: 'The scan of a tree, coloured by the branches that extract_tree_skeleton found in it. ' +
        'Point at a branch to see its radius.',
    show(data, renderer, controls) {
      const origin = originOf(data.points), positions = decodePoints(data.points, origin);
      const cylinderOf = decode(data.cylinder_of_point);
      const ends = decodePoints(data.cylinders.ends, origin);
      const radius = decodeLengths(data.cylinders.radius);
      const [error, branch, order] =
          ['radius_error', 'branch', 'order'].map((name) => decode(data.cylinders[name]));
      const none = radius.length;
      const tubes = new Float32Array(8 * none);
      for (let i = 0; i < none; ++i)
        for (const k of [0, 1]) {
          tubes.set(ends.subarray(6 * i + 3 * k, 6 * i + 3 * k + 3), 8 * i + 4 * k);
          tubes[8 * i + 4 * k + 3] = radius[i];
        }
      const schemes = [
        (i) => colorOfIndex(branch[i]), (i) => colorOfOrder(order[i]),
        (i) => colorOfFraction(1 - Math.log(radius[i] / 0.002) / Math.log(100))
      ];
      const ofPoint = (scheme) => (p) => cylinderOf[p] === none ? grey : scheme(cylinderOf[p]);
      renderer.frame(...innerBoundsOf(positions), data.up);
      const points =
          renderer.addPoints(positions, colorsOf(positions.length / 3, ofPoint(schemes[0])), 0.012);
      const skeleton = renderer.addTubes(tubes, colorsOf(none, schemes[0]));
      skeleton.visible = false;
      const layers = [['Points', points], ['Skeleton, with radii', skeleton]];
      if (data.mesh) {
        const mesh = renderer.addTriangles(
            decodePoints(data.mesh.points, origin), decode(data.mesh.corners), [0.66, 0.52, 0.39]);
        mesh.visible = false;
        layers.push(['Closed surface', mesh]);
      }
      for (const [name, layer] of layers)
        controls.checkbox(name, layer.visible, (isChecked) => {
          layer.visible = isChecked;
          renderer.redraw();
        });
      controls.select('Colours', ['by branch', 'by order of the branch', 'by radius'], (k) => {
        points.update(1, colorsOf(positions.length / 3, ofPoint(schemes[k])));
        skeleton.update(2, colorsOf(none, schemes[k]));
      });
      const {report} = data;
      if (report)
        controls.table('The tree', ['Order', 'Branches', 'Length'], [
          ['all', count(report.total.branches), metres(report.total.length, 1)],
          ...report.by_order.map(
              (row,
               k) => [[String(k), colorOfOrder(k)], count(row.branches), metres(row.length, 1)])
        ]);
      if (report)
        controls.note(
            `Height ${metres(report.height)}, diameter at breast height ` +
            `${diameter(report.diameter_at_breast_height)}, wood ` +
            `${(1000 * report.volume).toFixed(0)} litres.`);
      controls.note(
          shareOf(positions.length / 3, data.number_in_file, 'points') +
          ' are shown. Grey points belong to no branch.');
      return {
        positions: () => positions,
        probe(p) {
          const i = cylinderOf[p];
          if (i === none) return 'not part of a branch';
          return `branch ${branch[i] + 1}, order ${order[i]}\nradius ${millimetres(radius[i])}\n` +
              `standard error ${error[i] > 0 ? millimetres(error[i]) : 'unknown'}`;
        },
      };
    },
  },

  morph: {
    tab: 'Geodesic',
    title: 'Between two trees',
    text:
        'Two scanned trees, and the trees on the geodesic between them. orl_geodesic matches the ' +
        'branches and the points of both.',
    show(data, renderer, controls) {
      const origin = originOf(data.frames[0]), {lambdas} = data;
      const frames = data.frames.map((frame) => decodePoints(frame, origin));
      const positions = new Float32Array(frames[0]);
      const [low, high] = innerBoundsOf(frames[0]);
      renderer.frame(low, high, data.up);
      const colorAt = (frame) => colorsOf(
          frame.length / 3,
          (i) => colorOfFraction((frame[3 * i + 2] - low[2]) / (high[2] - low[2])));
      const points = renderer.addPoints(positions, colorAt(frames[0]), 0.016);
      const last = lambdas.length - 1;
      controls.slider(
          'Position λ on the geodesic',
          {min: 0, max: 1, step: 0.01, value: 0, format: (x) => x.toFixed(2)}, (lambda) => {
            const at = Math.max(lambdas[0], Math.min(lambdas[last], lambda));
            const k = Math.max(0, Math.min(last - 1, lambdas.findIndex((l) => l > at) - 1));
            const i = at >= lambdas[last] ? last - 1 : k;
            const t = (at - lambdas[i]) / (lambdas[i + 1] - lambdas[i]);
            points.update(0, mix(frames[i], frames[i + 1], t, positions));
          });
      controls.note(
          'At 0 the tree is the first one, at 1 the second one. Branches that only one of ' +
          'them has grow out of their parent, or shrink into it. Colours follow the height ' +
          'of the points in the first tree.');
      controls.note(
          `${lambdas.length} trees were computed; the page interpolates between them. ` +
          shareOf(positions.length / 3, data.number_in_file, 'points') + ' are shown.');
      return {};
    },
  },

  family: {
    tab: 'Family',
    title: 'The space of a family',
    text:
        'A family of trees has a mean and modes of variation. The sliders walk through the ' +
        'space of the first two modes.',
    show(data, renderer, controls) {
      const n = data.nodes_of_branch, order = decode(data.order), {side} = data;
      const origin = originOf(data.grid[0]), decodeTree = (tree) => decodePoints(tree, origin);
      const grid = data.grid.map(decodeTree), samples = data.samples.map(decodeTree);
      const allRadii = decodeLengths(data.radius), m = order.length * n;
      const radiiOf = (tree) => allRadii.subarray(tree * m, (tree + 1) * m);
      const nodes = new Float32Array(3 * m), radii = new Float32Array(m);
      const colors =
          colorsOf(order.length * (n - 1), (i) => colorOfOrder(order[Math.floor(i / (n - 1))]));
      const [low, high] = boundsOf(grid[(side * side - 1) / 2]);
      const width = 1.15 * Math.max(high[0] - low[0], high[1] - low[1]);
      const score = [0, 0];
      // Bilinear interpolation between the four trees of the grid around the scores.
      const walk = () => {
        const [a, b] = score.map((s) => (s + 2) / 4 * (side - 1));
        const [i, j] = [a, b].map((x) => Math.min(side - 2, Math.floor(x)));
        nodes.fill(0);
        radii.fill(0);
        for (const [di, dj] of [[0, 0], [0, 1], [1, 0], [1, 1]]) {
          const weight = (di ? a - i : 1 - a + i) * (dj ? b - j : 1 - b + j);
          const tree = (i + di) * side + j + dj, from = grid[tree], radius = radiiOf(tree);
          for (let k = 0; k < nodes.length; ++k) nodes[k] += weight * from[k];
          for (let k = 0; k < m; ++k) radii[k] += weight * radius[k];
        }
        return tubesOfBranches(nodes, radii, n);
      };
      const walked = renderer.addTubes(walk(), colors);
      const row = samples.map((tree, k) => {
        const place = [(k % 3 - 1) * width, (k < 3 ? 0.5 : -0.5) * width, 0];
        const layer =
            renderer.addTubes(tubesOfBranches(tree, radiiOf(grid.length + k), n, place), colors);
        layer.visible = false;
        return layer;
      });
      const frame = (isRow) => renderer.frame(
          isRow ? [-1.5 * width, -width, low[2]] : low,
          isRow ? [1.5 * width, width, high[2]] : high, data.up);
      frame(false);
      const sliders = data.shares.slice(0, 2).map(
          (share, k) => controls.slider(
              `Mode ${k + 1}, ${Math.round(100 * share)} % of the variance`, {
                min: -2,
                max: 2,
                step: 0.05,
                value: 0,
                format: (x) => `${x.toFixed(2)} sd`,
              },
              (value) => {
                score[k] = value;
                walked.update(0, walk());
              }));
      controls.select(
          'Shown', ['the tree of these scores', `${samples.length} random trees`], (k) => {
            walked.visible = k === 0;
            row.forEach((layer) => {
              layer.visible = k === 1;
            });
            sliders.forEach((slider) => {
              slider.disabled = k === 1;
            });
            frame(k === 1);
          });
      controls.note(
          'At 0 in both, the tree is the mean. A score of 1 is one standard deviation (sd).');
      controls.note(
          `The family has ${data.trees} trees, and ${count(order.length)} branches in all. ` +
          `${side * side} trees were computed on a grid; the page interpolates between them.`);
      const orders = [...new Set(order)].sort();
      controls.table(
          'Colours', ['Order', 'Branches'],
          orders.map(
              (k) => [[String(k), colorOfOrder(k)], count(order.filter((o) => o === k).length)]));
      return {};
    },
  },

  stand: {
    tab: 'Stand',
    title: 'A stand and its trees',
    text:
        'The scan of a stand, coloured by the trees that segment_trees found in it. Point at a ' +
        'tree to see its size.',
    show(data, renderer, controls) {
      const positions = decodePoints(data.points, originOf(data.points)), tree = decode(data.tree),
            none = data.number_of_trees;
      renderer.frame(...innerBoundsOf(positions), data.up);
      const colors = colorsOf(tree.length, (i) => tree[i] === none ? grey : colorOfIndex(tree[i]));
      const kept = tree.filter((t) => t !== none).length;
      const all = renderer.addPoints(positions, colors, 0.02);
      const trees = (data.report && data.report.trees) || [];
      controls.checkbox('Ground and other points', true, (isChecked) => {
        all.count = isChecked ? tree.length : kept;  // points of trees come first
        renderer.redraw();
      });
      controls.table(
          'Trees', ['', 'Height', 'Diameter'],
          trees.map(
              (t) => [
                  [`tree ${t.tree + 1}`, colorOfIndex(t.tree)], metres(t.height, 1),
                  diameter(t.diameter_at_breast_height)]));
      controls.note(
          'Diameters are those at breast height. ' +
          shareOf(positions.length / 3, data.number_in_file, 'points') + ' are shown.');
      return {
        positions: () => positions.subarray(0, 3 * all.count),
        probe(p) {
          if (tree[p] === none) return 'not part of a tree';
          const t = trees[tree[p]];
          return `tree ${tree[p] + 1}` +
              (t ? `\nheight ${metres(t.height, 1)}\ndiameter ` +
                       `${diameter(t.diameter_at_breast_height)}` :
                   '');
        },
      };
    },
  },

  deformation: {
    tab: 'Deformation',
    title: 'Before and after a deformation',
    text:
        'deform_point_set moved one part of this scan and held another. All other points ' +
        'followed as rigidly as possible.',
    show(data, renderer, controls) {
      const origin = originOf(data.rest), rest = decodePoints(data.rest, origin);
      const deformed = decodePoints(data.deformed, origin);
      const positions = new Float32Array(deformed), moved = new Float32Array(rest.length / 3);
      let most = 1e-30;
      for (let i = 0; i < moved.length; ++i) {
        moved[i] = Math.hypot(...[0, 1, 2].map((c) => deformed[3 * i + c] - rest[3 * i + c]));
        most = Math.max(most, moved[i]);
      }
      const [a, b] = [boundsOf(rest), boundsOf(deformed)];
      renderer.frame(
          a[0].map((x, c) => Math.min(x, b[0][c])), a[1].map((x, c) => Math.max(x, b[1][c])),
          data.up);
      const size = sizeOfPoints(rest, renderer.camera.radius);
      const points = renderer.addPoints(
          positions, colorsOf(moved.length, (i) => colorOfFraction(moved[i] / most)), size);
      controls.slider(
          'From rest to deformed', {
            min: 0,
            max: 1,
            step: 0.01,
            value: 1,
            format: (x) => `${Math.round(100 * x)} %`,
          },
          (t) => points.update(0, mix(rest, deformed, t, positions)));
      if (/^(dragon|armadillo)$/.test(data.name))
        controls.note('Model: Stanford 3D Scanning Repository.');
      controls.note('Colours show how far a point moved: brown points hardly, yellow points most.');
      controls.note(
          'Between the ends, the page moves points on straight lines. The live editor ' +
          'computes the shapes in between. ' +
          shareOf(moved.length, data.number_in_file, 'points') + ' are shown.');
      return {
        positions: () => positions,
        probe: (i) =>
            `moved by ${(100 * moved[i] / (2 * renderer.camera.radius)).toFixed(1)} % of the size`,
      };
    },
  },
};
