// Approach designer: a line that is dragged, its hops and drifts with their proof, and the study of the same approach.

import { FIELDS, SAYS, angleOf, burnRows, holdOf, isOf, lasting, planNeeds, planOf, planWords, risk, studyOf } from "../logic/approach.js";
import { addressOf, textsFrom, valuesOf } from "../logic/fields.js";
import { Store } from "../logic/store.js";
import { csv, figure } from "../logic/words.js";
import { onMove, writeAddress } from "../parts/address.js";
import { call, execute, get, plain, root } from "../parts/api.js";
import { saveButtons } from "../parts/chart.js";
import { copies } from "../parts/copies.js";
import { $, definition, el, fail, loading, save, table } from "../parts/page.js";
import { draggable, drawPlane } from "../parts/plane.js";

const { plan: PLANS, study: STUDIES } = $("designer").dataset;
const LOOKS_S = 3; // how often a study that runs is looked at
const MOST_JOBS = 20;
const { texts, unknown } = textsFrom(FIELDS, location.search);
const store = new Store(texts), map = $("map"), known = new Map();

/** Values of the plan's fields; null if one of them is invalid. */
function planned(inputs) {
  const { values, wrong } = valuesOf(FIELDS, inputs);
  return planNeeds(wrong).length ? null : values;
}

/** Inputs of the study; null if any field is invalid. */
function studied(inputs) {
  const { values, wrong } = valuesOf(FIELDS, inputs);
  return Object.keys(wrong).length ? null : studyOf(values);
}

const plan = store.panel({
  quiet: 80,
  poses: (inputs) => { const values = planned(inputs); return values && planOf(values); },
  asks: async (question, signal) => plain(await execute(PLANS, question, { signal })),
  shows: showPlan,
});

const study = store.panel({
  quiet: 250,
  poses: studied,
  asks: storedStudy,
  shows: showStudy,
});

// ---- the plan

function showPlan({ state, answer, old, error, digest }) {
  const values = planned(store.inputs), place = $("verdict");
  map.dataset.digest = place.dataset.digest = state === "there" ? digest : "";
  map.hidden = values === null;
  if (values !== null) drawPlane(map, { values, answer, old, says: planWords(values), near: $("near").getAttribute("aria-pressed") === "true" });
  if (state === "failed") fail(place, error, () => store.hasten());
  else if (state === "none") place.replaceChildren(wrongFields());
  else if (answer ?? old) place.replaceChildren(...card(answer ?? old, answer === null));
  else loading(place, "Proving");
  $("burns").replaceChildren(...(answer ? burns(answer) : []));
}

function wrongFields() {
  const { wrong } = valuesOf(FIELDS, store.inputs);
  return el("div", { class: "problem", role: "alert" }, el("h2", {}, "Not planned"), ...planNeeds(wrong).map((name) => el("p", {}, `${FIELDS[name].title}: ${wrong[name]}.`)));
}

const SENSE = { PROVED: "GO", VIOLATED: "NO_GO", UNKNOWN: "UNDECIDED" };

function card(found, old) {
  const facts = [
    ["Fuel, 1-norm", `${figure(found.plan.fuel_1norm_m_s)} m/s`], ["2-norm", `${figure(found.plan.fuel_2norm_m_s)} m/s`], ["Length", lasting(found)],
    ["Error level lambda, proved", figure(found.lambda)], ["Nearest, proved", `${figure(Math.min(...found.proofs.map((one) => one.least_distance_m)))} m`],
  ];
  return [
    el("div", { class: `answer ${old ? "old" : SENSE[found.verdict]}` },
      el("h2", {}, el("span", { class: "word" }, found.verdict), el("span", { class: "how" }, old ? "old: the inputs have changed" : SAYS[found.verdict])),
      old ? null : el("p", { class: "asked" }, planWords(planned(store.inputs))), el("dl", { class: "facts" }, ...facts.map(([name, value]) => definition(name, value)))),
  ];
}

/** Rounding alone is no burn. */
const clean = (value) => (Math.abs(value) < 1e-12 ? 0 : value);

function burns(found) {
  const proof = (k) => found.proofs[k];
  return [
    table(found.burns, [
      ["burn", (row) => row.burn], ["time [s]", (row) => row.time_s], ["from [m]", (row) => row.distance_m], ["radial [m/s]", (row) => clean(row.impulse_m_s[0])], ["along-track [m/s]", (row) => clean(row.impulse_m_s[1])],
      ["if it is the last", (row) => proof(row.burn - 1)?.verdict ?? "stops"], ["keeps, proved [m]", (row) => proof(row.burn - 1)?.least_distance_m ?? null],
    ], "Table of burns"),
    el("div", { class: "tools" }, el("button", { type: "button", class: "plain", onclick: () => save("burns.csv", csv(burnRows(found))) }, "Burns as CSV")),
  ];
}

// ---- the study

