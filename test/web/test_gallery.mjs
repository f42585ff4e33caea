// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the gallery in headless Chromium: node test_gallery.mjs PAGE [CHROMIUM]

import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {pathToFileURL} from 'node:url';

import {Browser, sleep} from './Browser.mjs';

const path = resolve(process.argv[2] || 'build/output/gallery/index.html');
if (!existsSync(path)) {
  console.log(`SKIPPED: ${path} is missing; ./run or ./run web writes it`);
  process.exit(0);
}
const page = pathToFileURL(path).href;
let browser, hasEditor, ids;

// Functions of the page: the share of pixels that are not background, and a checksum of all.
const helpers = `
  function picture() {
    renderer.thinning = 1;
    renderer.draw();
    const {gl, canvas} = renderer, {width, height} = canvas;
    const bytes = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    const background = renderer.background.map((x) => Math.round(255 * x));
    let filled = 0, sum = 0;
    for (let i = 0; i < bytes.length; i += 4) {
      if (background.some((x, c) => Math.abs(x - bytes[i + c]) > 2)) ++filled;
      sum = (31 * sum + bytes[i] + 257 * bytes[i + 1] + 65537 * bytes[i + 2]) % 4294967296;
    }
    return {share: filled / (width * height), sum};
  }
  function pageOf(x, y, z) {
    const box = canvas.getBoundingClientRect(), at = renderer.projector()(x, y, z, []);
    return [box.left + at[0], box.top + at[1]];
  }
  function drop(name, bytes) {
    const data = new DataTransfer();
    if (name) data.items.add(new File([new Uint8Array(bytes)], name));
    document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true}));
  }
  const messageText = () =>
    $('message').hidden ? '' : $('message').querySelector('span').textContent;
`;

const picture = () => browser.evaluate('picture()');
const message = () => browser.evaluate('messageText()');
const until = (expression, what) => browser.until(expression, what);

async function open(id) {
  await browser.call('Page.navigate', {url: 'about:blank'});
  await browser.call('Page.navigate', {url: `${page}#${id}`});
  await until(
      `document.documentElement?.dataset.ready === '${id}' ||
               document.getElementById('message')?.hidden === false`,
      `the view ${id}`);
  await browser.evaluate(helpers + '0');
}

async function dropFile(name, bytes) {
  await browser.evaluate(`document.documentElement.removeAttribute('data-ready');
    $('message').hidden = true; drop(${JSON.stringify(name)}, ${JSON.stringify([...Buffer.from(
      bytes)])})`);
  await until(`document.documentElement.dataset.ready || messageText()`, `the file ${name}`);
  return message();
}

function noErrors() {
  assert.deepEqual(browser.errors.splice(0), [], 'errors of the page');
}

before(async () => {
  browser = await Browser.start(process.argv[3] || process.env.CHROMIUM || 'chromium');
  await browser.resize(1280, 800);
  await open('live');
  ids = await browser.evaluate('datasets.map(({id}) => id)');
  hasEditor = await browser.evaluate(`typeof createEditor !== 'undefined'`);
  noErrors();
});

after(() => browser?.close());

test('every view fills a part of the canvas, and uses no network', async () => {
  assert.ok(ids.length >= 1, 'the page has views');
  for (const id of [...ids, 'live']) {
    await open(id);
    assert.equal(await message(), '', id);
    const {share} = await picture();
    assert.ok(share > 0.01 && share < 0.9, `${id} fills ${share} of the canvas`);
    noErrors();
  }
});

test('sliders can be moved by the keyboard, and change the picture', async () => {
  for (const id of ['morph', 'family', 'deformation'].filter((name) => ids.includes(name))) {
    await open(id);
    const n =
        await browser.evaluate(`document.querySelectorAll('#controls input[type=range]').length`);
    assert.ok(n >= 1, id);
    for (let k = 0; k < n; ++k) {
      const first = await picture();
      await browser.evaluate(
          `document.querySelectorAll('#controls input[type=range]')[${k}].focus()`);
      for (let i = 0; i < 12; ++i)
        await browser.key(id === 'deformation' ? 'ArrowLeft' : 'ArrowRight');
      assert.notEqual((await picture()).sum, first.sum, `slider ${k} of ${id}`);
    }
  }
  noErrors();
});

