// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the positions of points of a PLY file or a table of text. Errors are sentences.

const mostPoints = 4000000;  // the editor needs about 325 bytes for each, and has 2 GB

const plyTypes = {
  char: ['Int8', 1],
  int8: ['Int8', 1],
  uchar: ['Uint8', 1],
  uint8: ['Uint8', 1],
  short: ['Int16', 2],
  int16: ['Int16', 2],
  ushort: ['Uint16', 2],
  uint16: ['Uint16', 2],
  int: ['Int32', 4],
  int32: ['Int32', 4],
  uint: ['Uint32', 4],
  uint32: ['Uint32', 4],
  float: ['Float32', 4],
  float32: ['Float32', 4],
  double: ['Float64', 8],
  float64: ['Float64', 8],
};

/// Collects positions. The first point becomes the origin, because large coordinates would lose
/// digits in single precision.
class PositionList {
  constructor(n, name) {
    this.numbers = new Float32Array(3 * n);
    this.count = 0;
    this.name = name;
  }
  add(x, y, z, where) {
    if (!Number.isFinite(x + y + z))
      throw new Error(`${this.name}: ${where()}: a coordinate is not a finite number.`);
    this.origin ??= [x, y, z];
    if (3 * this.count === this.numbers.length) {
      const longer = new Float32Array(Math.max(3000, 2 * this.numbers.length));
      longer.set(this.numbers);
      this.numbers = longer;
    }
    const at = 3 * this.count++;
    this.numbers[at] = x - this.origin[0];
    this.numbers[at + 1] = y - this.origin[1];
    this.numbers[at + 2] = z - this.origin[2];
    checkCount(this.count, this.name);
  }
  result() {
    if (this.count === 0) throw new Error(`${this.name} has no points.`);
    return {positions: this.numbers.slice(0, 3 * this.count), origin: this.origin, name: this.name};
  }
}

function checkCount(n, name) {
  if (n > mostPoints)
    throw new Error(
        `${name} has more than ${mostPoints.toLocaleString('en')} points, ` +
        'the most that the editor takes. Thin the file first.');
}

/// Returns {format, elements, start}; `start` is the first byte after the header.
function readPlyHeader(bytes, name) {
  const fail = (line, what) => {
    throw new Error(`${name}: line ${line} of the PLY header: ${what}.`);
  };
  const header = {format: '', elements: [], start: 0};
  for (let number = 1;; ++number) {
    const end = bytes.indexOf(10, header.start);
    if (end < 0 || end - header.start > 10000)
      throw new Error(`${name}: the PLY header has no line \`end_header\`.`);
    const words = new TextDecoder().decode(bytes.subarray(header.start, end)).trim().split(/\s+/);
    header.start = end + 1;
    const element = header.elements[header.elements.length - 1];
    if (words[0] === 'end_header') break;
    if (words[0] === 'format') {
      header.format = words[1];
    } else if (words[0] === 'element') {
      if (!/^\d+$/.test(words[2]))
        fail(number, `expected a number of elements, found '${words[2] || ''}'`);
      header.elements.push({name: words[1], count: Number(words[2]), properties: []});
    } else if (words[0] === 'property') {
      const types = words[1] === 'list' ? words.slice(2, 4) : words.slice(1, 2);
      for (const type of types)
        if (!plyTypes[type]) fail(number, `unknown type '${type}'`);
      if (!element) fail(number, 'a property without an element');
      element.properties.push({name: words[words.length - 1], types, isList: words[1] === 'list'});
    }
  }
  if (!['ascii', 'binary_little_endian', 'binary_big_endian'].includes(header.format))
    throw new Error(
        `${name}: unknown PLY format '${header.format}'; expected ascii, ` +
        'binary_little_endian or binary_big_endian.');
  return header;
}

/// Calls `take(row)` with the numbers of each row of an element; returns the end of the element.
function readBinaryRows(view, at, element, isLittle, name, take) {
  const row = new Float64Array(element.properties.length);
  for (let i = 0; i < element.count; ++i) {
    try {
      element.properties.forEach((property, k) => {
        const [first, second] = property.types.map((type) => plyTypes[type]);
        row[k] = view['get' + first[0]](at, isLittle);
        at += first[1] + (property.isList ? row[k] * second[1] : 0);
      });
    } catch (error) {
      throw new Error(
          `${name} ends in row ${i + 1} of ${element.count} of the element ` +
          `'${element.name}'; it was probably not copied completely.`);
    }
    if (take) take(row, i);
  }
  return at;
}

function readPly(bytes, name) {
  const {format, elements, start} = readPlyHeader(bytes, name);
  const vertices = elements.find((element) => element.name === 'vertex');
  if (!vertices) throw new Error(`${name}: the PLY header has no element 'vertex'.`);
  const [x, y, z] = ['x', 'y', 'z'].map((axis) => {
    const k =
        vertices.properties.findIndex((property) => property.name === axis && !property.isList);
    if (k < 0) throw new Error(`${name}: the vertices have no property '${axis}'.`);
    return k;
  });
  checkCount(vertices.count, name);
  const list = new PositionList(Math.min(vertices.count, bytes.length), name);
  const take = (row, i) => list.add(row[x], row[y], row[z], () => `point ${i + 1}`);
  if (format === 'ascii') {
    let line = 0;
    const lines = new TextDecoder().decode(bytes.subarray(start)).split('\n');
    for (const element of elements) {
      if (element === vertices)
        for (let i = 0; i < element.count; ++i) {
          const words = (lines[line + i] || '').trim().split(/\s+/);
          if (words.length < element.properties.length)
            throw new Error(
                `${name}: point ${i + 1} of ${element.count} has ` +
                `${words[0] ? words.length : 0} of ${element.properties.length} numbers.`);
          take(words.map(Number), i);
        }
      line += element.count;
    }
  } else {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = start;
    for (const element of elements) {
      at = readBinaryRows(
          view, at, element, format === 'binary_little_endian', name, element === vertices && take);
      if (element === vertices) break;
    }
  }
  return list.result();
}

/// A table with x, y, z in the first three columns, separated by blanks, commas or semicolons. A
/// first line of names and lines that begin with # or / are skipped.
function readTable(bytes, name) {
  if (bytes.subarray(0, 1000).includes(0))
    throw new Error(
        `${name} is neither a PLY file nor a table of text. ` +
        'Programs of pcs convert LAS and other formats to PLY.');
  const list = new PositionList(1000, name);
  let number = 0;
  for (const line of new TextDecoder().decode(bytes).split('\n')) {
    ++number;
    const words = line.trim().split(/[\s,;]+/);
    if (!words[0] || /^[#/]/.test(words[0])) continue;
    const values = words.slice(0, 3).map(Number);
    const isRow = values.length === 3 && values.every((value) => Number.isFinite(value));
    if (!isRow && list.count === 0 && /^"?[a-z]/i.test(words[0])) continue;
    if (!isRow)
      throw new Error(
          `${name}: line ${number}: expected three coordinates, ` +
          `found '${line.trim().slice(0, 40)}'.`);
    list.add(...values, () => `line ${number}`);
  }
  return list.result();
}

/// Returns {positions, origin, name}: coordinates relative to an origin.
function readPoints(buffer, name) {
  const bytes = new Uint8Array(buffer);
  if (bytes.length === 0) throw new Error(`${name} is empty.`);
  const isPly = bytes[0] === 112 && bytes[1] === 108 && bytes[2] === 121 && bytes[3] <= 13;
  return isPly ? readPly(bytes, name) : readTable(bytes, name);
}

if (typeof module !== 'undefined') module.exports = {readPoints};
