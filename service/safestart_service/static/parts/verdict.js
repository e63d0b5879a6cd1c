// Explore's verdict: one word that counts, the question it answers, and the closed form beside it, small.

import { proved, verdictWords } from "../logic/question.js";
import { figure, sentence } from "../logic/words.js";
import { call } from "./api.js";
import { download, el } from "./page.js";

const margin = (name, value) => el("li", { class: value > 0 ? "in" : "out" }, `${name} `, el("b", {}, `${figure(value, 3)} m`));

/** The cards of one answer: `{ values, start, exact, quick }`; `old` where the inputs have changed since. */
export function verdict({ values, start, exact, quick }, old) {
  const word = exact.verdict.replace("_", " ");
  const proof = exact.proof_url && !old
    ? el("p", {}, download(call, exact.proof_url, "proof.json", "Download the proof"), " (checked by ", el("code", {}, "safestart verify"), ")") : null;
  return [
    el("div", { class: `answer ${old ? "old" : exact.verdict}` },
      el("h2", {}, el("span", { class: "word" }, word), el("span", { class: "how" }, old ? "old: the inputs have changed" : proved(exact.verdict, values))),
      el("p", { class: "asked" }, verdictWords(values, start)), el("p", { class: "why" }, sentence(exact.reason)), members(exact.examples), proof),
    el("section", { class: `aside${old ? " old" : ""}`, "aria-label": "Closed form" },
      el("h3", {}, "Closed form, no proof: ", el("span", { class: "closed-word" }, quick.verdict.replace("_", " "))),
      el("p", {}, `${sentence(quick.reason)} It knows neither time nor ranges.`),
      el("ul", { class: "margins" }, ...Object.entries(quick.face_margins_m).map(([face, value]) => margin(face, value)),
        quick.range_margin_m === null ? null : margin("range", quick.range_margin_m))),
  ];
}

/** Members of an undecided family that were decided: why there is no verdict for all. */
function members(examples) {
  if (!examples?.length) return null;
  return el("ul", { class: "members" }, ...examples.map((one) => el("li", {},
    `${one.verdict.replace("_", "-")} at ${figure(one.omega_t_deg_s)} deg/s, ${figure(one.a_max_m_s2)} m/s², LVLH (${one.position_m.map((at) => figure(at)).join(", ")}) m`)));
}