test('the pointer and the keyboard turn and zoom, and 0 shows everything again', async () => {
  await open(ids[0]);
  const home = await picture();
  await browser.drag([400, 400], [520, 430]);
  const turned = await picture();
  assert.notEqual(turned.sum, home.sum, 'drag');
  await browser.call(
      'Input.dispatchMouseEvent', {type: 'mouseWheel', x: 400, y: 400, deltaX: 0, deltaY: 300});
  await sleep(100);
  assert.ok((await picture()).share < 0.9 * turned.share, 'the wheel zooms out');
  await browser.evaluate('canvas.focus()');
  await browser.key('0');
  assert.equal((await picture()).sum, home.sum, '0');
  for (const key of ['ArrowLeft', 'ArrowUp', '+', '-']) {
    const last = await picture();
    await browser.key(key);
    assert.notEqual((await picture()).sum, last.sum, key);
  }
  noErrors();
});

test('the values of the skeleton appear under the pointer', async (t) => {
  if (!ids.includes('scan')) return t.skip('the page has no scan');
  await open('scan');
  // The foremost of the points near the lower end of the trunk.
  const [x, y] = await browser.evaluate(`(() => {
    const p = shown.positions(), [low, high] = innerBoundsOf(p);
    for (let i = 0; i < p.length; i += 3)
      if (p[i + 2] > low[2] + 0.1 * (high[2] - low[2])) {
        const at = pageOf(p[i], p[i + 1], p[i + 2]), box = canvas.getBoundingClientRect();
        const found = renderer.pick(p, at[0] - box.left, at[1] - box.top);
        if (found >= 0 && shown.probe(found).includes('radius')) return at;
      }
  })()`);
  await browser.mouse('mouseMoved', x, y);
  await until(`!$('probe').hidden`, 'the values');
  assert.match(
      await browser.evaluate(`$('probe').textContent`),
      /^branch \d+, order \d+\nradius [\d.]+ mm\nstandard error [\d.]+ mm$/);
  await browser.mouse('mouseMoved', 5, 70);
  await until(`$('probe').hidden`, 'no values beside the tree');
  for (const index of [1, 2])
    await browser.evaluate(
        `document.querySelectorAll('#controls input[type=checkbox]')[${index}].click()`);
  await browser.evaluate(`document.querySelectorAll('#controls input[type=checkbox]')[0].click()`);
  assert.ok((await picture()).share > 0.005, 'skeleton and surface without the points');
  noErrors();
});

test('pages fit the window, controls have names, and both themes can be read', async () => {
  for (const [width, scheme] of [[1280, 'light'], [400, 'dark'], [400, 'light'], [1280, 'dark']]) {
    await browser.resize(width, 800, scheme);
    for (const id of [...ids, 'live']) {
      await open(id);
      assert.equal(
          await browser.evaluate('document.documentElement.scrollWidth'), width,
          `${id} at ${width}`);
      assert.equal(await browser.evaluate('document.documentElement.dataset.theme'), scheme);
      const nameless = await browser.evaluate(
          `[...document.querySelectorAll('button, input:not([hidden]), select')]
        .filter((e) => !(e.labels && e.labels.length) && !e.textContent.trim())
        .map((e) => e.outerHTML)`);
      assert.deepEqual(nameless, [], id);
    }
  }
  const dark = await picture();
  await browser.evaluate(`$('theme').click()`);
  assert.notEqual((await picture()).sum, dark.sum, 'the switch of the theme');
  await browser.resize(1280, 800);
  noErrors();
});

