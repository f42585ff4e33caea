// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The page: tabs, themes, pointer and keyboard, dropped files.

const $ = (id) => document.getElementById(id);
const canvas = $('canvas');
let renderer, editor = null, shown = null, current = '';
const datasets = JSON.parse($('views').textContent);

function showMessage(error) {
  const close = document.createElement('button');
  close.type = 'button';
  close.textContent = 'Close';
  close.addEventListener('click', () => {
    $('message').hidden = true;
  });
  const text = document.createElement('span');
  text.textContent = error.message || String(error);
  $('message').replaceChildren(text, close);
  $('message').hidden = false;
}

/// Calls a function, and shows its error as a sentence.
async function attempt(work) {
  try {
    await work();
  } catch (error) { showMessage(error); }
}

// ---- views

const liveText =
    'Drag the coloured handles. pcs deforms all points in every frame, in this browser.';
const keysOfViews =
    'Drag to turn, scroll to zoom, and drag with the right button to pan. On the ' +
    'keyboard: arrow keys turn, + and − zoom, 0 shows everything.';
const keysOfProbe = ' Enter shows the values at the centre.';
const keysOfEditor = ' Shift with the arrow keys applies the chosen tool to the handle of the ' +
    'keyboard, and Ctrl+Z undoes it.';

function start(id) {
  if (editor) editor.close();
  editor = shown = null;
  current = id;
  canvas.classList.remove('select');
  $('probe').hidden = $('message').hidden = true;
  document.documentElement.removeAttribute('data-ready');
  renderer.clear();
  for (const tab of $('tabs').children) {
    const isCurrent = tab.id === 'tab-' + id;
    tab.setAttribute('aria-selected', String(isCurrent));
    tab.tabIndex = isCurrent ? 0 : -1;
  }
  $('view').setAttribute('aria-labelledby', 'tab-' + id);
  return new Controls($('controls'));
}

function describe(title, text, keys) {
  $('title').textContent = title;
  $('text').textContent = text;
  $('keys').textContent = keysOfViews + keys;
  canvas.setAttribute('aria-label', title);
}

const markReady = () => {
  document.documentElement.dataset.ready = current;
};

function showView(id) {
  const controls = start(id), view = views[id];
  return attempt(() => {
    shown = view.show(datasets.find((data) => data.id === id), renderer, controls);
    describe(view.title, view.text, shown.probe ? keysOfProbe : '');
    markReady();
  });
}

/// Opens the editor with a cloud, or with the model of the page.
function showEditor(cloud) {
  const controls = start('live');
  describe('Live editor', liveText, keysOfEditor);
  const model = datasets.find((data) => data.id === 'deformation');
  if (!cloud && model) {
    const {rest, up, edit, name} = model, origin = originOf(rest);
    cloud = {positions: decodePoints(rest, origin), origin, up, edit, name};
  }
  return attempt(async () => {
    const opened = editor = cloud ? new LiveEditor(renderer, controls, cloud, showMessage) : null;
    try {
      if (opened) await opened.open();
    } finally {
      if (editor === opened && current === 'live') {
        addFileButton(controls);
        markReady();
      }
    }
  });
}

/// Files can be dropped, or chosen.
function addFileButton(controls) {
  const input = controls.element('input', {type: 'file', hidden: true});
  input.addEventListener('change', () => attempt(() => openFile(input.files[0])));
  controls.buttons('Your own points', controls.button('Open a file', () => input.click()), input);
  controls.note(
      'Drop a PLY file or a table of coordinates on the page, or open it here. The points ' +
      'stay on your computer.');
}

const show = (id) => id === 'live' ? showEditor() : showView(id);

