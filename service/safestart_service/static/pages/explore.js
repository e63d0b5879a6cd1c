// Explore: the operating point, the regions, one start, its flight. Store and address hold the text of every field.

import { nearest, within } from "../logic/geometry.js";
import { pinned } from "../logic/pins.js";
import { PRESETS } from "../logic/presets.js";
import { FIELDS, asProcess, certificate, flight as flightOf, flightWords, fromAddress, mapLacks, mapWords, paper, proven, read, region as regionOf, start as startOf, toAddress } from "../logic/question.js";
import { Store } from "../logic/store.js";
import { rowsOf } from "../logic/tables.js";
import { csv, figure, spoken } from "../logic/words.js";
import { onMove, writeAddress } from "../parts/address.js";
import { execute, get, post } from "../parts/api.js";
import { saveButtons } from "../parts/chart.js";
import { copies } from "../parts/copies.js";
import { Flight } from "../parts/flight.js";
import { explain } from "../parts/glossary.js";
import { drawMap, pointAt } from "../parts/map.js";
import { $, el, fail, save } from "../parts/page.js";
import { Pins } from "../parts/pins.js";
import { listStored, storedInputs, storedNote, storedSets } from "../parts/stored.js";
import { verdict as verdictCards } from "../parts/verdict.js";
import { waiting } from "../parts/waiting.js";

const { texts, unknown } = fromAddress(location.search);
const store = new Store({ ...texts, job: "" });
const map = $("map"), flight = new Flight(redraw);
const pins = new Pins({
  given: () => given(store.inputs),
  open(values) {
    change(Object.fromEntries(Object.keys(FIELDS).filter((name) => values[name] !== null).map((name) => [name, String(values[name])])));
    store.hasten();
  },
  changed: redraw,
});
const query = (question) => `/go-no-go?${new URLSearchParams(question)}`;
let begun = 0;

/** The values of the fields; null if one of them is invalid. */
function given(inputs) {
  const { values, wrong } = read(inputs);
  return Object.keys(wrong).length ? null : values;
}

/** The same with a start. */
function started(inputs) {
  const values = given(inputs), start = values && startOf(values);
  return start && { values, start };
}

// ---- the panels, each with its question

const certified = store.panel({
  poses: (inputs) => { const values = given(inputs); return values && certificate(values); },
  asks: (question, signal) => post("/certificates", question, { signal }),
  shows: () => redraw(),
});

const region = store.panel({
  quiet: 180,
  poses: (inputs) => { const values = given(inputs); return values && regionOf(values); },
  asks: (question, signal) => execute("safe-region", question, { signal }),
  shows: () => redraw(),
});

const verdict = store.panel({
  quiet: 180,
  poses: (inputs) => { const asked = started(inputs); return asked && { proven: proven(asked.values, asked.start), paper: paper(asked.values, asked.start), asked }; },
  asks: async (question, signal) => {
    const [conditions, found] = await Promise.all([get(query(question.paper), { signal }), get(query(question.proven), { signal })]);
    return { ...question.asked, paper: conditions, found };
  },
  shows: showVerdict,
});

const flown = store.panel({
  quiet: 180,
  poses: (inputs) => { const asked = started(inputs); return asked && flightOf(asked.values, asked.start); },
  asks: (question, signal) => execute("flight", question, { signal }),
  shows: showFlight,
});

const pointed = new Store({ at: null, values: null });
pointed.panel({
  quiet: 60,
  poses: ({ at, values }) => at && values && paper(values, { x_m: at[0], y_m: at[1] }),
  asks: (question, signal) => get(query(question), { signal }),
  shows: showPointed,
});

const stored = store.panel({
  poses: ({ job }) => job || null,
  asks: storedSets,
  shows: () => redraw(),
});

// ---- their pictures and texts

/** The inputs of the picture, and the frame in which the next one is drawn; 0 for none. */
let drawnFor = null, due = 0;

/** Whether the previous picture stays, greyed, as the next answer is awaited. */
const stays = () => (certified.old !== null || region.old !== null) && certified.state === "asking";

/** Mark the picture at once, and draw it anew in the next frame: several panels change with one key. */
function redraw() {
  const values = given(store.inputs), fresh = drawnFor === store.inputs;
  map.hidden = values === null;
  map.classList.toggle("old", values !== null && (!fresh || stays()));
  map.dataset.digest = fresh && certified.state === "there" ? certified.digest : "";
  map.dataset.proved = fresh && region.state === "there" ? region.digest : "";
  showMapState();
  if (values !== null && !stays() && due === 0) due = requestAnimationFrame(paint);
}

