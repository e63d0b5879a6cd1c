import assert from "node:assert/strict";
import { test } from "node:test";

import { back, camera, lines, rotated } from "../../service/safestart_service/static/logic/projection.js";

const near = (found, wanted) => found.forEach((value, k) => assert.ok(Math.abs(value - wanted[k]) < 1e-12, `${found} is not ${wanted}`));

test("the camera at 0 looks along the first axis, and from above along the third", () => {
  near(camera(0, 0)([5, 2, 3]), [2, 3]);
  near(camera(0, 90)([5, 2, 3]), [2, -5]);
  near(camera(90, 0)([5, 2, 3]), [-5, 3]);
});

test("a picture keeps lengths across the line of sight", () => {
  const [c, s] = [Math.cos(0.6), Math.sin(0.6)];
  const seen = camera((0.6 * 180) / Math.PI, 0)([-s, c, 0]);
  near(seen, [1, 0]);
});

test("a rotation and its inverse", () => {
  const rows = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]];
  near(rotated(rows, [1, 2, 3]), [2, -1, 3]);
  near(back(rows, rotated(rows, [1, 2, 3])), [1, 2, 3]);
});

test("lines have gaps between them", () => {
  assert.deepEqual(lines([[[0, 1, 2], [0, 3, 4]], [[0, 5, 6]]], (p) => [p[1], p[2]]), { x: [1, 3, null, 5, null], y: [2, 4, null, 6, null] });
});