function makeTabs() {
  const tabs = [...datasets.map(({id}) => [id, views[id].tab]), ['live', 'Live editor']];
  for (const [id, label] of tabs) {
    const tab = Object.assign(document.createElement('button'), {type: 'button', id: 'tab-' + id});
    tab.textContent = label;
    tab.setAttribute('role', 'tab');
    tab.setAttribute('aria-controls', 'view');
    tab.addEventListener('click', () => {
      if (location.hash === '#' + id) show(id);
      else location.hash = id;
    });
    $('tabs').append(tab);
  }
  $('tabs').addEventListener('keydown', (event) => {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!step) return;
    const all = [...$('tabs').children];
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.focus();
    next.click();
  });
  const open = () => {
    const id = location.hash.slice(1);
    return show(tabs.some(([name]) => name === id) ? id : tabs[0][0]);
  };
  window.addEventListener('hashchange', open);
  return open();
}

// ---- theme

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  const stage = getComputedStyle(document.documentElement).getPropertyValue('--stage').trim();
  renderer.background = [1, 3, 5].map((i) => parseInt(stage.slice(i, i + 2), 16) / 255);
  renderer.redraw();
  $('theme').textContent = theme === 'dark' ? 'Light colours' : 'Dark colours';
}

function initTheme() {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  let chosen = null;
  dark.addEventListener('change', () => chosen || setTheme(dark.matches ? 'dark' : 'light'));
  $('theme').addEventListener('click', () => {
    chosen = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    setTheme(chosen);
  });
  setTheme(dark.matches ? 'dark' : 'light');
}

// ---- pointer

const pointers = new Map();  // of the pointers that are down, by id
let action = null;           // {kind, handle, x, y}: what the first pointer does

function placeOf(event) {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

function beginAction(event) {
  const [x, y] = placeOf(event);
  if (event.button === 2 || event.button === 1 || event.ctrlKey) return {kind: 'shift', x, y};
  if (!editor || !editor.session) return {kind: 'turn', x, y};
  if (editor.tool === 'select') return {kind: 'select', x, y};
  const handle = editor.handleAt(x, y);
  if (handle < 0) return {kind: 'turn', x, y};
  editor.remember();
  editor.current = handle;
  editor.handleChoice.value = handle;
  return {kind: 'drag', handle, x, y};
}

function showBox(x, y) {
  const [left, top] = [Math.min(x, action.x), Math.min(y, action.y)];
  Object.assign($('box').style, {
    left: left + 'px',
    top: top + 'px',
    width: Math.abs(x - action.x) + 'px',
    height: Math.abs(y - action.y) + 'px'
  });
  $('box').hidden = false;
}

function moveAction(event, x, y) {
  const [dx, dy] = [x - action.x, y - action.y];
  if (action.kind === 'select') return showBox(x, y);
  if (action.kind === 'turn') renderer.turn(-0.008 * dx, 0.008 * dy);
  if (action.kind === 'shift') renderer.shift(dx, dy);
  if (action.kind === 'drag') editor.drag(action.handle, dx, dy, event.shiftKey);
  return Object.assign(action, {x, y});
}

function initPointer() {
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, placeOf(event));
    $('probe').hidden = true;
    canvas.classList.add('busy');
    action = pointers.size === 1 ? beginAction(event) : {kind: 'pinch'};
  });
  canvas.addEventListener('pointermove', (event) => {
    const [x, y] = placeOf(event);
    if (!action) return probeSoon(x, y);
    const before = pointers.get(event.pointerId);
    if (!before) return undefined;
    const other = [...pointers].find(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, [x, y]);
    if (action.kind !== 'pinch') return moveAction(event, x, y);
    if (!other) return undefined;
    const distance = ([a, b]) => Math.max(10, Math.hypot(a - other[1][0], b - other[1][1]));
    renderer.zoom(distance(before) / distance([x, y]));
    return renderer.shift((x - before[0]) / 2, (y - before[1]) / 2);
  });
  const end = (event) => {
    const [x, y] = placeOf(event), done = action;
    pointers.delete(event.pointerId);
    if (pointers.size) return;
    action = null;
    canvas.classList.remove('busy');
    $('box').hidden = true;
    if (done && done.kind === 'select' && event.type === 'pointerup')
      attempt(
          () => editor.selectBox(
              Math.min(x, done.x), Math.min(y, done.y), Math.max(x, done.x), Math.max(y, done.y)));
    if (event.pointerType === 'touch') probeSoon(x, y);
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('pointerleave', () => {
    $('probe').hidden = true;
  });
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    renderer.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.003));
  }, {passive: false});
}

