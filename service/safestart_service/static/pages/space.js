// Explore in space: any start, tumble, orbit, corridor and thrust; the verdict with its proof, slices of the region, the flight.

import { addressOf, textsFrom } from "../logic/fields.js";
import { FIELDS, REGIONS, STARTS, counting, proofAddress, readSpace, regionQuestion, sliceLacks, spaceWords, startQuestion, textsOf } from "../logic/space.js";
import { offered } from "../logic/space-presets.js";
import { Store } from "../logic/store.js";
import { rowsOf } from "../logic/tables.js";
import { HELD, csv, figure, sentence, spoken } from "../logic/words.js";
import { onMove, writeAddress } from "../parts/address.js";
import { call, execute, get, plain } from "../parts/api.js";
import { saveButtons } from "../parts/chart.js";
import { copies } from "../parts/copies.js";
import { Flight } from "../parts/flight.js";
import { explain, explained } from "../parts/glossary.js";
import { $, definition, download, el, fail, save } from "../parts/page.js";
import { drawSpace } from "../parts/space.js";
import { waiting } from "../parts/waiting.js";

const { texts, unknown } = textsFrom(FIELDS, location.search);
const store = new Store(texts), scene = $("space"), flight = new Flight(redraw, ["play", "clock"]);
let examples = {};

/** Values of the fields; null if one of them is invalid. */
function given(inputs) {
  const { values, wrong } = readSpace(inputs);
  return Object.keys(wrong).length ? null : values;
}

const verdict = store.panel({
  quiet: 250,
  poses: (inputs) => { const values = given(inputs); return values && { ...startQuestion(values), flights: true }; },
  asks: async (question, signal) => plain(await execute(STARTS, question, { signal })),
  shows: showVerdict,
});

const region = store.panel({
  quiet: 400,
  poses: (inputs) => { const values = given(inputs); return values && regionQuestion(values); },
  asks: async (question, signal) => plain(await execute(REGIONS, question, { signal })),
  shows: () => redraw(),
});

function redraw() {
  const values = given(store.inputs), answer = verdict.answer;
  scene.dataset.digest = verdict.state === "there" ? verdict.digest : "";
  scene.dataset.proved = region.state === "there" ? region.digest : "";
  scene.hidden = values === null;
  showRegion(values);
  if (values === null) return;
  drawSpace(scene, { values, told: answer?.turning ?? null, region: region.answer, flight: answer && flight.data, step: flight.step, frame: $("frame").value, word: answer?.verdict[0], says: spaceWords(values) });
}

function showRegion(values) {
  const place = $("region"), lacks = values ? sliceLacks(values) : [];
  $("slices-lack").textContent = lacks.length ? `The slices do not ask: ${lacks.join("; ")}. The verdict does.` : "";
  if (region.state === "failed") fail(place, region.error, () => store.hasten());
  else if (region.state === "asking") {
    if (place.dataset.awaits !== region.digest || !place.hasChildNodes()) waiting(place, "Proving the slices", { id: REGIONS, inputs: region.question });
  } else if (region.state === "there") place.replaceChildren(el("p", { class: "note" }, sliceWords(region.answer.planes)));
  else place.replaceChildren();
  place.dataset.awaits = region.state === "asking" ? region.digest : "";
}

const sliceWords = (planes) => `Slices of the starts at this velocity, through the start: ${planes.map((one) => `${one.name} ${figure(one.inner_area, 3)} m² proved GO${one.message ? ` (${one.message})` : ""}`).join(", ")}.`;

function showVerdict(panel) {
  const place = $("verdict"), values = given(store.inputs);
  place.dataset.digest = panel.state === "there" ? panel.digest : "";
  showFlight(panel);
  if (panel.state === "failed") fail(place, panel.error, () => store.hasten());
  else if (panel.state === "none") {
    const { wrong } = readSpace(store.inputs);
    place.replaceChildren(el("div", { class: "problem", role: "alert" }, el("h2", {}, "Not checked"), ...Object.entries(wrong).map(([name, text]) => el("p", {}, `${FIELDS[name].title}: ${text}.`))));
  } else if (panel.answer ?? panel.old) place.replaceChildren(card(panel.answer ?? panel.old, panel.answer === null, values));
  else place.replaceChildren(el("p", { class: "empty", role: "status" }, "Checking …"));
}

const SURE = { GO: "proved", NO_GO: "proved", UNDECIDED: "neither proved nor refuted" };

