// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Decodes the arrays of the page, and makes colours.

const arrayTypes = {
  u8: Uint8Array,
  u16: Uint16Array,
  u32: Uint32Array,
  f32: Float32Array
};

/// Returns the numbers of a description as a typed array.
function decode(description) {
  const text = atob(document.getElementById('array' + description.array).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return new arrayTypes[description.type](bytes.buffer);
}

/// The origin of a view. Single precision would round large coordinates, such as those of a map.
function originOf({scale, offset}) {
  return offset.some((x) => Math.abs(x) > 100 * 65535 * scale) ? offset : [0, 0, 0];
}

/// Returns coordinates x, y, z of points one after the other, relative to an origin.
function decodePoints(description, origin = [0, 0, 0]) {
  const numbers = decode(description), result = new Float32Array(numbers.length);
  const {scale, offset} = description;
  const shift = offset.map((x, c) => x - origin[c]);
  for (let i = 0; i < numbers.length; ++i) result[i] = shift[i % 3] + scale * numbers[i];
  return result;
}

function decodeLengths(description) {
  return Float32Array.from(decode(description), (number) => description.scale * number);
}

/// Returns the lowest and highest coordinates of points.
function boundsOf(positions) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    const c = i % 3;
    if (positions[i] < low[c]) low[c] = positions[i];
    if (positions[i] > high[c]) high[c] = positions[i];
  }
  return [low, high];
}

/// Bounds without the outermost points, which may be outliers.
function innerBoundsOf(positions) {
  const step = Math.max(1, Math.floor(positions.length / 3 / 20000)), low = [], high = [];
  for (let c = 0; c < 3; ++c) {
    const values = [];
    for (let i = c; i < positions.length; i += 3 * step) values.push(positions[i]);
    values.sort((a, b) => a - b);
    low.push(values[Math.floor(0.001 * values.length)]);
    high.push(values[Math.ceil(0.999 * values.length) - 1]);
  }
  return [low, high];
}

/// Estimates the distance between neighbours of a surface of points: the size of cells that hold
/// two points on average, for a subset, by bisection.
function spacingOf(positions) {
  const n = positions.length / 3, step = Math.max(1, Math.floor(n / 30000));
  const [low, high] = innerBoundsOf(positions);
  let fine = 0, coarse = Math.max(...low.map((x, c) => high[c] - x)) || 1;
  for (let pass = 0; pass < 12; ++pass) {
    const size = fine ? Math.sqrt(fine * coarse) : coarse / 64, cells = new Set();
    for (let i = 0; i < positions.length; i += 3 * step) {
      const [x, y, z] = [0, 1, 2].map((c) => Math.floor((positions[i + c] - low[c]) / size));
      cells.add((x * 73856093) ^ (y * 19349663) ^ (z * 83492791));
    }
    if (2 * cells.size * step > n) fine = size;
    else coarse = size;
    if (!fine) coarse = size;
  }
  return (fine || coarse) / Math.sqrt(2 * step);
}

/// The size at which points of a surface are drawn: without gaps, unless they are far apart.
function sizeOfPoints(positions, radius) {
  return Math.min(3.4 * spacingOf(positions), radius / 110);
}

/// Sets `result` to `(1 - t) a + t b`.
function mix(a, b, t, result) {
  for (let i = 0; i < a.length; ++i) result[i] = a[i] + t * (b[i] - a[i]);
  return result;
}

// ---- colours, as bytes

const grey = [138, 138, 134];
// Colours that differ for most forms of colour blindness (M. Okabe, K. Ito, 2008).
const distinct = [
  [140, 92, 56], [0, 114, 178], [0, 158, 115], [230, 159, 0], [204, 121, 167], [86, 180, 233],
  [213, 94, 0]
];

/// A colour for an index; neighbouring indices have different hues.
function colorOfIndex(i) {
  const hue = (i * 0.618034) % 1 * 6;
  return [5, 3, 1].map((n) => {
    const k = (n + hue) % 6;
    return Math.round(255 * (0.84 - 0.58 * Math.max(0, Math.min(k, 4 - k, 1))));
  });
}

/// From brown through green to yellow for 0 to 1.
function colorOfFraction(t) {
  const stops = [[112, 74, 50], [126, 112, 62], [84, 140, 78], [176, 186, 92]];
  const at = Math.max(0, Math.min(0.9999, t)) * (stops.length - 1), k = Math.floor(at);
  return stops[k].map((x, c) => Math.round(x + (at - k) * (stops[k + 1][c] - x)));
}

/// Returns four bytes for each of `n` elements, as graphics drivers expect.
function colorsOf(n, colorOf) {
  const result = new Uint8Array(4 * n);
  for (let i = 0; i < n; ++i) result.set(colorOf(i), 4 * i);
  return result;
}