let probePlace = null;

/// Shows the values under the pointer, at most once per frame.
function probeSoon(x, y) {
  if (!shown || !shown.probe) return;
  if (!probePlace)
    requestAnimationFrame(() => {
      const place = probePlace;
      probePlace = null;
      probe(...place);
    });
  probePlace = [x, y];
}

function probe(x, y) {
  if (!shown || !shown.probe) return;
  const i = renderer.pick(shown.positions(), x, y), box = $('probe');
  box.hidden = i < 0;
  if (i < 0) return;
  box.textContent = shown.probe(i);
  const {clientWidth, clientHeight} = canvas;
  box.style.left = Math.max(4, Math.min(x + 14, clientWidth - box.offsetWidth - 8)) + 'px';
  box.style.top = Math.max(4, Math.min(y + 14, clientHeight - box.offsetHeight - 8)) + 'px';
}

// ---- keyboard

const arrows = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1]
};

function initKeyboard() {
  canvas.addEventListener('keydown', (event) => {
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey && editor && editor.session && editor.handles.length) {
      if (editor.tool === 'select') editor.setTool('move');
      if (!event.repeat) editor.remember();
      editor.drag(editor.current, 12 * arrow[0], 12 * arrow[1]);
    } else if (arrow) {
      renderer.turn(0.12 * arrow[0], 0.12 * arrow[1]);
    } else if (event.key === '+' || event.key === '=') {
      renderer.zoom(1 / 1.15);
    } else if (event.key === '-' || event.key === '−') {
      renderer.zoom(1.15);
    } else if (event.key === '0' || event.key === 'Home') {
      renderer.fit();
    } else if (event.key === 'Enter') {
      probe(canvas.clientWidth / 2, canvas.clientHeight / 2);
    } else if (
        event.key.toLowerCase() === 'z' && (event.ctrlKey || event.metaKey) && editor &&
        editor.session) {
      attempt(() => editor.undo());
    } else {
      return;
    }
    event.preventDefault();
  });
}

// ---- dropped files

async function openFile(file) {
  if (file.size > 1e9)
    throw new Error(
        `${file.name} has more than 1 GB, the most that the page reads. Thin the file first.`);
  const buffer = await file.arrayBuffer().catch(() => {
    throw new Error(`${file.name} cannot be read. Drop one file, not a folder.`);
  });
  const cloud = readPoints(buffer, file.name);
  history.replaceState(null, '', '#live');
  await showEditor({...cloud, up: 'z'});
}

function initDrop() {
  let depth = 0;  // of dragenter minus dragleave
  const hint = (change) => {
    depth = Math.max(0, depth + change);
    $('drop').hidden = depth === 0;
  };
  addEventListener('dragenter', () => hint(1));
  addEventListener('dragleave', () => hint(-1));
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    hint(-depth);
    const [file] = event.dataTransfer.files;
    attempt(async () => {
      if (!file) throw new Error('No file was dropped. Drag a file from a folder onto the page.');
      await openFile(file);
    });
  });
}

attempt(async () => {
  try {
    renderer = new Renderer(canvas);
  } finally {
    if (!renderer) describe('pcs gallery', '', '');
  }
  const draw = renderer.draw.bind(renderer);
  renderer.draw = () => {
    if (editor) attempt(() => editor.beforeDraw());
    draw();
  };
  initTheme();
  initPointer();
  initKeyboard();
  initDrop();
  await makeTabs();
});
