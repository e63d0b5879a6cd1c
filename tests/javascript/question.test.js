// Explore's question: what the fields' texts mean, what is asked, and the words for it.

import assert from "node:assert/strict";
import { test } from "node:test";

import {
  FIELDS, FIRST, certificate, flight, flightWords, flownWords, fromAddress, isAbout, mapLacks, mapWords, memberWords, paper, proved, proven, read, region, start,
  textsOf, toAddress, verdictWords,
} from "../../service/safestart_service/static/logic/question.js";

const HERE = { ...FIRST, x_m: "5", y_m: "40" };
const values = (more = {}) => {
  const found = read({ ...HERE, ...more });
  assert.deepEqual(found.wrong, {});
  return found.values;
};
const AT = { x_m: 5, y_m: 40 };

test("texts become numbers, and nothing is wrong with what stands there at first", () => {
  assert.deepEqual(read(FIRST).wrong, {});
  assert.equal(values({ a_max_m_s2: "1e-1" }).a_max_m_s2, 0.1);
  assert.equal(values({ omega_t_deg_s: "-5" }).omega_t_deg_s, -5, "the service judges, and refuses");
});

for (const text of ["", "  ", "no number", "0x10", "1_0", "1,5", "Infinity", "NaN", "1e999", "--1", "+1", "1."]) {
  test(`${JSON.stringify(text)} is no number, in any field`, () => {
    for (const name of Object.keys(FIELDS).filter((one) => !FIELDS[one].words)) assert.match(read({ ...HERE, [name]: text }).wrong[name], /required/, name);
  });
}

test("a choice is one of its words", () => {
  assert.match(read({ ...HERE, question: "fly" }).wrong.question, /stay, synchronize/);
});

test("without a start there is nothing wrong; with half of one there is", () => {
  assert.equal(start(read(FIRST).values), null);
  assert.deepEqual(start(values()), AT);
  assert.ok(read({ ...HERE, x_m: "" }).wrong.x_m);
});

test("each question holds what it depends on", () => {
  const asked = values({ horizon_s: "80", y_max_m: "200", c_x: "1" });
  assert.deepEqual(certificate(asked), {
    omega_t_deg_s: 3, a_max_m_s2: 0.1, mean_motion_rad_s: 0.0011, corridor: { c_x: 1, x0_m: 2.5, r_h_m: 0.5 }, rest: "lvlh", grid: { nx: 81, ny: 81, y_max_m: 200 },
  });
  assert.equal(region(asked).horizon_s, 80);
  assert.equal(region(values({ rest: "body" })), null);
  assert.deepEqual(paper(asked, AT), { omega_t_deg_s: 3, a_max_m_s2: 0.1, mean_motion_rad_s: 0.0011, c_x: 1, x0_m: 2.5, r_h_m: 0.5, rest: "lvlh", x_m: 5, y_m: 40, method: "paper" });
  assert.equal("method" in proven(asked, AT), false, "the service's own choice");
  assert.equal(flight(asked, AT).horizon_s, 80);
});

test("a spread that is not 0 is asked, a negative one too, so that it is refused", () => {
  assert.equal("position_half_width_m" in proven(values(), AT), false);
  assert.equal(proven(values({ position_half_width_m: "-30" }), AT).position_half_width_m, -30);
  assert.equal(proven(values({ disturbance_m_s2: "0.001" }), AT).disturbance_m_s2, 0.001);
});

test("the latest end belongs to the question that has one", () => {
  assert.equal("within_s" in proven(values(), AT), false);
  assert.equal(proven(values({ question: "synchronize" }), AT).within_s, 200);
  assert.equal(flight(values({ question: "synchronize" }), AT).within_s, 200);
});

test("the verdict's words name everything it depends on", () => {
  assert.equal(verdictWords(values(), AT), "start (5, 40) m at rest in LVLH · 3 deg/s · 0.1 m/s² · stay 60 s");
  assert.equal(
    verdictWords(values({ question: "synchronize", rest: "body", position_half_width_m: "0.5", c_x: "1" }), AT),
    "start (5, 40) m at rest in the body frame · 3 deg/s · 0.1 m/s² · come to rest at the hold point within 200 s · start position ± 0.5 m · slope of the sides 1",
  );
});

test("the map says what it asks, and what the verdict asks besides", () => {
  assert.equal(mapWords(values()), "Map: stay 60 s, nominal · 3 deg/s · 0.1 m/s² · at rest in LVLH");
  assert.deepEqual(mapLacks(values()), []);
  assert.deepEqual(mapLacks(values({ question: "synchronize", disturbance_m_s2: "0.001" })), ["come to rest at the hold point within 200 s", "disturbance up to 0.001 m/s²"]);
  assert.match(mapWords(values({ rest: "body" })), /certified for ever/);
});