/** The latest study with these inputs: its outputs, or where it stands; null without one. */
async function storedStudy(question, signal) {
  const { jobs } = await get(`/jobs?${new URLSearchParams({ processID: STUDIES, limit: MOST_JOBS })}`, { signal });
  const found = [];
  for (const { jobID, status } of jobs) {
    if (!known.has(jobID)) known.set(jobID, (await get(`/jobs/${jobID}`, { signal })).inputs);
    if (isOf(known.get(jobID), question)) found.push({ jobID, status });
  }
  const job = found.find(({ status }) => status === "successful") ?? found.find(({ status }) => ["running", "accepted"].includes(status));
  if (!job) return { job: null };
  if (job.status !== "successful") return { job };
  const { outputs } = await get(`/jobs/${job.jobID}/results`, { signal });
  return { job, said: outputs.study };
}

let looks = 0;

function showStudy({ state, answer, old, error, digest }) {
  const place = $("study");
  clearTimeout(looks);
  place.dataset.digest = state === "there" ? digest : "";
  place.classList.toggle("old", old !== null);
  $("submit").disabled = state !== "there" || answer.job !== null;
  if (state === "failed") return fail(place, error, () => store.hasten());
  if (state === "none") return place.replaceChildren(el("p", { class: "empty" }, "A field cannot be read."));
  const shown = answer ?? old;
  if (!shown) return loading(place, "Looking for a study");
  if (answer?.job && !answer.said) looks = setTimeout(() => study.refresh(), 1000 * LOOKS_S);
  return place.replaceChildren(...told(shown));
}

function told({ job, said }) {
  if (!job) return [el("p", { class: "note" }, "No study of these inputs yet: it flies the approach about the true Earth, with noise, and aborts after every hop.")];
  const link = (text) => el("a", { href: `${root}/dashboard/jobs/${job.jobID}` }, text);
  if (!said) return [el("p", { role: "status" }, "The study is under way: ", link("follow it"), ". Its answer appears here.")];
  return [
    el("dl", { class: "facts" }, definition("Abort breach probability", risk(said)), definition("Approaches flown", figure(said.breach.runs)), definition("Fuel flown, 1-norm", `${figure(said.fuel_1norm_m_s)} m/s`), definition("Distance at the end", `${figure(said.hold_m)} m`)),
    el("p", {}, link("The study")),
  ];
}

async function submit() {
  const question = studied(store.inputs);
  if (question === null) return;
  $("submit").disabled = true;
  try {
    await call(`/processes/${STUDIES}/execution`, { method: "POST", json: { inputs: question }, headers: { Prefer: "respond-async" } });
    study.refresh();
  } catch (error) {
    // A refusal belongs to the inputs that were sent.
    const now = studied(store.inputs);
    if (now && isOf(now, question)) { fail($("study"), error); $("submit").disabled = false; }
  }
}

// ---- the fields

/** Change inputs; `writing` is the field that the user is typing in, whose text stays unchanged. */
function change(inputs, writing = null) {
  store.set(inputs);
  const { values, wrong } = valuesOf(FIELDS, store.inputs);
  for (const name of Object.keys(FIELDS)) {
    const field = $(name), text = wrong[name] && field.type === "number" ? "" : store.inputs[name];
    if (name !== writing && field.value !== text) field.value = text;
    if (wrong[name]) field.setAttribute("aria-invalid", "true");
    else field.removeAttribute("aria-invalid");
    const range = document.querySelector(`input[data-for="${name}"]`);
    if (range && values[name] !== null && range !== document.activeElement) range.value = values[name];
  }
  if (!Object.keys(wrong).length) writeAddress(`${location.pathname}${addressOf(FIELDS, store.inputs)}`);
}

// What fills in forms may tell of a change alone.
for (const kind of ["input", "change"]) {
  $("controls").addEventListener(kind, ({ target }) => {
    const name = target.dataset.for ?? target.name;
    // A number field gives no text for an invalid number.
    if (name in FIELDS) change({ [name]: target.validity.badInput ? "no number" : target.value }, target.dataset.for ? null : name);
  });
}
$("controls").addEventListener("submit", (event) => { event.preventDefault(); store.hasten(); });
$("submit").addEventListener("click", submit);
draggable(map, () => planned(store.inputs), (handle, point) => {
  const values = planned(store.inputs), angle = angleOf(point);
  if (values === null) return;
  if (handle === "hold") change({ hold_m: String(holdOf(point, values)) });
  else if (angle !== null) change({ angle_deg: String(angle) });
});
$("near").addEventListener("click", ({ target }) => {
  target.setAttribute("aria-pressed", String(target.getAttribute("aria-pressed") !== "true"));
  plan.show();
});
map.after(saveButtons(map, "approach", el));
$("verdict").after(copies(() => { const values = planned(store.inputs); return values && { id: PLANS, inputs: planOf(values) }; }, store));
if (unknown.length) $("address").textContent = `The address has settings that this page does not know: ${unknown.join(", ")}.`;
for (const details of document.querySelectorAll("#controls details")) {
  details.open = [...details.querySelectorAll("[name]")].some(({ name }) => store.inputs[name] !== FIELDS[name].first);
}
onMove((search) => {
  change(textsFrom(FIELDS, search).texts);
  store.hasten();
});
change({});
store.hasten();
