// The question in space: fields to inputs and back; solids as lines.

import assert from "node:assert/strict";
import { test } from "node:test";

import { back, edges, fan, fiveFaces, keepOutLines, rotated, rowsOfQuaternion } from "../../service/safestart_service/static/logic/polyhedron.js";
import { FIELDS, counting, onSlice, readSpace, regionQuestion, sliceLacks, spaceWords, startQuestion, textsOf } from "../../service/safestart_service/static/logic/space.js";
import { offered } from "../../service/safestart_service/static/logic/space-presets.js";

const first = Object.fromEntries(Object.entries(FIELDS).map(([name, field]) => [name, field.first]));
const read = (change) => readSpace({ ...first, ...change });
const near = (one, two, tolerance = 1e-12) => assert.ok(one.every((a, k) => Math.abs(a - two[k]) <= tolerance), `${one} is not ${two}`);

test("the page opens with a question", () => {
  const { values, wrong } = readSpace(first), asked = startQuestion(values);
  assert.deepEqual(wrong, {});
  assert.deepEqual(asked.starts, [{ position_m: [2, 25, 1], velocity_m_s: [0, 0, 0], frame: "body" }]);
  assert.deepEqual(asked.attitude.inertia_kg_m2, [[17023, 0, 0], [0, 124826, 0], [0, 0, 129112]]);
  assert.deepEqual(asked.orbit, { mean_motion_rad_s: 0.0011 });
  assert.deepEqual(asked.thrust, { kind: "ball", a_max_m_s2: 0.1 });
  assert.equal(asked.horizon_s, 60);
  assert.equal("within_s" in asked || "speed_limit_m_s" in asked || "hold_m" in asked, false);
});

test("every kind of every part reaches the inputs, and comes back as the same texts", () => {
  const asked = {
    starts: [{ position_m: [-150, 0, 0], velocity_m_s: [0.3, 0, 0], frame: "lvlh" }],
    attitude: { kind: "table", times_s: [0, 300], attitude_wxyz: [[1, 0, 0, 0], [0.8, 0, 0, 0.6]], reference: "lvlh" },
    orbit: { semi_major_axis_m: 6797000, eccentricity: 0.0003, true_anomaly_deg: 0 },
    corridor: { faces: [{ name: "near", normal: [1, 0, 0], offset_m: -10, frame: "lvlh" }, { name: "far", normal: [-1, 0, 0], offset_m: 200, frame: "body" }] },
    thrust: { kind: "thrusters", directions: [[1, 0, 0], [-1, 0, 1], [0, 1, 0]], a_max_m_s2: [0.1, 0.2, 0.3], frame: "body" },
    question: "synchronize", within_s: 80, ball_radius_m: 1, rest_speed_m_s: 0.1, hold_m: [-12, 0, 0], speed_limit_m_s: 0.6,
    plume: { half_angle_deg: 20, range_m: 40 },
  };
  const { values, wrong } = readSpace(textsOf(asked));
  assert.deepEqual(wrong, {});
  assert.deepEqual(startQuestion(values), asked);
  const spin = { ...asked, attitude: { kind: "spin", axis: [1, 0, 1], axis_frame: "inertial", rate_deg_s: -2, phase_deg: 10 }, thrust: { kind: "box", a_max_m_s2: [0.1, 0.2, 0.3], frame: "body" } };
  assert.deepEqual(startQuestion(readSpace(textsOf(spin)).values), spin);
});

test("the short form of a question becomes its parts", () => {
  const { values, wrong } = readSpace(textsOf({ starts: [{ position_m: [0, 30, 0] }], omega_t_deg_s: -2.67, a_max_m_s2: 0.05, mean_motion_rad_s: 0.001 }));
  assert.deepEqual(wrong, {});
  const asked = startQuestion(values);
  assert.deepEqual([asked.attitude.kind, asked.attitude.rate_deg_s, asked.attitude.axis], ["spin", -2.67, [0, 0, 1]]);
  assert.equal(asked.starts[0].frame, "lvlh");
  assert.equal(asked.orbit.mean_motion_rad_s, 0.001);
});

test("what cannot be read is named by its field, and only where it counts", () => {
  assert.match(read({ position_m: "1 2" }).wrong.position_m, /3 numbers are required, not 1 2/);
  assert.match(read({ attitude: "table", table: "0 1 0 0 0" }).wrong.table, /at least 2 lines/);
  assert.equal(read({ table: "nonsense" }).wrong.table, undefined);
  assert.match(read({ corridor: "faces", faces: "near 0 -1 0 -2 here" }).wrong.faces, /then body or lvlh/);
  assert.match(read({ corridor: "faces", faces: "" }).wrong.faces, /at least 1 line is required/);
  assert.match(read({ further: "{" }).wrong.further, /JSON object/);
  assert.match(read({ further: "[1]" }).wrong.further, /required/);
  assert.match(read({ further: '{"starts": []}' }).wrong.further, /not starts/);
  assert.equal(read({ eccentricity: "much" }).wrong.eccentricity, undefined);
  assert.match(read({ orbit: "elliptic", eccentricity: "much" }).wrong.eccentricity, /number/);
});