test('tabs are changed by arrow keys', async () => {
  await open(ids[0]);
  await browser.evaluate(`document.querySelector('[role=tab][aria-selected=true]').focus()`);
  await browser.key('ArrowRight');
  const next = [...ids, 'live'][1];
  await until(`document.documentElement.dataset.ready === '${next}'`, next);
  noErrors();
});

// The largest distance of the points of a handle from rest, and of all points.
const distances = (handle) => browser.evaluate(`(() => {
  const points = editor.session.points(), {rest, owner} = editor;
  let ofHandle = 0, ofAll = 0;
  for (let i = 0; i < owner.length; ++i) {
    const d = Math.hypot(...[0, 1, 2].map((c) => points[3 * i + c] - rest[3 * i + c]));
    ofAll = Math.max(ofAll, d);
    if (owner[i] === ${handle}) ofHandle = Math.max(ofHandle, d);
  }
  return [ofHandle, ofAll].map((d) => d / renderer.camera.radius);
})()`);
const placeOfHandle = (handle) => browser.evaluate(`(() => {
  const points = editor.session.points(), box = canvas.getBoundingClientRect();
  for (let i = 0; i < editor.owner.length; ++i)
    if (editor.owner[i] === ${handle}) {
      const at = pageOf(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
      if (editor.handleAt(at[0] - box.left, at[1] - box.top) === ${handle}) return at;
    }
})()`);
const settled = () => until('!editor.isDirty && !renderer.request', 'the frame');
const press = (label) => browser.evaluate(
    `[...document.querySelectorAll('#controls button')].find((b) => b.textContent === '${
        label}').click()`);

test('handles are moved, turned and scaled by the pointer', async (t) => {
  if (!hasEditor) return t.skip('the page has no live editor; ./run web builds it');
  await open('live');
  const held = 0, moved = 1;
  for (const tool of ['Move', 'Turn', 'Scale']) {
    await press(tool);
    const [x, y] = await placeOfHandle(moved), before = await picture();
    await browser.drag([x, y], [x + 40, y - 30]);
    await settled();
    assert.ok((await distances(moved))[0] > 0.01, `${tool} moves the handle`);
    assert.equal((await distances(held))[0], 0, `${tool} leaves the other handle`);
    assert.notEqual((await picture()).sum, before.sum, tool);
    assert.match(await browser.evaluate(`$('status').value`), /Solved in \d+ ms/);
    await press('Undo');
    await settled();
    assert.ok((await distances(moved))[1] < 1e-6, `undo of ${tool}`);
  }
  noErrors();
});

test('handles are moved by the keyboard, added by a rectangle, and removed', async (t) => {
  if (!hasEditor) return t.skip('the page has no live editor; ./run web builds it');
  await open('live');
  await browser.evaluate('canvas.focus()');
  const shift = 8, control = 2;
  for (let i = 0; i < 3; ++i) await browser.key('ArrowRight', shift);
  await settled();
  assert.ok((await distances(1))[0] > 0.01, 'Shift and an arrow move the handle');
  for (let i = 0; i < 3; ++i) await browser.key('z', control);
  await settled();
  assert.ok((await distances(1))[1] < 1e-6, 'Ctrl+Z');
  await press('New handle');
  await browser.drag([300, 300], [700, 500]);
  await until('editor.handles.length === 3', 'a third handle');
  await press('New handle');
  await browser.drag([5, 60], [12, 66]);
  await until('messageText()', 'the sentence');
  assert.match(await message(), /rectangle contains no points/);
  await press('Remove handle');
  assert.equal(await browser.evaluate('editor.handles.length'), 2);
  await press('Reset');
  await settled();
  assert.ok((await distances(1))[1] < 1e-6, 'reset');
  noErrors();
});

