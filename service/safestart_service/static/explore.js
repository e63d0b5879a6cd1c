// Explore: the operating point, the regions, one start, its flight. The address holds all of it.

/* global Plotly */

import { call, execute, get, post } from "./api.js";
import { COLOURS, LABELS, arc, corridor, draw, saveButtons, theme, turned } from "./chart.js";
import { $, el, fail, figure, settle } from "./page.js";
import { Flight } from "./flight.js";

const DEFAULTS = {
  omega_t_deg_s: 3, a_max_m_s2: 0.1, horizon_s: 60, y_max_m: 150, rest: "lvlh",
  mean_motion_rad_s: 0.0011, c_x: 1.5, x0_m: 2.5, r_h_m: 0.5, question: "stay", within_s: 200,
  omega_t_half_width_deg_s: 0, a_max_half_width_m_s2: 0, position_half_width_m: 0, velocity_half_width_m_s: 0, disturbance_m_s2: 0,
};
const WORDS = { rest: ["lvlh", "body"], question: ["stay", "synchronize"] };
const WIDTHS = Object.keys(DEFAULTS).filter((name) => name.includes("half_width") || name === "disturbance_m_s2");
const state = { ...DEFAULTS };
let start = null, certified = null, region = null, stored = null, pending = null;
const map = $("map"), flight = new Flight(redraw);

// ---- the address

function read() {
  const asked = new URLSearchParams(location.search);
  for (const name of Object.keys(DEFAULTS)) {
    if (!asked.has(name)) continue;
    const value = WORDS[name] ? asked.get(name) : Number(asked.get(name));
    if (WORDS[name] ? WORDS[name].includes(value) : Number.isFinite(value)) state[name] = value;
  }
  if (asked.has("x_m") && asked.has("y_m")) start = [Number(asked.get("x_m")), Number(asked.get("y_m"))];
  if (start && !start.every(Number.isFinite)) start = null;
}

const write = settle(() => {
  const told = new URLSearchParams();
  for (const [name, value] of Object.entries(state)) if (value !== DEFAULTS[name]) told.set(name, value);
  if (start) { told.set("x_m", start[0]); told.set("y_m", start[1]); }
  history.replaceState(null, "", told.size ? `?${told}` : location.pathname);
}, 200);

const shape = () => ({ c_x: state.c_x, x0_m: state.x0_m, r_h_m: state.r_h_m });
const scenario = () => ({
  omega_t_deg_s: state.omega_t_deg_s, a_max_m_s2: state.a_max_m_s2, mean_motion_rad_s: state.mean_motion_rad_s, corridor: shape(),
});
const flat = () => ({ ...scenario(), corridor: undefined, ...shape(), rest: state.rest });
const query = (more) => new URLSearchParams(
  Object.entries({ ...flat(), ...more }).filter(([, value]) => value !== undefined));

/** What only the exact answer is asked. */
function exactly() {
  const more = { horizon_s: state.horizon_s, question: state.question };
  if (state.question === "synchronize") more.within_s = state.within_s;
  for (const name of WIDTHS) if (state[name] > 0) more[name] = state[name];
  return more;
}

// ---- the controls

function show() {
  for (const [name, value] of Object.entries(state)) {
    if ($(name) !== document.activeElement) $(name).value = value;
    const range = document.querySelector(`input[data-for="${name}"]`);
    if (range) range.value = "log" in range.dataset ? Math.log10(value) : value;
  }
  $("within").hidden = state.question !== "synchronize";
}

$("controls").addEventListener("input", (event) => {
  const field = event.target;
  if (field.id === "stored") return;
  const name = field.dataset.for ?? field.name;
  if (WORDS[name]) state[name] = field.value;
  else {
    let value = Number(field.value);
    if ("log" in field.dataset) value = Number((10 ** value).toPrecision(3));
    if (field.value === "" || !Number.isFinite(value)) return;
    state[name] = name === "horizon_s" ? Math.max(2, 2 * Math.round(value / 2)) : value;
  }
  if (field.dataset.for) $(name).value = state[name];
  else show();
  refresh();
});
$("controls").addEventListener("submit", (event) => event.preventDefault());