function paint() {
  due = 0;
  const values = given(store.inputs);
  if (values === null || stays()) return;
  const inOrbit = $("frame").value === "lvlh" && flight.data !== null;
  const done = drawMap(map, {
    values, certified: certified.answer, region: region.answer, sets: setsOf(values), says: mapWords(values),
    turn: inOrbit ? flight.turn(values.omega_t_deg_s) : null,
    overlay: (frame) => [...(frame === "body" ? pins.traces(values) : []), ...flight.traces(frame, startOf(values))],
  });
  drawnFor = store.inputs;
  map.classList.remove("old");
  map.dataset.digest = certified.state === "there" ? certified.digest : "";
  map.dataset.proved = region.state === "there" ? region.digest : "";
  if (certified.answer) done.then(() => { map.dataset.drawnMs = (performance.now() - begun).toFixed(1); });
}

/** The stored sets, if they answer the question of the fields. */
function setsOf(values) {
  const { sets, note } = storedNote(stored, values);
  $("stored-note").replaceChildren(note);
  return sets;
}

function showMapState() {
  const place = $("map-state"), failed = [certified, region].find((panel) => panel.state === "failed"), values = given(store.inputs);
  const lacks = values ? mapLacks(values) : [];
  $("map-lacks").textContent = lacks.length ? `The map does not ask: ${lacks.join("; ")}. The verdict does.` : "";
  if (values === null) place.replaceChildren(el("p", { class: "empty" }, "No map: a field cannot be read."));
  else if (failed) fail(place, failed.error, () => store.hasten());
  else if (region.state === "asking") {
    // Drawn anew with every change of the map: what has been told of this question goes on.
    if (place.dataset.awaits !== region.digest || !place.hasChildNodes()) waiting(place, "Proving the exact region", { id: "safe-region", inputs: region.question });
  } else place.replaceChildren();
  place.dataset.awaits = region.state === "asking" ? region.digest : "";
}

function showVerdict(panel) {
  const place = $("verdict");
  place.dataset.digest = panel.state === "there" ? panel.digest : "";
  showFlight(flown);
  $("pin").disabled = panel.state !== "there";
  if (panel.state === "failed") return fail(place, panel.error, () => store.hasten());
  const shown = panel.answer ?? panel.old;
  if (shown) return place.replaceChildren(...verdictCards(shown, panel.answer === null));
  const { wrong, started: begins } = read(store.inputs), told = Object.entries(wrong);
  if (panel.state === "asking") return place.replaceChildren(el("p", { class: "empty", role: "status" }, "Checking …"));
  if (told.length && begins) {
    return place.replaceChildren(el("div", { class: "problem", role: "alert" }, el("h2", {}, "Not checked"),
      ...told.map(([name, text]) => el("p", {}, `${FIELDS[name].title}: ${text}.`))));
  }
  return place.replaceChildren(el("p", { class: "empty" }, "Click into the corridor, or type a start."));
}

function showFlight(panel) {
  $("flight").dataset.digest = panel.state === "there" ? panel.digest : "";
  $("flight-state").replaceChildren();
  if (verdict.state === "failed") flight.clear("No flight is shown where there is no verdict.");
  else if (panel.state === "there") {
    if (flight.data === panel.answer) return;
    const { flies, text } = flightWords(panel.answer, given(store.inputs));
    if (flies) flight.load(panel.answer, text, given(store.inputs).a_max_m_s2);
    else flight.clear(text);
  } else {
    flight.clear(panel.state === "asking" ? "Computing the flight …" : "");
    if (panel.state === "failed") fail($("flight-state"), panel.error, () => store.hasten());
  }
  redraw();
}

/** What the map knows of a point, in words: the nearest node's certified margin, and the proved polygons. */
function known(point) {
  const said = [], margin = certified.answer && nearest(point, certified.answer);
  if (margin !== null) said.push(margin > 0 ? `certified for ever, about ${figure(margin, 3)} m from every face` : "not certified");
  if (region.answer?.outer_polygon_m.length) {
    const { inner_polygon_m: inner, outer_polygon_m: outer } = region.answer;
    said.push(`${within(point, inner) ? "GO, proved" : within(point, outer) ? "undecided on the map" : "NO GO, proved"} for ${given(store.inputs).horizon_s} s`);
  }
  return said;
}

