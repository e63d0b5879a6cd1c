// Explore's verdict: one word, its question, the deciding method, and beside it, small, the paper's conditions.

import { DECIDED, memberWords, proved, verdictWords } from "../logic/question.js";
import { figure, sentence, spoken } from "../logic/words.js";
import { call } from "./api.js";
import { explained } from "./glossary.js";
import { download, el } from "./page.js";

const margin = (name, value) => el("li", { class: value > 0 ? "in" : "out" }, `${name} `, el("b", {}, `${figure(value, 3)} m`));

/** The cards of one answer: `{ values, start, found, paper }`; `old` if the inputs have changed since. */
export function verdict({ values, start, found, paper }, old) {
  const word = found.verdict.replace("_", " ");
  const proof = found.proof_url && !old
    ? el("p", {}, download(call, found.proof_url, "proof.json", "Download the proof"), " (checked by ", el("code", {}, "safestart verify"), ")") : null;
  return [
    el("div", { class: `answer ${old ? "old" : found.verdict}` },
      el("h2", {}, el("span", { class: "word" }, word), ...explained(word), el("span", { class: "how" }, old ? "old: the inputs have changed" : proved(found.verdict, values))),
      el("p", { class: "asked" }, verdictWords(values, start)), el("p", { class: "why" }, sentence(found.reason)),
      found.decided_by ? el("p", { class: "note" }, `Decided ${DECIDED[found.decided_by] ?? `by ${found.decided_by}`}.`) : null, members(found.examples, values, start), proof),
    el("details", { class: `aside${old ? " old" : ""}` },
      el("summary", {}, el("h3", {}, "The paper's conditions, not sound: ", el("span", { class: "closed-word" }, paper.verdict.replace("_", " ")))),
      el("p", {}, `${sentence(paper.reason)} They know neither the mean motion nor time nor ranges; a GO of theirs may be impossible to fly.`),
      el("ul", { class: "margins" }, ...Object.entries(paper.face_margins_m).map(([face, value]) => margin(spoken(face), value)),
        paper.range_margin_m === null ? null : margin("range", paper.range_margin_m))),
  ];
}

/** Decided members of an undecided family, which show why there is no verdict for all. */
function members(examples, values, start) {
  if (!examples?.length) return null;
  return el("ul", { class: "members" }, ...examples.map((one) => el("li", {}, memberWords(one, values, start))));
}