// ---- the regions

async function refresh() {
  const begun = performance.now();
  write();
  pending?.abort();
  pending = new AbortController();
  const { signal } = pending;
  region = null;
  flight.clear();
  try {
    certified = await post("/certificates", {
      ...scenario(), rest: state.rest, grid: { nx: 81, ny: 81, y_max_m: state.y_max_m },
    }, { signal });
    $("map-state").replaceChildren();
    await redraw();
    map.dataset.drawnMs = (performance.now() - begun).toFixed(1);
    later(signal);
  } catch (error) {
    fail($("map-state"), error, refresh);
  }
}

const later = settle(async (signal) => {
  if (signal.aborted) return;
  if (start) ask();
  if (state.rest !== "lvlh") return;
  $("map-state").replaceChildren(el("p", { class: "note", role: "status" }, "Proving the exact region …"));
  try {
    const inputs = { ...scenario(), horizon_s: state.horizon_s, y_max_m: state.y_max_m };
    region = await execute("safe-region", inputs, { signal });
    $("map-state").replaceChildren();
    await redraw();
    map.dataset.proved = "yes";
  } catch (error) {
    fail($("map-state"), error, refresh);
  }
}, 180);

function closed(polygon) {
  const ring = [...polygon, polygon[0]];
  return { x: ring.map((p) => p[0]), y: ring.map((p) => p[1]) };
}

function body() {
  const { ink, soft } = theme();
  const traces = [];
  const line = (name, points, colour, more = {}) => traces.push({
    name, ...points, mode: "lines", line: { color: colour, width: 2, dash: more.dash }, hoverinfo: "skip", ...more,
  });
  line("corridor", corridor(shape(), state.y_max_m), soft, { fill: "toself", fillcolor: "rgba(128,128,128,0.09)" });
  if (region?.inner_polygon_m.length) {
    line("exact: proved GO", closed(region.inner_polygon_m), COLOURS.exact, { fill: "toself", fillcolor: "rgba(59,111,212,0.16)" });
  }
  if (region?.outer_polygon_m.length) {
    line("outside: proved NO_GO", closed(region.outer_polygon_m), COLOURS.exact, { dash: "dot" });
  }
  if (certified) {
    traces.push({
      name: "closed form: certified", type: "contour", x: certified.x_m, y: certified.y_m, z: certified.margin_m,
      contours: { type: "constraint", operation: "<", value: 0 }, fillcolor: "rgba(0,158,115,0.30)",
      line: { color: COLOURS.analytical, width: 2 }, showscale: false, hoverinfo: "skip", showlegend: true,
    });
    if (certified.r_sync_m) line("synchronization radius", arc(certified.r_sync_m, shape(), state.y_max_m), COLOURS.warn, { dash: "dash" });
  }
  for (const set of stored?.sets ?? []) {
    traces.push({
      name: `stored: ${LABELS[set.engine] ?? set.engine}`, type: "contour", x: stored.x, y: stored.y, z: set.mask,
      contours: { type: "constraint", operation: "=", value: 0.5 }, line: { color: COLOURS[set.engine], width: 2, dash: "dashdot" },
      showscale: false, hoverinfo: "skip", showlegend: true,
    });
  }
  traces.push({ name: "target", x: [0], y: [0], mode: "markers", marker: { symbol: "square", size: 11, color: ink }, hoverinfo: "name", showlegend: false });
  return traces;
}

