// Pinned starts keep their own question; several starts out of a text.

import assert from "node:assert/strict";
import { test } from "node:test";

import { MOST_STARTS, added, alike, differing, pinned, pinnedAll, startsOf } from "../../service/safestart_service/static/logic/pins.js";
import { FIRST, read, sharedWords } from "../../service/safestart_service/static/logic/question.js";

const values = (texts = {}) => read({ ...FIRST, ...texts }).values;

test("starts out of a text", () => {
  assert.deepEqual(startsOf("5 40\n\n -1.5, 2e1\n3;4\n"), { starts: [{ x_m: 5, y_m: 40 }, { x_m: -1.5, y_m: 20 }, { x_m: 3, y_m: 4 }], wrong: "" });
  assert.match(startsOf(" \n").wrong, /a start is required/);
  assert.match(startsOf("1 2\n\n3 4 5").wrong, /line 3: two numbers/);
  assert.match(startsOf("1 x").wrong, /line 1/);
  assert.match(startsOf("1 2\n".repeat(MOST_STARTS + 1)).wrong, /at most 200/);
});

test("a pin belongs to its question, not to the fields", () => {
  const slow = pinnedAll(values(), [{ x_m: 5, y_m: 40 }, { x_m: 60, y_m: 40 }], { verdict: ["GO", "NO_GO"], margin_m: [3, null], reason: ["a", "b"] });
  const fast = pinned(values({ omega_t_deg_s: "5" }), { x_m: 5, y_m: 40 }, { verdict: "NO_GO" });
  const list = added(slow, [fast]);
  assert.deepEqual(list.map(({ verdict }) => verdict), ["NO_GO", "GO", "NO_GO"]);
  assert.deepEqual(alike(list, values({ x_m: "1", y_m: "2", y_max_m: "99" })), slow, "wherever the fields' start is, and however far the map reaches");
  assert.deepEqual(alike(list, values({ horizon_s: "61" })), []);
  assert.deepEqual(alike(list, null), [], "a field cannot be read");
  assert.deepEqual(alike(list, values({ within_s: "99" })), slow, "who stays asks nothing within a time");
  assert.deepEqual(differing(list), ["omega_t_deg_s"]);
  assert.equal(added(list, [pinned(values(), { x_m: 5, y_m: 40 }, { verdict: "UNDECIDED" })]).length, 3, "asked again, pinned once");
});

test("pinned starts say what all of them were asked, the usual values too", () => {
  const said = (texts, differ = []) => sharedWords(values(texts), differ);
  assert.equal(said({}), "tumble rate 3 deg/s · thrust acceleration 0.1 m/s² · stay 60 s · at rest in LVLH");
  assert.equal(said({ question: "synchronize" }, ["omega_t_deg_s", "rest"]), "thrust acceleration 0.1 m/s² · come to rest at the hold point within 200 s");
  assert.equal(said({}, ["horizon_s"]), "tumble rate 3 deg/s · thrust acceleration 0.1 m/s² · requirement stay · at rest in LVLH");
  assert.match(said({ c_x: "1", position_half_width_m: "2" }), / · start position ± 2 m · slope of the sides 1$/);
  assert.doesNotMatch(said({ c_x: "1", position_half_width_m: "2" }, ["c_x", "position_half_width_m"]), /slope|position/);
});