function card(found, old, values) {
  const wire = found.verdict[0], said = wire.replace("_", " "), proved = wire !== "UNDECIDED";
  const facts = [["Margin, proved", found.margin_m[0] === null ? "–" : `${figure(found.margin_m[0])} m`], ["The linear model may be off by", `${figure(found.model_error_m[0], 2)} m`]];
  if (found.end_s) facts.push(["At rest after", found.end_s[0] === null ? "–" : `${figure(found.end_s[0])} s`]);
  if (found.flight?.[0]) facts.push(["Delta-v", `${figure(found.flight[0].delta_v_m_s, 3)} m/s`]);
  return el("div", { class: `answer ${old ? "old" : wire}` },
    el("h2", {}, el("span", { class: "word" }, said), ...explained(said), el("span", { class: "how" }, old ? "old: the inputs have changed" : SURE[wire])),
    old || !values ? null : el("p", { class: "asked" }, spaceWords(values)), el("p", { class: "why" }, sentence(found.reason[0])),
    found.violated_faces[0].length ? el("p", {}, `The start lies outside ${found.violated_faces[0].map(spoken).join(", ")}.`) : null,
    el("dl", { class: "facts" }, ...facts.map(([name, value]) => definition(name, value))),
    proved && !old && values ? el("p", { id: "proof" }, download(call, proofAddress(startQuestion(values)), "proof.json", "Download the proof"), " (checked by ", el("code", {}, "safestart verify"), ")") : null);
}

const NONE = { NO_GO: `No flight: no thrust ${HELD} does what is asked.`, UNDECIDED: "No flight is known that does what is asked." };

function showFlight({ state, answer }) {
  const flown = answer?.flight?.[0];
  if (state !== "there") flight.clear(state === "asking" ? "Computing the flight …" : "");
  else if (!flown) flight.clear(NONE[answer.verdict[0]] ?? "");
  else if (flight.data?.time_s !== flown.time_s) {
    const values = given(store.inputs);
    flight.load({ ...flown, faces: answer.faces.slice(0, flown.distance_m[0].length) }, `Flown: the proof's thrust history; delta-v ${figure(flown.delta_v_m_s, 3)} m/s.`, values.thrust === "ball" ? values.a_max_m_s2 : null);
  }
  redraw();
}

// ---- the fields

/** Change inputs; `writing` is the field that the user is typing in, whose text stays unchanged. */
function change(inputs, writing = null) {
  store.set(inputs);
  const counts = counting(store.inputs), { wrong } = readSpace(store.inputs);
  for (const name of Object.keys(FIELDS)) {
    const field = $(name);
    if (name !== writing && field.value !== store.inputs[name]) field.value = wrong[name] && field.type === "number" ? "" : store.inputs[name];
    if (wrong[name]) field.setAttribute("aria-invalid", "true");
    else field.removeAttribute("aria-invalid");
    field.closest(".dial").hidden = !counts.has(name);
  }
  if (!Object.keys(wrong).length) writeAddress(`${location.pathname}${addressOf(FIELDS, store.inputs)}`);
}

// What fills in forms may tell of a change alone.
for (const kind of ["input", "change"]) {
  $("controls").addEventListener(kind, ({ target }) => {
    // A number field gives no text for an invalid number.
    if (target.name in FIELDS) change({ [target.name]: target.validity.badInput ? "no number" : target.value }, target.name);
  });
}
$("controls").addEventListener("submit", (event) => { event.preventDefault(); store.hasten(); });
$("frame").addEventListener("change", redraw);
$("preset").addEventListener("change", ({ target }) => {
  const chosen = offered(examples).find(([name]) => name === target.value);
  $("preset-note").textContent = chosen?.[2] ? `${chosen[2]}.` : "";
  if (!chosen) return;
  change(textsOf(examples[chosen[0]]));
  store.hasten();
});
scene.after(saveButtons(scene, "space", el));
$("verdict").after(copies(() => { const values = given(store.inputs); return values && { id: STARTS, inputs: { ...startQuestion(values), proofs: true } }; }, store));
$("flight-tools").append(el("button", { type: "button", class: "plain", onclick: () => save("flight.csv", csv(rowsOf(flight.data))) }, "Flight as CSV"));
if (unknown.length) $("address").textContent = `The address has settings that this page does not know: ${unknown.join(", ")}.`;
explain($("controls"));
onMove((search) => {
  change(textsFrom(FIELDS, search).texts);
  store.hasten();
});
change({});
store.hasten();

try {
  examples = (await get(`/processes/${STARTS}`))["safestart:examples"];
  $("preset").append(...offered(examples).map(([name, title]) => el("option", { value: name }, title)));
} catch (error) {
  fail($("preset-note"), error);
}