function showPointed({ state, answer: found, question }) {
  const place = $("cursor");
  if (state === "none" || !question) {
    place.textContent = "Move over the picture for the margins, click to choose a start.";
    return;
  }
  const point = [question.x_m, question.y_m], said = [`(${point.join(", ")}) m`, ...known(point)];
  if (state === "there") {
    const margins = Object.entries(found.face_margins_m).map(([face, margin]) => `${spoken(face)} ${figure(margin, 3)} m`);
    if (found.range_margin_m !== null) margins.push(`range ${figure(found.range_margin_m, 3)} m`);
    said.push(`the paper's conditions, not sound: ${found.verdict.replace("_", " ")} (${margins.join(", ")})`);
  }
  place.textContent = said.join(" · ");
}

// ---- the fields


/** Change inputs; `writing` is the field that the user is typing in, whose text stays unchanged. */
function change(inputs, writing = null) {
  begun = performance.now();
  store.set(inputs);
  const { values, wrong } = read(store.inputs);
  for (const name of Object.keys(FIELDS)) {
    const field = $(name), text = wrong[name] && field.type === "number" ? "" : store.inputs[name];
    if (name !== writing && field.value !== text) field.value = text;
    if (wrong[name]) field.setAttribute("aria-invalid", "true");
    else field.removeAttribute("aria-invalid");
    const range = document.querySelector(`input[data-for="${name}"]`);
    if (range && values[name] !== null && range !== document.activeElement) range.value = "log" in range.dataset ? Math.log10(values[name]) : values[name];
  }
  $("within").hidden = store.inputs.question !== "synchronize";
  pointed.set({ at: null });
  if (!Object.keys(wrong).length) writeAddress(`${location.pathname}${toAddress(store.inputs)}`);
  pins.mark();
}

function typed({ target }) {
  const name = target.dataset.for ?? target.name;
  if (!(name in FIELDS)) return;
  // A number field gives no text for an invalid number.
  let text = target.validity.badInput ? "no number" : target.value;
  if ("log" in target.dataset) text = String(Number((10 ** Number(text)).toPrecision(3)));
  change({ [name]: text }, target.dataset.for ? null : name);
}
for (const id of ["controls", "start"]) {
  // What fills in forms may tell of a change alone.
  for (const kind of ["input", "change"]) $(id).addEventListener(kind, typed);
  $(id).addEventListener("submit", (event) => { event.preventDefault(); store.hasten(); });
}

// ---- the map under the pointer

const turning = () => $("frame").value === "lvlh" && flight.data !== null;
let pressed = null;
map.addEventListener("mousedown", (event) => { pressed = [event.clientX, event.clientY]; }, true);
map.addEventListener("click", (event) => {
  const dragged = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4;
  if (dragged || !event.target.closest(".nsewdrag, .plot") || turning()) return;
  const point = pointAt(map, event);
  if (!point) return;
  change({ x_m: String(point[0]), y_m: String(point[1]) });
  store.hasten();
});
map.addEventListener("mousemove", (event) => {
  pointed.set({ at: turning() ? null : pointAt(map, event), values: given(store.inputs) });
});

$("frame").addEventListener("change", redraw);
$("stored").addEventListener("change", ({ target }) => change({ job: target.value, ...storedInputs(target.value) }));
map.after(saveButtons(map, "safe-start-region", el));
$("verdict").after(copies(() => { const asked = started(store.inputs); return asked && asProcess(asked.values, asked.start); }, store));
$("pin").addEventListener("click", () => {
  const { values, start, found } = verdict.answer;
  pins.add([pinned(values, start, found)]);
});
$("flight-tools").append(el("button", { type: "button", class: "plain", onclick: () => save("flight.csv", csv(rowsOf(flight.data))) }, "Flight as CSV"));
$("preset").append(...PRESETS.map(({ title }, k) => el("option", { value: String(k) }, title)));
$("preset").addEventListener("change", ({ target }) => {
  const chosen = PRESETS[target.value];
  $("preset-note").textContent = chosen ? `${chosen.from}. The other fields keep what they hold.` : "";
  if (!chosen) return;
  change(chosen.texts);
  store.hasten();
});
if (unknown.length) $("address").textContent = `The address has settings that this page does not know: ${unknown.join(", ")}.`;
for (const details of document.querySelectorAll("#controls details")) {
  details.open = [...details.querySelectorAll("input[name]")].some(({ name }) => store.inputs[name] !== FIELDS[name].first);
}
explain($("controls"));
onMove((search) => {
  change(fromAddress(search).texts);
  store.hasten();
});
change({});
store.hasten();
listStored();
