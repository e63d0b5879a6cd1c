// The store: no answer is ever shown to a question that is not the one its inputs pose.

import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";

import { OLD_MS, Store, digest } from "../../service/safestart_service/static/logic/store.js";

const QUIET_MS = 100;
const soon = async () => { for (let k = 0; k < 5; k++) await Promise.resolve(); };

beforeEach(() => {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
});

/** A store with one panel about the input `a`, and the questions it has asked, each to be answered by hand. */
function one({ quiet = 0, deaf = false, poses = ({ a }) => a } = {}) {
  const asked = [], shown = [], store = new Store({ a: null, b: 0 });
  const panel = store.panel({
    quiet, poses,
    asks: (question, signal) => new Promise((resolve, reject) => {
      asked.push({ question, signal, resolve, reject });
      if (!deaf) signal.addEventListener("abort", () => reject(signal.reason));
    }),
    shows: ({ state, answer, old }) => shown.push([state, answer ?? old]),
  });
  return { store, panel, asked, shown };
}

async function answered(found, value, answer = value) {
  found.store.set({ a: value });
  mock.timers.tick(0);
  await soon();
  found.asked.at(-1).resolve(answer);
  await soon();
}

test("equal questions have one digest, whatever the order of their keys", () => {
  assert.equal(digest({ a: 1, b: { c: [1, { d: 2, e: 3 }], f: null } }), digest({ b: { f: null, c: [1, { e: 3, d: 2 }] }, a: 1 }));
  assert.notEqual(digest({ a: [1, 2] }), digest({ a: [2, 1] }));
});

test("an answer is there with the question it answers", async () => {
  const found = one();
  await answered(found, 1, "one");
  assert.deepEqual([found.panel.state, found.panel.question, found.panel.digest, found.panel.answer], ["there", 1, "1", "one"]);
});

test("a changed input makes the answer old before set returns, and nothing else of it is left", async () => {
  const found = one();
  await answered(found, 1, "one");
  found.store.set({ a: 2 });
  assert.deepEqual([found.panel.state, found.panel.answer, found.panel.old], ["asking", null, "one"]);
  assert.deepEqual(found.shown.at(-1), ["asking", "one"]);
});

test("an old answer is withdrawn after a second, however often the inputs change until then", async () => {
  const found = one({ quiet: QUIET_MS });
  found.store.set({ a: 1 });
  mock.timers.tick(QUIET_MS);
  await soon();
  found.asked[0].resolve("one");
  await soon();
  for (let k = 0; k < 9; k++) {
    found.store.set({ a: 2 + k });
    assert.equal(found.panel.old, "one");
    mock.timers.tick(OLD_MS / 10);
  }
  mock.timers.tick(OLD_MS / 10);
  assert.deepEqual([found.panel.state, found.panel.old], ["asking", null]);
  assert.deepEqual(found.shown.at(-1), ["asking", null]);
});

test("a late answer is dropped, also of a request that did not hear that it was given up", async () => {
  const found = one({ deaf: true });
  found.store.set({ a: 1 });
  mock.timers.tick(0);
  found.store.set({ a: 2 });
  mock.timers.tick(0);
  assert.deepEqual(found.asked.map(({ question, signal }) => [question, signal.aborted]), [[1, true], [2, false]]);
  found.asked[1].resolve("two");
  await soon();
  found.asked[0].resolve("one");
  await soon();
  assert.equal(found.panel.answer, "two");
});

test("the late answer to a question that is posed again is dropped for the new one", async () => {
  const found = one({ deaf: true });
  for (const a of [1, 2, 1]) {
    found.store.set({ a });
    mock.timers.tick(0);
  }
  found.asked[0].resolve("from before");
  await soon();
  assert.equal(found.panel.state, "asking");
  found.asked[2].resolve("now");
  await soon();
  assert.equal(found.panel.answer, "now");
});

test("a late failure is dropped as well", async () => {
  const found = one();
  found.store.set({ a: 1 });
  mock.timers.tick(0);
  await answered(found, 2, "two");
  assert.deepEqual([found.panel.state, found.panel.error], ["there", null]);
});

test("inputs that pose no question withdraw the answer at once and give the request up", async () => {
  const found = one();
  await answered(found, 1, "one");
  found.store.set({ a: null });
  assert.deepEqual([found.panel.state, found.panel.answer, found.panel.old, found.panel.digest], ["none", null, null, null]);
  found.store.set({ a: 3 });
  mock.timers.tick(0);
  found.store.set({ a: null });
  assert.equal(found.asked.at(-1).signal.aborted, true);
  await soon();
  assert.equal(found.panel.state, "none");
});

test("to pose no question at first is shown too", () => {
  const found = one();
  found.store.set();
  assert.deepEqual(found.shown, [["none", null]]);
});

test("an input that is no part of the question changes nothing", async () => {
  const found = one();
  await answered(found, 1, "one");
  const before = found.shown.length;
  found.store.set({ b: 7 });
  assert.equal(found.panel.answer, "one");
  assert.equal(found.shown.length, before);
});

test("nothing is asked before the inputs have rested, unless it is hastened", () => {
  const found = one({ quiet: QUIET_MS });
  found.store.set({ a: 1 });
  mock.timers.tick(QUIET_MS - 1);
  found.store.set({ a: 2 });
  mock.timers.tick(QUIET_MS - 1);
  assert.deepEqual(found.asked, []);
  found.store.hasten();
  assert.deepEqual(found.asked.map(({ question }) => question), [2]);
  mock.timers.tick(2 * QUIET_MS);
  found.store.hasten();
  assert.equal(found.asked.length, 1, "what is under way is not asked twice");
});

test("a failure withdraws the answer, and is asked again on demand", async () => {
  const found = one();
  await answered(found, 1, "one");
  found.store.set({ a: 2 });
  mock.timers.tick(0);
  found.asked.at(-1).reject(new Error("away"));
  await soon();
  assert.deepEqual([found.panel.state, found.panel.answer, found.panel.old, found.panel.error.message], ["failed", null, null, "away"]);
  found.store.hasten();
  mock.timers.tick(0);
  found.asked.at(-1).resolve("two");
  await soon();
  assert.deepEqual([found.panel.state, found.panel.answer, found.panel.error], ["there", "two", null]);
});

test("when one panel is shown, every other one has taken the new inputs", async () => {
  const store = new Store({ a: 1 }), states = [];
  const parts = (name) => ({
    poses: ({ a }) => ({ name, a }), asks: async ({ a }) => a,
    shows: () => states.push([one1.answer, two.answer]),
  });
  const one1 = store.panel(parts("one")), two = store.panel(parts("two"));
  store.set();
  mock.timers.tick(0);
  await soon();
  states.length = 0;
  store.set({ a: 2 });
  assert.deepEqual(states, [[null, null], [null, null]]);
});
