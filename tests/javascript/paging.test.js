// The state of the list of jobs in its address, and its requests.

import assert from "node:assert/strict";
import { test } from "node:test";

import { counted, fromAddress, pagesOf, request, sorted, toAddress, USUAL } from "../../service/safestart_service/static/logic/paging.js";
import { inputWords } from "../../service/safestart_service/static/logic/titles.js";

test("an address holds the state, and what is wrong in it is as usual", () => {
  const state = { ...USUAL, search: "#a b", sort: "name", page: 3 };
  assert.deepEqual({ ...fromAddress(toAddress(state)), page: 3 }, state);
  assert.equal(toAddress(USUAL), "");
  for (const wrong of ["0", "-1", "1.5", "x", "1e9"]) assert.equal(fromAddress(`?page=${wrong}`).page, 1);
  assert.deepEqual(fromAddress("?colour=red"), USUAL);
});

test("a word after # is a tag, all others are searched for", () => {
  const asked = new URLSearchParams(request({ ...USUAL, search: "burn #night #envisat one #", page: 2 }).split("?")[1]);
  assert.equal(asked.get("search"), "burn one #");
  assert.deepEqual(asked.getAll("tag"), ["night", "envisat"]);
  assert.equal(asked.get("offset"), "25");
  assert.equal(asked.get("sort"), null);
  assert.equal(request(USUAL), "/jobs?limit=25");
});

test("a column's head turns the order round", () => {
  assert.equal(sorted("-created", "name", false), "name");
  assert.equal(sorted("name", "name", false), "-name");
  assert.equal(sorted("-name", "name", false), "name");
  assert.equal(sorted("name", "duration", true), "-duration");
  assert.equal(sorted("-duration", "duration", true), "duration");
});

test("pages and numbers as people count them", () => {
  assert.deepEqual([0, 1, 25, 26].map(pagesOf), [1, 1, 1, 2]);
  assert.deepEqual([7, 999, 1000, 1234567].map(counted), ["7", "999", "1 000", "1 234 567"]);
  assert.equal(inputWords("grid.y_max_m", "150"), "corridor cut at 150 m");
  assert.equal(inputWords("seed", "3"), "seed 3");
});
