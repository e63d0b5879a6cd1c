// Forms: what a schema says of a field, and what is sent of what was typed.

import assert from "node:assert/strict";
import { test } from "node:test";

import { bounds, filled, numbers, parsed, resolve } from "../../service/safestart_service/static/logic/schema.js";

test("a field that may be null is the field itself, optional", () => {
  for (const none of [{ type: "null" }, { enum: [null] }]) {
    const found = resolve({ anyOf: [{ type: "number", minimum: 0 }, none], default: null }, {});
    assert.deepEqual([found.type, found.minimum, found.optional, found.default], ["number", 0, true, null]);
  }
  assert.ok(resolve({ anyOf: [{ type: "number" }, { type: "string" }] }, {}).anyOf, "more than one alternative stays one");
});

test("references and single parts are followed", () => {
  const whole = { $defs: { Corridor: { type: "object", properties: {} } } };
  assert.equal(resolve({ allOf: [{ $ref: "#/$defs/Corridor" }], title: "corridor" }, whole).type, "object");
});

test("bounds are written as people write them", () => {
  assert.equal(bounds({ minimum: 5e-324, maximum: 100 }), "(> 0, ≤ 100)");
  assert.equal(bounds({ minimum: 0.00010000000000000002 }), "(> 0.0001)");
  assert.equal(bounds({ minimum: 0, maximum: 0.0013, multipleOf: 2, maxItems: 3 }), "(≥ 0, ≤ 0.0013, a multiple of 2, at most 3)");
  assert.equal(bounds({ maximum: 2 ** 63 }), "(≤ 9223372036854776000)");
  assert.equal(bounds({ exclusiveMinimum: 0 }), "(> 0)");
  assert.equal(bounds({}), "");
});

test("what is no number is sent as it is, to be refused by name", () => {
  assert.deepEqual(numbers("1, 2.5,x, "), [1, 2.5, "x", ""]);
  assert.equal(numbers("  "), undefined);
  assert.deepEqual([parsed("[1]"), parsed("{"), parsed("")], [[1], "{", undefined]);
});

test("an object that nothing was typed into is left out, unless it is asked for", () => {
  assert.equal(filled([["a", undefined]], true), undefined);
  assert.deepEqual(filled([["a", undefined]], false), {});
  assert.deepEqual(filled([["a", undefined], ["b", 0]], true), { b: 0 });
  const spin = { required: ["a"], properties: { a: {}, b: { default: 0 } } };
  assert.equal(filled([["a", undefined], ["b", 0]], true, spin), undefined, "nobody began it");
  assert.deepEqual(filled([["a", undefined], ["b", 1]], true, spin), { b: 1 }, "the service says what is missing");
  assert.deepEqual(filled([["a", 2], ["b", 0]], true, spin), { a: 2, b: 0 });
  const usual = { properties: { tau: { default: 10 } } };
  assert.equal(filled([["tau", 10]], true, usual), undefined, "a part that is complete without anybody stays absent, too");
  assert.deepEqual(filled([["tau", 20]], true, usual), { tau: 20 });
});