test('files that are dropped are read', async () => {
  const n = 3000, values = [];
  for (let i = 0; i < n; ++i) values.push([500000 + Math.cos(i), 4e6 + Math.sin(i), 10 * i / n]);
  const header = (format, type) =>
      `ply\nformat ${format} 1.0\nelement vertex ${n}\nproperty ${type} x\n` +
      `property ${type} y\nproperty ${type} z\nend_header\n`;
  const binary = (isLittle) => {
    const bytes = Buffer.alloc(24 * n);
    values.flat().forEach(
        (v, i) => isLittle ? bytes.writeDoubleLE(v, 8 * i) : bytes.writeDoubleBE(v, 8 * i));
    return bytes;
  };
  const text = values.map((row) => row.join(' ')).join('\n');
  const files = {
    'little.ply':
        Buffer.concat([Buffer.from(header('binary_little_endian', 'double')), binary(true)]),
    'big.ply': Buffer.concat([Buffer.from(header('binary_big_endian', 'double')), binary(false)]),
    'ascii.ply': header('ascii', 'float') + text + '\n',
    'table.xyz': 'x y z\n' + text,
  };
  for (const [name, bytes] of Object.entries(files)) {
    assert.equal(await dropFile(name, bytes), '', name);
    assert.deepEqual(await browser.evaluate('[editor.owner.length, editor.cloud.name]'), [n, name]);
    const height =
        await browser.evaluate('(([low, high]) => high[2] - low[2])(boundsOf(editor.rest))');
    assert.ok(Math.abs(height - 10) < 0.02, `${name}: height ${height}`);
    assert.ok((await picture()).share > 0.002, name);
  }
  noErrors();
});

test('the tabs lead back from a dropped file', async () => {
  await open(ids[0]);
  assert.equal(await dropFile('three.xyz', '0 0 0\n1 0 0\n0 1 2\n'), '');
  for (const id of [ids[0], 'live']) {
    await browser.evaluate(`document.documentElement.removeAttribute('data-ready');
      $('tab-${id}').click()`);
    await until(`document.documentElement.dataset.ready === '${id}'`, id);
  }
  noErrors();
});

test('a bad file gives a sentence, and the page goes on', async () => {
  await open('live');
  const before = await browser.evaluate('editor.owner.length');
  const bad = {
    'empty.ply': ['', /empty\.ply is empty/],
    'cut.ply': [
      'ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\n' +
          'property float y\nproperty float z\nend_header\nabc',
      /cut\.ply ends in row 1 of 9/
    ],
    'flat.ply': [
      'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n' +
          'end_header\n1 2\n',
      /no property 'z'/
    ],
    'words.xyz':
        ['1 2 3\n4 five 6\n', /words\.xyz: line 2: expected three coordinates, found '4 five 6'/],
    'image.png': [Buffer.from([137, 80, 78, 71, 0, 0, 0, 13]), /neither a PLY file nor a table/],
    'infinite.xyz': ['1 2 3\n1 2 1e999\n', /line 2: expected three coordinates/],
  };
  for (const [name, [bytes, expected]] of Object.entries(bad)) {
    assert.match(await dropFile(name, bytes), expected);
    assert.equal(
        await browser.evaluate('editor.owner.length'), before, 'the cloud before it remains');
  }
  await dropFile('', '');
  assert.match(await message(), /No file was dropped/);
  if (hasEditor)
    assert.match(await dropFile('one_place.xyz', '1 2 3\n1 2 3\n1 2 3\n'), /pcs::|points/);
  await open('live');
  assert.ok((await picture()).share > 0.01);
  noErrors();
});

test('a page without the editor says how it is built', async () => {
  await open(ids[0]);
  await browser.evaluate(`window.createEditor = undefined; location.hash = 'live'`);
  await until(`document.documentElement.dataset.ready === 'live'`, 'the view');
  assert.match(
      await browser.evaluate(`$('controls').textContent`),
      /not part of this page. .\/run web builds it/);
  assert.ok((await picture()).share > 0.01, 'the model is shown');
  noErrors();
});
