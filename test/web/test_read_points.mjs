// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the reader of the gallery for dropped files, without a browser: node test_read_points.mjs

import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {test} from 'node:test';

const {readPoints} = createRequire(import.meta.url)('../../examples/gallery/page/read_points.js');
const read = (contents, name = 'f') => {
  const bytes = Buffer.from(contents);
  return readPoints(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), name);
};
const pointsOf = ({positions, origin}) =>
    Array.from(positions, (value, i) => value + origin[i % 3]);

test('tables may have headers, comments, other columns and other separators', () => {
  const expected = [1, 2, 3, 4, 5, 6];
  for (const text
           of ['1 2 3\n4 5 6\n', 'x,y,z\n1,2,3\n4,5,6', '# c\n1;2;3;9\r\n4;5;6;9\r\n',
               '//X Y Z\n1\t2\t3\n\n4\t5\t6'])
    assert.deepEqual(pointsOf(read(text)), expected, text);
});

test('large coordinates keep their digits', () => {
  const [x] = pointsOf(read('5000000.125 1 1\n5000001.375 1 1')).slice(3);
  assert.equal(x, 5000001.375);
});

test('properties, lists and other elements of a PLY file are skipped', () => {
  const header = (format) => `ply\nformat ${format} 1.0\ncomment c\nelement face 1\n` +
      'property list uchar int vertex_indices\nelement vertex 2\nproperty uchar red\n' +
      'property double y\n' +
      'property float x\nproperty int16 z\nend_header\n';
  assert.deepEqual(
      pointsOf(read(header('ascii') + '3 0 1 1\n9 2 1 3\n9 5 4 6\n')), [1, 2, 3, 4, 5, 6]);
  for (const isLittle of [true, false]) {
    const view = new DataView(new ArrayBuffer(13 + 30));
    view.setUint8(0, 3);
    [[2, 1, 3], [5, 4, 6]].forEach(([y, x, z], i) => {
      const at = 13 + 15 * i;
      view.setFloat64(at + 1, y, isLittle);
      view.setFloat32(at + 9, x, isLittle);
      view.setInt16(at + 13, z, isLittle);
    });
    const format = isLittle ? 'binary_little_endian' : 'binary_big_endian';
    const file = Buffer.concat([Buffer.from(header(format)), Buffer.from(view.buffer)]);
    assert.deepEqual(pointsOf(read(file)), [1, 2, 3, 4, 5, 6], format);
    assert.throws(
        () => read(file.subarray(0, file.length - 1)),
        /ends in row 2 of 2 of the element 'vertex'/);
  }
});

test('errors name the file, the place and the rule', () => {
  const header =
      'ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n' +
      'property float z\n';
  for (
      const [text, expected] of [
          ['', /f is empty\.$/],
          ['\n\n', /f has no points\.$/],
          ['1 2\n', /line 1: expected three coordinates, found '1 2'/],
          ['ply\nformat ascii 1.0\n', /no line `end_header`/],
          ['ply\nformat binary 1.0\nend_header\n', /unknown PLY format 'binary'/],
          [
            'ply\nformat ascii 1.0\nelement vertex -1\nend_header\n',
            /line 3 of the PLY header: expected a number/
          ],
          [
            'ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n',
            /line 4 .*unknown type 'real'/
          ],
          ['ply\nformat ascii 1.0\nproperty float x\nend_header\n', /line 3 .*without an element/],
          ['ply\nformat ascii 1.0\nend_header\n', /no element 'vertex'/],
          [header + 'end_header\n1 2 3\n', /point 2 of 2 has 0 of 3 numbers/],
          [header + 'end_header\n1 2 3\n1 nan 3\n', /point 2: a coordinate is not a finite number/],
          [
            header.replace('2', '99999999999') + 'end_header\n',
            /more than 4,000,000 points/
          ],
  ])
    assert.throws(() => read(text), expected, text);
});