test("fields count by the choices", () => {
  const circular = counting(first), elliptic = counting({ ...first, orbit: "elliptic" });
  assert.equal(circular.has("mean_motion_rad_s") && !circular.has("eccentricity"), true);
  assert.equal(elliptic.has("eccentricity") && !elliptic.has("mean_motion_rad_s"), true);
});

test("slices lie in three planes through the start, in its frame and at its velocity", () => {
  const { values } = read({ velocity_m_s: "0.1 0 0", start_frame: "lvlh" }), { planes, horizon_s } = regionQuestion(values);
  assert.equal(horizon_s, 60);
  for (const plane of planes) {
    assert.deepEqual([plane.frame, plane.rest, plane.velocity_m_s], ["lvlh", "lvlh", [0.1, 0, 0]]);
    const at = plane.origin_m.map((one, k) => one + values.position_m[k] * (plane.first.direction[k] + plane.second.direction[k]));
    assert.deepEqual(at, values.position_m);
  }
  assert.deepEqual(onSlice(values, "zy", [[7, 8]]), [[2, 8, 7]]);
  assert.deepEqual(sliceLacks(values), []);
  assert.match(sliceLacks(read({ question: "synchronize", speed_limit_m_s: "1", further: '{"keep_outs": []}' }).values).join(), /hold point.*speed limit.*keep outs/);
});

test("the question in words names what is asked", () => {
  assert.match(spaceWords(readSpace(first).values), /start \(2, 25, 1\) m.*torque-free body.*circular orbit.*stay 60 s/);
});

test("a quaternion's rotation is the wire's, and its inverse goes back", () => {
  const half = Math.SQRT1_2, rows = rowsOfQuaternion([half, 0, 0, half]);
  // C = R(q)^T: a body turned by +90 degrees about z sees LVLH x along its -y.
  near(rotated(rows, [1, 0, 0]), [0, -1, 0]);
  near(back(rows, rotated(rows, [1, 2, 3])), [1, 2, 3]);
});

test("edges of half-spaces in a box", () => {
  const cube = [0, 1, 2].flatMap((k) => [1, -1].map((sign) => ({ normal: [0, 1, 2].map((j) => (j === k ? 2 * sign : 0)), offset: 2 })));
  const found = edges(cube, 5);
  assert.equal(found.length, 12);
  for (const [a, b] of found) assert.ok(Math.abs(Math.hypot(...a.map((one, k) => one - b[k])) - 2) < 1e-5);
  assert.equal(edges([{ normal: [0, 1, 0], offset: 1 }], 5).length, 4, "a plane meets the four walls beside it");
  const five = edges(fiveFaces({ axis: [0, 1, 0], c_x: 1, c_z: 1, x0_m: 1, z0_m: 1, r_h_m: 2 }), 30);
  const corners = five.flat().filter(([, y]) => Math.abs(y - 2) < 1e-4);
  assert.equal(corners.length, 12, "four edges of the port and the lower ends of four more");
  for (const [x, , z] of corners) near([Math.abs(x), Math.abs(z)], [1, 1], 1e-4);
});

test("the five faces turn with their axis, as the core turns them", () => {
  for (const axis of [[1, 0, 0], [0, -1, 0], [1, 2, -2]]) {
    const length = Math.hypot(...axis), [hold, ...sides] = fiveFaces({ axis, c_x: 1.5, c_z: 1.5, x0_m: 2.5, z0_m: 2.5, r_h_m: 0.5 });
    near(hold.normal, axis.map((one) => -one / length));
    for (const { normal } of sides) near([normal.reduce((total, one, k) => total + (one * axis[k]) / length, 0)], [-1.5]);
  }
});

test("keep-outs are lines, slices triangles", () => {
  assert.equal(keepOutLines({ centre_m: [1, 2, 3], radius_m: 2 }).length, 3);
  for (const [x, y, z] of keepOutLines({ centre_m: [1, 2, 3], radius_m: 2 }).flat()) near([Math.hypot(x - 1, y - 2, z - 3)], [2]);
  assert.equal(keepOutLines({ centre_m: [0, 0, 0], half_widths_m: [1, 2, 3] }).length, 12);
  assert.deepEqual(fan([0, 0, 0, 0]), { i: [0, 0], j: [1, 2], k: [2, 3] });
});

test("missions with a title come first, unknown ones by their name", () => {
  const names = offered({ "my-mission": {}, envisat: {}, "rocket-body": {} });
  assert.deepEqual(names.map(([name]) => name), ["rocket-body", "envisat", "my-mission"]);
  assert.equal(names[2][1], "my mission");
});
