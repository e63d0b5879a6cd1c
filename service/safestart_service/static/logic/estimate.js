// How long something takes: an estimate in words, and the share of it that has passed.

import { duration } from "./words.js";

const many = (runs) => `${runs} earlier ${runs === 1 ? "run" : "runs"}`;
const spread = ({ least_s: least, most_s: most }) => (duration(least) === duration(most) ? "" : `, ${duration(least)} to ${duration(most)}`);

/** An estimate of the service in words; it says what it is known from. */
export function estimateWords({ basis, seconds, runs, ...ends }) {
  if (basis === null) return "How long it takes is not known: no run of this process is stored.";
  if (basis === "same inputs") return `Takes about ${duration(seconds)} once it starts: measured, ${many(runs)} with these inputs${spread(ends)}.`;
  if (basis === "process") return `Takes about ${duration(seconds)} once it starts: calculated from the inputs, within a factor of two or so.`;
  return `Runs with other inputs took ${duration(seconds)} (median of ${many(runs)}${spread(ends)}); this one may take another time.`;
}

/** What has passed of an estimate, in words; past it, no promise is made. */
export function passedWords(passed, seconds) {
  if (seconds === null) return `${Math.round(passed)} s so far`;
  return passed <= seconds ? `${Math.round(passed)} s of about ${duration(seconds)}` : `${Math.round(passed)} s, longer than the estimated ${duration(seconds)}`;
}