function orbit(turn) {
  const { ink, soft } = theme();
  const outline = corridor(shape(), state.y_max_m);
  const traces = [{
    name: "corridor", ...turned(outline.x, outline.y, turn), mode: "lines", fill: "toself", fillcolor: "rgba(128,128,128,0.09)", line: { color: soft }, hoverinfo: "skip",
  }];
  if (region?.inner_polygon_m.length) {
    traces.push({
      name: "exact region at t = 0", ...closed(region.inner_polygon_m), mode: "lines", line: { color: COLOURS.exact, dash: "dot" }, hoverinfo: "skip",
    });
  }
  traces.push({ name: "target", x: [0], y: [0], mode: "markers", marker: { symbol: "square", size: 11, color: ink }, hoverinfo: "name", showlegend: false });
  return traces;
}

function redraw() {
  const inOrbit = $("frame").value === "lvlh" && flight.data;
  const reach = corridor(shape(), state.y_max_m).half * 1.03;
  const far = Math.max(reach, state.y_max_m * 1.03);
  const traces = inOrbit ? orbit(flight.turn(state.omega_t_deg_s)) : body();
  traces.push(...flight.traces($("frame").value, start));
  // As tall as equal axes need, so that no room is left empty.
  map.style.height = `${Math.min(0.8 * innerHeight, (inOrbit ? 1 : 0.36) * map.clientWidth * (inOrbit ? 1 : Math.min(2, (1.5 * state.y_max_m) / reach)) + 190)}px`;
  const range = inOrbit ? [-far, far] : [-0.06 * state.y_max_m, 1.03 * state.y_max_m];
  return draw(map, traces, {
    uirevision: `${inOrbit}/${state.y_max_m}/${state.c_x}`, showlegend: true,
    xaxis: { title: { text: inOrbit ? "x LVLH, radial [m]" : "x body [m]" }, range: inOrbit ? [-far, far] : [-reach, reach], constrain: "domain" },
    yaxis: { title: { text: inOrbit ? "y LVLH, along-track [m]" : "y body [m]" }, range, scaleanchor: "x", constrain: "domain" },
  });
}

// ---- one start

function at(event) {
  const { xaxis, yaxis } = map._fullLayout ?? {};
  if (!xaxis) return null;
  const box = map.getBoundingClientRect();
  const x = xaxis.p2d(event.clientX - box.left - xaxis._offset), y = yaxis.p2d(event.clientY - box.top - yaxis._offset);
  const within = (value, [low, high]) => value >= Math.min(low, high) && value <= Math.max(low, high);
  return within(x, xaxis.range) && within(y, yaxis.range) ? [Number(x.toFixed(2)), Number(y.toFixed(2))] : null;
}

let pressed = null;
map.addEventListener("mousedown", (event) => { pressed = [event.clientX, event.clientY]; }, true);
map.addEventListener("click", (event) => {
  const dragged = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4;
  if (dragged || !event.target.closest(".nsewdrag, .plot") || ($("frame").value === "lvlh" && flight.data)) return;
  const point = at(event);
  if (point) choose(point);
});
map.addEventListener("mousemove", (event) => {
  const point = at(event);
  if (point && !($("frame").value === "lvlh" && flight.data)) hover(point);
});

const hover = settle(async ([x, y]) => {
  try {
    const found = await get(`/go-no-go?${query({ x_m: x, y_m: y })}`);
    const margins = Object.entries(found.face_margins_m).map(([face, margin]) => `${face} ${figure(margin, 3)} m`);
    $("cursor").textContent = `(${x}, ${y}) m · closed form ${found.verdict} · after erosion: ${margins.join(", ")}`
      + (found.range_margin_m === null ? "" : ` · range ${figure(found.range_margin_m, 3)} m`);
  } catch {
    $("cursor").textContent = "";
  }
}, 60);

$("start").addEventListener("submit", (event) => {
  event.preventDefault();
  choose([Number($("x_m").value), Number($("y_m").value)]);
});

function choose(point) {
  start = point;
  flight.clear();
  write();
  redraw();
  ask();
}

