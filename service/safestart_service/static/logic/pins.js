// Pinned starts: each with the question that it was asked and the answer to that question, whatever the fields say since.

import { ASKED, proven } from "./question.js";
import { digest } from "./store.js";

export const MOST_STARTS = 200;

/** Starts of a text, "x y" or "x, y" on each line: `{ starts, wrong }`; `wrong` says what is the matter, or is "". */
export function startsOf(text) {
  const starts = [], lines = text.split("\n").map((line, k) => [line.trim(), k + 1]).filter(([line]) => line !== "");
  if (!lines.length) return { starts, wrong: "a start is required, as x and y in metres on a line" };
  for (const [line, k] of lines) {
    const parts = line.split(/[\s,;]+/).filter(Boolean), numbers = parts.map(Number);
    if (parts.length !== 2 || !numbers.every(Number.isFinite)) return { starts: [], wrong: `line ${k}: two numbers are required, not ${line.slice(0, 40)}` };
    starts.push({ x_m: numbers[0], y_m: numbers[1] });
  }
  if (starts.length > MOST_STARTS) return { starts: [], wrong: `at most ${MOST_STARTS} starts are required, not ${starts.length}` };
  return { starts, wrong: "" };
}

/** The question of values without the start and the extent of the map. */
const asked = (values) => digest(proven(values, {}));

/** A pinned start out of its question and the answer for it. */
export const pinned = (values, start, { verdict, margin_m = null, decided_by = null, reason = "" }) => ({
  values: { ...values, ...start }, start, verdict, margin_m, decided_by, reason, asked: asked(values), id: digest([asked(values), start]),
});

/** Pinned starts out of the outputs of the process that answers for many. */
export const pinnedAll = (values, starts, outputs) => starts.map((start, k) => pinned(values, start,
  Object.fromEntries(["verdict", "margin_m", "decided_by", "reason"].map((name) => [name, outputs[name]?.[k] ?? undefined]))));

/** The list with new ones first; one that is asked again takes its old place's answer away. */
export const added = (list, fresh) => [...fresh, ...list.filter(({ id }) => !fresh.some((one) => one.id === id))];

/** Those of the list that were asked what these values ask; none where there are no values. */
export const alike = (list, values) => (values === null ? [] : list.filter((one) => one.asked === asked(values)));

/** What differs between the questions of the list: names of values. Who stays asks nothing within a time. */
export const differing = (list) => ASKED.filter((name) => new Set(list.map(({ values }) => (name === "within_s" && values.question === "stay" ? null : values[name]))).size > 1);
