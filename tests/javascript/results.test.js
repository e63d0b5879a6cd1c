// Results: tables of outputs, findings worst first, and where a start of a result leads.

import assert from "node:assert/strict";
import { test } from "node:test";

import { differing, exploreAddress, findings, outcome } from "../../service/safestart_service/static/logic/outcome.js";
import { columnsOf, each, flat, tablesOf } from "../../service/safestart_service/static/logic/tables.js";
import { readTrade, tradeExplore } from "../../service/safestart_service/static/logic/trade.js";

const FINDINGS = { kind: "findings", table: "windows.findings", word: "findings.verdict", good: ["SAFE"], bad: ["UNSAFE"], basis: "", unproved: [] };
const found = (...verdicts) => ({ windows: [{ abort_window_min: [0, 240], run_s: 1, findings: verdicts.map((verdict, k) => ({ requirement: `r${k}`, verdict, counter_example: verdict === "UNSAFE" ? { x_m: -900 } : null })) }] });

test("a row holds the scalars of inner objects and short vectors", () => {
  assert.deepEqual(flat({ a: 1, b: { c: 2, d: { e: null } }, f: [1, 2], g: ["left", "right"], h: Array(9).fill(0), i: [{}] }), { a: 1, "b.c": 2, "b.d.e": null, "f.0": 1, "f.1": 2, g: "left right" });
});

test("lists of objects are tables, those within their rows too, beside what the row says", () => {
  const tables = tablesOf(found("SAFE", "UNSAFE"));
  assert.deepEqual(tables["windows.findings"].map((row) => [row["abort_window_min.1"], row["findings.requirement"], row["findings.counter_example.x_m"]]), [[240, "r0", undefined], [240, "r1", -900]]);
  assert.deepEqual(columnsOf([{ a: null, b: "" }, { b: 2, c: 3 }]), ["b", "c"]);
});

test("a list of objects within an object is a table, with nothing beside it", () => {
  const tables = tablesOf({ plan: { orbits: 2, hops: [{ rho: 0.5, impulse: [1, 2] }, { rho: 0.7, impulse: [3, 4] }] } });
  assert.deepEqual(tables["plan.hops"], [{ rho: 0.5, "impulse.0": 1, "impulse.1": 2 }, { rho: 0.7, "impulse.0": 3, "impulse.1": 4 }]);
});

test("declared lists stand side by side, or over two axes", () => {
  const outputs = { verdict: ["GO", "NO_GO"], margin_m: [1, -2], end_s: null, rate: [1, 2], thrust: [5, 6, 7], share: [[1, 2, 3], [4, 5, 6]] };
  const tables = tablesOf(outputs, [{ name: "states", columns: ["verdict", "margin_m", "end_s"], axes: [] }, { name: "map", columns: ["share"], axes: ["rate", "thrust"] }, { name: "uneven", columns: ["rate", "thrust"], axes: [] }]);
  assert.deepEqual(tables.states, [{ verdict: "GO", margin_m: 1 }, { verdict: "NO_GO", margin_m: -2 }]);
  assert.deepEqual(tables.map[5], { rate: 2, thrust: 7, share: 6 });
  assert.equal("uneven" in tables, false);
});

test("a path leads to every entry, under its name", () => {
  const outputs = { rows: [{ engine: "exact", confusion: { tp: 1 } }, { engine: "forward", confusion: null }], confusion: { closed: { filter: { tp: 2 } } } };
  assert.deepEqual(each(outputs, "rows.*.confusion", ["engine"]), [{ value: { tp: 1 }, names: ["exact"] }]);
  assert.deepEqual(each(outputs, "confusion.*.*", ["", ""]), [{ value: { tp: 2 }, names: ["closed", "filter"] }]);
  assert.deepEqual(each(outputs, "nothing.*"), []);
});

test("the worst finding is the result's verdict", () => {
  const of = (...verdicts) => outcome([FINDINGS], tablesOf(found(...verdicts)));
  assert.deepEqual(of("SAFE", "SAFE"), { word: "SAFE", sense: "good", basis: null, count: 2, of: 2 });
  assert.deepEqual(of("SAFE", "UNKNOWN", "SAFE"), { word: "UNKNOWN", sense: "open", basis: null, count: 1, of: 3 });
  assert.deepEqual(of("SAFE", "UNKNOWN", "UNSAFE"), { word: "UNSAFE", sense: "bad", basis: null, count: 1, of: 3 });
  assert.deepEqual(of("SURE"), { word: "SURE", sense: "open", basis: null, count: 1, of: 1 }, "a word that nobody knows is no good news");
  assert.equal(outcome([], tablesOf(found("SAFE"))), null);
  assert.equal(outcome([FINDINGS], tablesOf({ windows: [] })), null);
});

test("what rests on no proof is shown as a claim, and the worst of it still first", () => {
  const view = { ...FINDINGS, table: "states", word: "verdict", good: ["GO"], bad: ["NO_GO"], basis: "method", unproved: ["paper"] };
  const of = (method) => outcome([view], tablesOf({ method, verdict: ["GO", "NO_GO"] }, [{ name: "states", columns: ["verdict"], axes: [] }]));
  assert.deepEqual(of("paper"), { word: "NO_GO", sense: "open", basis: "paper", count: 1, of: 2 });
  assert.deepEqual(of("exact"), { word: "NO_GO", sense: "bad", basis: null, count: 1, of: 2 });
});

test("findings come worst first", () => {
  assert.deepEqual(findings(FINDINGS, tablesOf(found("SAFE", "UNKNOWN", "UNSAFE", "SAFE"))).map(({ word }) => word), ["UNSAFE", "UNKNOWN", "SAFE", "SAFE"]);
});

test("a start of a result leads to the same question: its corridor, orbit and time come with it", () => {
  const inputs = { omega_t_deg_s: [1, 2], horizon_s: 80, mean_motion_rad_s: 0.001, corridor: { c_x: 1, c_z: 1, x0_m: 2, z0_m: 2, r_h_m: 0.5 }, rest: "body" };
  const told = Object.fromEntries(new URLSearchParams(exploreAddress({ omega_t_deg_s: 2, a_max_m_s2: 0.1, x_m: -5, y_m: 40 }, inputs)));
  assert.deepEqual(told, { omega_t_deg_s: "2", a_max_m_s2: "0.1", horizon_s: "80", rest: "body", mean_motion_rad_s: "0.001", c_x: "1", x0_m: "2", r_h_m: "0.5", x_m: "-5", y_m: "40" });
  assert.equal(new URLSearchParams(exploreAddress({ x_m: 1, y_m: 2 }, { omega_t_deg_s: 3, a_max_m_s2: 0.1 })).get("omega_t_deg_s"), "3");
});

test("inputs that differ are named", () => {
  assert.deepEqual(differing([{ a: 1, b: { c: [1], d: 2 } }, { a: 1, b: { c: [2], d: 2 }, e: 0 }]), ["b.c", "e"]);
});

test("the trade study asks nothing while a field holds no number", () => {
  const texts = { low: "10", high: "0.5", stand_off_m: "40", y_max_m: "150", rest: "lvlh" };
  const asked = readTrade(texts);
  assert.deepEqual([asked.omega_t_deg_s[0], asked.omega_t_deg_s[19], asked.a_max_m_s2.length, asked.stand_off_m], [0.5, 10, 25, 40]);
  for (const name of ["low", "high", "stand_off_m", "y_max_m"]) assert.equal(readTrade({ ...texts, [name]: "" }), null);
  assert.equal(new URLSearchParams(tradeExplore(3, 0.1, asked)).get("y_m"), "40");
});
