// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Times of the live editor of the gallery in headless Chromium:
//   node benchmark/web/measure_live_editor.mjs [PAGE] [CHROMIUM]

import {readdirSync, readFileSync, statSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {Browser} from '../../test/web/Browser.mjs';

const path = resolve(process.argv[2] || 'build/output/gallery/index.html');
const frames = 120, repetitions = 4;  // the fastest one is shown

// A drag back and forth. A frame ends when its pixels can be read, which waits for the drawing.
const drag = `(async () => {
  const box = canvas.getBoundingClientRect(), points = editor.session.points();
  const i = editor.owner.indexOf(1);
  const at = renderer.projector()(...points.subarray(3 * i, 3 * i + 3), []);
  const send = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, {
    pointerId: 1, button: 0, buttons: 1, clientX: box.left + x, clientY: box.top + y,
    bubbles: true}));
  canvas.setPointerCapture = () => {};
  action = {kind: 'drag', handle: 1, x: at[0], y: at[1]};
  pointers.set(1, [at[0], at[1]]);
  const solves = [], latencies = [], begin = performance.now();
  const first = performance.now();
  for (let k = 0; k < ${frames}; ++k) {
    const sent = performance.now();
    send('pointermove', at[0] + 60 * Math.sin(k / 10), at[1] + 30 * Math.sin(k / 7));
    await new Promise((done) => { renderer.afterDraw = done; });
    const {gl} = renderer;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    latencies.push(performance.now() - sent);
    solves.push(editor.solveTime);
  }
  const seconds = (performance.now() - first) / 1000;
  send('pointerup', at[0], at[1]);
  return {points: editor.owner.length, samples: editor.session.numberOfSamples,
          start: editor.secondsToStart, drawn: editor.owner.length / renderer.thinning,
          handles: editor.secondsToFactorize, rate: ${frames} / seconds, solves, latencies,
          memory: editor.session.module.HEAPU8.length / 1e6};
})()`;

/// Seconds of the processor that a process and its descendants have used (Linux).
function processorSeconds(root) {
  const processes = readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map((name) => {
    try {
      const fields = readFileSync(`/proc/${name}/stat`, 'utf8').split(') ')[1].split(' ');
      const [parent, user, system] = [1, 11, 12].map((k) => Number(fields[k]));
      return {id: Number(name), parent, ticks: user + system};
    } catch {
      return {};  // has ended
    }
  });
  const ids = new Set([root]);
  for (let n = 0; n < ids.size;) {
    n = ids.size;
    for (const {id, parent} of processes)
      if (ids.has(parent)) ids.add(id);
  }
  return processes.filter(({id}) => ids.has(id)).reduce((sum, {ticks}) => sum + ticks, 0) / 100;
}

const sorted = (values) => [...values].sort((a, b) => a - b);
const show = (name, values) => {
  const s = sorted(values);
  console.log(
      `${name}: median ${s[s.length >> 1].toFixed(1)} ms, 95 % below ` +
      `${s[Math.floor(0.95 * s.length)].toFixed(1)} ms`);
};

console.log(`page: ${(statSync(path).size / 1e6).toFixed(1)} MB`);
const browser = await Browser.start(process.argv[3] || 'chromium');
try {
  console.log((await browser.call('Browser.getVersion')).product);
  for (const [width, height] of [[1280, 800], [400, 800]]) {
    await browser.resize(width, height);
    await browser.call('Page.navigate', {url: 'about:blank'});
    const begin = Date.now();
    await browser.call('Page.navigate', {url: `${pathToFileURL(path).href}#live`});
    await browser.until(`document.documentElement?.dataset.ready === 'live'`, 'the editor');
    const seconds = (Date.now() - begin) / 1000;
    await browser.evaluate(drag);  // the browser optimises the code meanwhile
    const runs = [];
    const before = processorSeconds(browser.process.pid);
    for (let i = 0; i < repetitions; ++i) runs.push(await browser.evaluate(drag));
    const secondsOfFrame =
        (processorSeconds(browser.process.pid) - before) / (frames * repetitions);
    const r = runs.reduce((best, run) => run.rate > best.rate ? run : best);
    console.log(
        `window ${width} x ${height}: ${r.points} points, ${r.samples} samples; ready after ` +
        `${seconds.toFixed(1)} s, of which neighbours and samples ${
            r.start.toFixed(1)} s, handles ` +
        `${r.handles.toFixed(2)} s; ${r.memory.toFixed(0)} MB`);
    show('  solve', r.solves);
    show('  pointer to picture', r.latencies);
    console.log(
        `  frames per second: ${r.rate.toFixed(1)}, ${r.drawn.toFixed(0)} points drawn in each; ` +
                `processor time ${(1000 * secondsOfFrame).toFixed(0)} ms per frame`);
  }
} finally { await browser.close(); }