test("only a verdict that is one is proved for all", () => {
  const ranges = values({ position_half_width_m: "0.5" });
  assert.equal(proved("GO", values()), "proved");
  assert.equal(proved("NO_GO", ranges), "proved for all within the ranges");
  assert.equal(proved("UNDECIDED", ranges), "neither proved nor refuted for all within the ranges");
  assert.equal(proved("GO", values({ disturbance_m_s2: "0.001" })), "proved against every such disturbance");
});

test("the flight's caption says what is flown", () => {
  const synchronize = values({ question: "synchronize" });
  assert.equal(flownWords("GO", values()), "Flown: the proof's thrust history, to stay 60 s");
  assert.match(flownWords("NO_GO", values()), /best attempt to stay 60 s; no thrust held over steps of 2 s can$/);
  assert.match(flownWords("UNDECIDED", values()), /undecided/);
  assert.match(flownWords("NO_GO", synchronize), /attempt to stay 60 s, as none is known to come to rest at the hold point within 200 s/);
  assert.match(flownWords("GO", values({ position_half_width_m: "1" })), /nominal values, undisturbed/);
});

test("from a start outside nothing is flown", () => {
  const flown = { verdict: "NO_GO", faces: ["hold_plane", "right"], distance_m: [[9.5, -46.1788], [1, -84]], closest_face: "right", closest_m: -84, closest_s: 15, delta_v_m_s: 6 };
  assert.deepEqual(flightWords(flown, values()), { flies: false, text: "Nothing is flown: the start lies outside the corridor, 46.18 m beyond right." });
  const inside = { ...flown, distance_m: [[9.5, 3], [1, -84]] };
  assert.match(flightWords(inside, values()).text, /At worst 84 m beyond right, at 15 s/);
  assert.match(flightWords({ ...inside, closest_m: 13.164 }, values()).text, /At worst 13.16 m from right/);
});

test("an address gives the texts back, and names what it does not know", () => {
  const texts = { ...HERE, omega_t_deg_s: "4", question: "synchronize" };
  assert.deepEqual(fromAddress(toAddress(texts)), { texts, unknown: [] });
  assert.equal(toAddress(FIRST), "");
  assert.deepEqual(fromAddress("?omega=4&y_m=").unknown, ["omega"]);
});

test("stored sets are about an operating point and no other", () => {
  const job = { omega_t_deg_s: 2, a_max_m_s2: 0.1, rest: "lvlh", mean_motion_rad_s: 0.0011, corridor: { c_x: 1.5, c_z: 1.5, x0_m: 2.5, z0_m: 2.5, r_h_m: 0.5 }, grid: { nx: 9, ny: 9, y_max_m: 150 } };
  assert.deepEqual(textsOf(job).omega_t_deg_s, "2");
  assert.equal(isAbout(job, values({ omega_t_deg_s: "2" })), true);
  assert.equal(isAbout(job, values({ omega_t_deg_s: "2.0", y_max_m: "80" })), true);
  for (const [name, text] of [["omega_t_deg_s", "3"], ["rest", "body"], ["c_x", "1"], ["mean_motion_rad_s", "0"]]) assert.equal(isAbout(job, values({ omega_t_deg_s: "2", [name]: text })), false, name);
});

test("members of a family: which one is the nominal, and what the others are", () => {
  const one = (more) => ({ verdict: "GO", omega_t_deg_s: 3, a_max_m_s2: 0.1, position_m: [5, 40], ...more });
  assert.equal(memberWords(one({ omega_t_deg_s: 3 + 1e-12 }), values(), AT), "GO at nominal");
  assert.equal(memberWords(one({ verdict: "NO_GO", omega_t_deg_s: 3.25 }), values(), AT), "NO-GO at 3.25 deg/s, 0.1 m/s², (5, 40) m");
  const moving = values({ velocity_half_width_m_s: "0.1" });
  assert.equal(memberWords(one({ velocity_m_s: [0, 0] }), moving, AT), "GO at nominal");
  assert.match(memberWords(one({ velocity_m_s: [0.1, 0] }), moving, AT), /GO at 3 deg.*\(0\.1, 0\) m\/s$/);
  assert.equal(memberWords(one({ position_m: [5.5, 40] }), values(), AT), "GO at 3 deg/s, 0.1 m/s², (5.5, 40) m");
});
