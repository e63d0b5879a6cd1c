// The approach designer's questions, words and geometry.

import assert from "node:assert/strict";
import { test } from "node:test";

import { FIELDS, angleOf, burnRows, drifts, holdOf, isOf, onLine, planNeeds, planOf, planWords, risk, studyOf } from "../../service/safestart_service/static/logic/approach.js";
import { addressOf, textsFrom, valuesOf } from "../../service/safestart_service/static/logic/fields.js";

const read = (change = {}) => valuesOf(FIELDS, { ...textsFrom(FIELDS, "").texts, ...change });

test("the study asks about the plan that is shown, and more", () => {
  const { values } = read({ angle_deg: "40", kappa: "2" }), plan = planOf(values), study = studyOf(values);
  for (const [name, value] of Object.entries(plan)) assert.deepEqual(study[name], value, name);
  assert.equal(plan.sigma.velocity_m_s, 0.001);
  assert.equal("runs" in plan, false);
  assert.deepEqual([study.kappa, study.barrier, study.gamma, study.eccentricity], [2, "off", null, 0]);
});

test("a stored study is of these inputs only if every one of them is the same, in any order", () => {
  const question = studyOf(read().values), { sigma, ...others } = question;
  assert.equal(isOf({ sigma: Object.fromEntries(Object.entries(sigma).reverse()), ...others }, question), true);
  assert.equal(isOf({ ...question, seed: 1 }, question), false);
  assert.equal(isOf({ ...question, sigma: { ...sigma, thrust_deg: 1 } }, question), false);
  assert.equal(isOf({ ...question, gamma: 0.5 }, question), false);
});

test("a text that is no number is named; one of the study leaves the plan alone", () => {
  assert.deepEqual(planNeeds(read({ hold_m: "" }).wrong), ["hold_m"]);
  const { wrong } = read({ runs: "many", barrier: "high" });
  assert.deepEqual(Object.keys(wrong), ["barrier", "runs"]);
  assert.deepEqual(planNeeds(wrong), []);
});

test("a point on the line has the line's angle", () => {
  for (const angle of [0, 0.5, 40, 90, 130, 180, 270, 359.5]) assert.equal(angleOf(onLine(angle, 700)), angle);
  assert.deepEqual(onLine(90, 100).map(Math.round), [0, -100], "the R-bar is below");
  assert.equal(angleOf([0, 0]), null);
});

test("the hold point stays on its line between sphere and start", () => {
  const values = { angle_deg: 90, keep_out_m: 50, start_m: 2000 };
  assert.equal(holdOf([300, -200], values), 200);
  assert.equal(holdOf([0, 900], values), 50);
  assert.equal(holdOf([0, -9000], values), 1999);
});

test("address and texts are one another's inverse", () => {
  const texts = { ...textsFrom(FIELDS, "").texts, angle_deg: "0", barrier: "tightened" };
  assert.equal(addressOf(FIELDS, texts), "?angle_deg=0&barrier=tightened");
  assert.deepEqual(textsFrom(FIELDS, addressOf(FIELDS, texts)), { texts, unknown: [] });
  assert.deepEqual(textsFrom(FIELDS, "?angle=3").unknown, ["angle"]);
  assert.equal(addressOf(FIELDS, textsFrom(FIELDS, "").texts), "");
});

test("drifts are drawn by what is proved of their hop, with gaps", () => {
  const path = (verdict, at) => ({ verdict, along_track_m: [at, at + 1], radial_m: [0, 1] });
  const answer = { drifts: [path("PROVED", 0), path("VIOLATED", 5), path("PROVED", 9)] };
  assert.deepEqual(drifts(answer, "PROVED"), { x: [0, 1, null, 9, 10], y: [0, 1, null, 0, 1] });
  assert.deepEqual(drifts(answer, "UNKNOWN"), { x: [], y: [] });
});

test("words and burns say what they are of", () => {
  assert.match(planWords(read({ hops: "1" }).values), /130 deg · 1 hop · 2000 to 100 m .* keep out 50 m/);
  assert.equal(risk({ breach: { probability: 0.015, low: 0.0081, high: 0.02744 } }), "1.5 % (95 %: 0.81 % to 2.74 %)");
  const rows = burnRows({ burns: [{ burn: 1, time_s: 0, distance_m: 2000, position_m: [1, 2, 3], impulse_m_s: [4, 5, 6] }] });
  assert.deepEqual(rows[1], [1, 0, 2000, 1, 2, 3, 4, 5, 6]);
  assert.equal(rows[0].length, rows[1].length);
});
