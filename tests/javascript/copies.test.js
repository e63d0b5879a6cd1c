// What stands on the screen as a command, layers of pictures, key inputs, titles.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";

import { COPIES } from "../../service/safestart_service/static/logic/copies.js";
import { nearest, within } from "../../service/safestart_service/static/logic/geometry.js";
import { keyInputs, leaves } from "../../service/safestart_service/static/logic/inputs.js";
import { layersOf, shapeOf } from "../../service/safestart_service/static/logic/layers.js";
import { PRESETS } from "../../service/safestart_service/static/logic/presets.js";
import { FIELDS, FIRST, read } from "../../service/safestart_service/static/logic/question.js";
import { rowsOf } from "../../service/safestart_service/static/logic/tables.js";
import { inputTitle, plainly, titled } from "../../service/safestart_service/static/logic/titles.js";

const ASKED = { address: "http://h:1/sub", id: "flight", inputs: { name: "it's", on: true, off: null, start: { x_m: -5, y_m: [1, 2.5] } } };

test("a question is a command that a shell hands over unchanged", () => {
  const said = execFileSync("sh", ["-c", COPIES.CLI(ASKED).replace(/\| safestart.*/, "")], { encoding: "utf8" });
  assert.deepEqual(JSON.parse(said), ASKED.inputs);
  const sent = execFileSync("sh", ["-c", COPIES.curl(ASKED).replace(/^curl -s \S+ -H '[^']*' -d/, "printf %s")], { encoding: "utf8" });
  assert.deepEqual(JSON.parse(sent), { inputs: ASKED.inputs });
  assert.match(COPIES.curl(ASKED), /^curl -s http:\/\/h:1\/sub\/processes\/flight\/execution /);
  assert.equal(COPIES.Python({ id: "flight", inputs: ASKED.inputs }).split("\n").at(-1), 'result = ss.run("flight", {"name": "it\'s", "on": True, "off": None, "start": {"x_m": -5, "y_m": [1, 2.5]}})');
});

test("a layer has the rows of its table, and of the inputs beside them", () => {
  const view = { layers: [{ title: "start", drawn: "points", table: "states", x: "states.x_m", y: "states.y_m", value: "verdict", beside: "states" }, { title: "none", table: "absent", x: "x", y: "y" }] };
  const [layer, ...more] = layersOf(view, { states: [{ verdict: "GO" }, { verdict: "NO_GO" }] }, { states: [{ x_m: 1, y_m: 2 }, { x_m: 3, y_m: null }] });
  assert.deepEqual(layer.rows, [{ x: 1, y: 2, value: "GO" }], "a row without a coordinate is not drawn");
  assert.deepEqual(more, []);
  assert.deepEqual(shapeOf({ corridor: { c_x: 1 } }), { c_x: 1, x0_m: 2.5, r_h_m: 0.5 });
  assert.equal(shapeOf({ corridor: { faces: [] } }), null);
  assert.equal(shapeOf({ corridor: { axis: [0, 1, 0.2] } }), null);
  assert.equal(shapeOf({ corridor: { axis: [0, -1, 0] } }), null);
  assert.deepEqual(shapeOf({ corridor: { c_x: 1, axis: [0, 2, 0] } }).c_x, 1);
  assert.equal(shapeOf({}), null);
  assert.deepEqual(shapeOf({}, { corridor: { minOccurs: 0 } }), { c_x: 1.5, x0_m: 2.5, r_h_m: 0.5 });
  assert.equal(shapeOf({}, { corridor: { minOccurs: 1 } }), null);
});

test("key inputs are the required ones, the example's, and those that were changed", () => {
  const described = { inputs: { rate: { minOccurs: 1, schema: {} }, grid: { minOccurs: 0, schema: { default: {} } }, seed: { minOccurs: 0, schema: { default: 0 } }, kind: { minOccurs: 0, schema: { default: "a" } } }, example: { grid: {} } };
  assert.deepEqual(keyInputs(described, { rate: 3, grid: { nx: 5 }, seed: 0, kind: "b" }), [["rate", "3"], ["grid.nx", "5"], ["kind", "b"]]);
  assert.deepEqual(leaves({ windows: [[0, 1], [2, 3]], none: null, empty: [] }), [["windows", "[0,1], [2,3]"]]);
  assert.equal(leaves({ long: Array(99).fill(7) })[0][1].length, 60);
});

test("names of the wire have titles and units", () => {
  assert.deepEqual(titled("a_max_m_s2"), { text: "Thrust acceleration", unit: "m/s²" });
  assert.deepEqual(titled("stand_off_m"), { text: "Stand off", unit: "m" });
  assert.deepEqual(titled("seed"), { text: "Seed", unit: "" });
  assert.equal(inputTitle("grid.y_max_m"), "Grid: corridor cut at [m]");
  assert.equal(plainly("at most 3 m/s^2 `x`"), "at most 3 m/s² x");
});

test("a point lies within a polygon, and has the margin of the nearest node", () => {
  const square = [[0, 0], [2, 0], [2, 2], [0, 2]];
  assert.equal(within([1, 1], square), true);
  assert.equal(within([3, 1], square), false);
  const map = { x_m: [0, 1, 2], y_m: [0, 10], margin_m: [[1, 2, 3], [4, 5, 6]] };
  assert.equal(nearest([1.4, 9], map), 5);
  assert.equal(nearest([9, 9], map), null);
});

test("a flight is rows under names", () => {
  assert.deepEqual(rowsOf({ verdict: "GO", time_s: [0, 1], body_m: [[1, 2], [3, 4]], faces: ["left"] }), [["time_s", "body_m.0", "body_m.1"], [0, 1, 2], [1, 3, 4]]);
});

test("presets fill fields that exist with texts that they take", () => {
  for (const { texts } of PRESETS) {
    for (const name of Object.keys(texts)) assert.ok(name in FIELDS, name);
    assert.deepEqual(read({ ...FIRST, ...texts }).wrong, {});
  }
});