async function ask() {
  [$("x_m").value, $("y_m").value] = start;
  const place = $("verdict"), [x_m, y_m] = start;
  try {
    const asked = { x_m, y_m };
    const [quick, exact] = await Promise.all([
      get(`/go-no-go?${query(asked)}`),
      get(`/go-no-go?${query({ ...asked, method: "exact", ...exactly() })}`),
    ]);
    if (start[0] !== x_m || start[1] !== y_m) return;
    const card = (title, found, text, extra) => el("div", { class: `answer ${found.verdict}` },
      el("h2", {}, el("span", { class: "word" }, found.verdict.replace("_", " ")), ` ${title}`), el("p", {}, text), extra);
    const proof = exact.proof_url && el("p", {}, el("a", { href: exact.proof_url, download: "proof.json" }, "Download the proof"), " (checked by ", el("code", {}, "safestart verify"), ")");
    place.replaceChildren(
      card(WIDTHS.some((name) => state[name] > 0) ? "proved for all of them" : "proved", exact, `${sentence(exact.reason)}`, proof),
      card("by the closed form", quick, `${sentence(quick.reason)} Binding: ${quick.binding}.`,
        el("ul", { class: "margins" }, ...Object.entries(quick.face_margins_m).map(([face, margin]) =>
          el("li", { class: margin > 0 ? "in" : "out" }, `${face} `, el("b", {}, `${figure(margin, 3)} m`))),
        quick.range_margin_m === null ? null : el("li", { class: quick.range_margin_m > 0 ? "in" : "out" }, "range ", el("b", {}, `${figure(quick.range_margin_m, 3)} m`)))));
    const inputs = { ...scenario(), rest: state.rest, question: state.question, horizon_s: state.horizon_s, within_s: state.within_s, start: asked };
    flight.load(await execute("flight", inputs));
    redraw();
  } catch (error) {
    fail(place, error, ask);
  }
}

const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}${text.endsWith(".") ? "" : "."}`;

// ---- stored benchmarks

async function listStored() {
  try {
    const { jobs } = await get("/jobs?processID=benchmark&status=successful&limit=20");
    const details = await Promise.all(jobs.map((job) => get(`/jobs/${job.jobID}`)));
    $("stored").append(...details.map((job) => el("option", { value: job.jobID },
      `${job.inputs.omega_t_deg_s} deg/s, ${job.inputs.a_max_m_s2} m/s², ${job.inputs.horizon_s} s (${job.jobID.slice(0, 8)})`)));
    $("stored-note").textContent = details.length ? "" : "None yet: submit a benchmark, and its sets appear here.";
  } catch (error) {
    fail($("stored-note"), error, listStored);
  }
}

$("stored").addEventListener("change", async (event) => {
  const job = event.target.value;
  stored = null;
  $("stored-note").textContent = "";
  if (job) {
    try {
      const { inputs } = await get(`/jobs/${job}`);
      const arrays = await get(`/jobs/${job}/artifacts/maps.npz/arrays`);
      const sets = Object.keys(arrays).filter((name) => name.endsWith("_mask"))
        .map((name) => ({ engine: name.slice(0, -5), mask: arrays[name].map((row) => row.map(Number)) }))
        .filter(({ engine }) => engine !== "analytical");
      stored = { x: arrays.x_m, y: arrays.y_m, sets };
      Object.assign(state, {
        omega_t_deg_s: inputs.omega_t_deg_s, a_max_m_s2: inputs.a_max_m_s2, rest: inputs.rest, y_max_m: inputs.grid.y_max_m,
        mean_motion_rad_s: inputs.mean_motion_rad_s, c_x: inputs.corridor.c_x, x0_m: inputs.corridor.x0_m, r_h_m: inputs.corridor.r_h_m,
      });
      $("stored-note").textContent = `Sets of reaching the corridor after ${inputs.horizon_s} s; the controls follow the benchmark.`;
      show();
    } catch (error) {
      fail($("stored-note"), error);
    }
  }
  refresh();
});

$("frame").addEventListener("change", redraw);
map.after(saveButtons(map, "safe-start-region", el));
read();
show();
await refresh();
listStored();
