// Words, geometry and statistics.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { arc, closed, corridor, turned } from "../../service/safestart_service/static/logic/geometry.js";
import { layerTitle } from "../../service/safestart_service/static/logic/layers.js";
import { agreement, wilson } from "../../service/safestart_service/static/logic/statistics.js";
import { HELD, barAxis, csv, duration, figure, lines, moment, rounding, sentence } from "../../service/safestart_service/static/logic/words.js";

const SHAPE = { c_x: 1.5, x0_m: 2.5, r_h_m: 0.5 };
const near = (one, two) => assert.ok(Math.abs(one - two) < 1e-9, `${one} is not ${two}`);

test("figures for people", () => {
  assert.deepEqual([null, undefined, true, false, "x", 3, 1234567, 0.000123456, -12.94214].map((value) => figure(value)), ["–", "–", "yes", "no", "x", "3", "1235000", "0.0001235", "-12.94"]);
  assert.deepEqual([null, 0, 0.0312, 1.26, 61.2, 600, 7200].map(duration), ["–", "0 s", "0.03 s", "1.3 s", "61 s", "10 min", "2.0 h"]);
  assert.equal(moment("2026-01-02T03:04:05.678+00:00"), "2026-01-02 03:04:05 UTC");
  assert.equal(moment(null), "–");
  assert.deepEqual(["", "it stays", "It is so."].map(sentence), ["", "It stays.", "It is so."]);
});

test("a long title is broken at its dots", () => {
  assert.equal(lines("Map: stay · 3 deg/s · 0.1 m/s²", 100), "Map: stay · 3 deg/s · 0.1 m/s²");
  assert.equal(lines("Map: stay · 3 deg/s · 0.1 m/s²", 20), "Map: stay · 3 deg/s<br>0.1 m/s²");
  assert.equal(lines("much longer than that", 5), "much longer than that");
});

test("CSV keeps commas, quotes and line ends in their cells", () => {
  assert.equal(csv([["a", "b"], [1, null], ['x, "y"', "two\nlines"]]), 'a,b\n1,\n"x, ""y""","two\nlines"\n');
});

test("the corridor opens from the hold plane on", () => {
  const { x, y, half } = corridor(SHAPE, 150);
  near(half, 2.5 + 1.5 * 149.5);
  assert.deepEqual([x[1], x[2], y[1], y[0]], [-2.5, 2.5, 0.5, 150]);
  assert.deepEqual([x[0], y[0]], [x[4], y[4]]);
});

test("an arc is drawn where the corridor is", () => {
  const { x, y } = arc(73, SHAPE, 150);
  x.forEach((at, k) => {
    if (at === null) return;
    near(Math.hypot(at, y[k]), 73);
    assert.ok(Math.abs(at) <= 2.5 + 1.5 * (y[k] - 0.5) && y[k] >= 0.5);
  });
  assert.ok(x.some((at) => at !== null) && x[0] === null);
});

test("a turn is counter-clockwise", () => {
  const { x, y } = turned([1], [0], Math.PI / 2);
  near(x[0], 0);
  near(y[0], 1);
  assert.deepEqual(closed([[0, 1], [2, 3]]), { x: [0, 2, 0], y: [1, 3, 1] });
});

test("Wilson's interval, against the values of R's binom package", () => {
  const [low, high] = wilson(8, 10);
  assert.ok(Math.abs(low - 0.4901625) < 1e-6 && Math.abs(high - 0.9433178) < 1e-6);
  assert.deepEqual(wilson(0, 0), null);
  assert.equal(wilson(0, 44)[0], 0);
});

test("agreement counts each kind of cell", () => {
  const { z, counts } = agreement([[true, true], [true, true], [false, true]], [[1, 1], [0, 0], [1, 1]], [[1, 0], [1, 0], [1, 1]]);
  assert.deepEqual(z, [[2, 3], [4, 1], [0, 2]]);
  assert.deepEqual(counts, [1, 1, 2, 1, 1]);
});

test("a layer is called as the outputs call it", () => {
  const outputs = { faces: ["hold_plane", "right"], method: "exact" };
  assert.equal(layerTitle("{faces.0}", outputs), "hold plane");
  assert.equal(layerTitle("to {faces.1}, {method}", outputs), "to right, exact");
  assert.equal(layerTitle("{faces.7}", outputs), "faces.7");
  assert.equal(layerTitle("plain", outputs), "plain");
});

test("what is 0 but for rounding is known by its column", () => {
  const column = [-900, 1.1e-13, null, "x", 23];
  assert.ok(Math.abs(column[1]) < rounding(column));
  assert.ok(1e-9 > rounding(column), "a small margin among metres stays what it is");
  assert.ok(!(1.1e-13 < rounding([1.1e-13, 2e-13])), "a column of small figures keeps them");
  assert.equal(rounding([]), 0);
});

test("the steps that the pages name are those of the service", () => {
  const wire = readFileSync(new URL("../../core/safestart/processes/wire.py", import.meta.url), "utf8");
  assert.equal(HELD, `held over steps of ${Number(/^DT_S = ([\d.]+)$/m.exec(wire)[1])} s`);
});

test("a logarithmic axis of bars has ticks that people read as they are, and begins below every bar", () => {
  const ticks = (values) => barAxis(values).ticktext;
  assert.deepEqual(ticks([0.25, null, 0]), ["0.2", "0.5"], "what is 0 or missing has no bar");
  assert.deepEqual(ticks([0.1, 0.1]), ["0.05", "0.1"]);
  assert.deepEqual(ticks([3, 7]), ["2", "5", "10"]);
  assert.deepEqual(ticks([0.001, 30]), ["0.001", "0.01", "0.1", "1", "10"], "many decades have one tick each");
  near(barAxis([0.1, 0.1]).range[0], Math.log10(0.05));
  assert.deepEqual(barAxis([null]), { type: "log" });
});
