// Results of a job: scalars, tables, pictures, files; for a benchmark also confusion matrices and overlaid masks.

import { get, root } from "./api.js";
import { corridor } from "../logic/geometry.js";
import { agreement, wilson } from "../logic/statistics.js";
import { csv, figure } from "../logic/words.js";
import { COLOURS, LABELS, draw, saveButtons, theme } from "./chart.js";
import { definition, el, fail, save, table } from "./page.js";

export async function results(place, job, call) {
  const response = await call(`/jobs/${job.jobID}/results`);
  const result = await response.json();
  const parts = [el("h2", {}, "Result")];
  if (job.processID === "benchmark") parts.push(...benchmark(job, result));
  else if (job.processID === "sweep") parts.push(...sweep(result.outputs));
  else parts.push(...plain(result.outputs));
  for (const file of result.artifacts.filter((one) => one.media_type === "image/png")) {
    const image = el("img", { alt: `${job.processID}: ${file.name}` });
    parts.push(el("figure", {}, image, el("figcaption", {}, file.name)));
    call(file.href).then((answer) => answer.blob()).then((blob) => { image.src = URL.createObjectURL(blob); }, () => { image.alt += " (not loaded)"; });
  }
  parts.push(el("h2", { class: "on-screen" }, "Downloads"), el("ul", { class: "files" },
    fetched(call, `${root}/jobs/${job.jobID}/results`, `${job.processID}-${job.jobID.slice(0, 8)}.json`, "result document"),
    ...result.artifacts.map((file) => fetched(call, file.href, file.name, `${file.name} (${file.media_type}, ${Math.ceil(file.size / 1024)} KiB)`))),
  el("div", { class: "tools" }, el("button", { type: "button", class: "plain", onclick: () => print() }, "Print a report")),
  el("h2", {}, "Provenance"), el("dl", {}, definition("SHA-256 of the result", result.sha256),
    ...Object.entries(result.provenance ?? {}).filter(([, value]) => typeof value !== "object" && value !== null).map(([name, value]) => definition(name, String(value)))));
  place.replaceChildren(...parts);
  if (job.processID === "benchmark") await masks(place, job, result);
  if (job.processID === "sweep") await replays(place, job, result);
}

function fetched(call, href, name, text) {
  const anchor = el("a", { href, download: name }, text);
  anchor.addEventListener("click", async (event) => {
    event.preventDefault();
    const blob = await (await call(href.startsWith(root) && !href.startsWith("http") ? href.slice(root.length) : href)).blob();
    const url = URL.createObjectURL(blob);
    el("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
  return el("li", {}, anchor);
}

function plain(outputs) {
  const parts = [], scalars = [], arrays = [];
  for (const [name, value] of Object.entries(outputs)) {
    if (Array.isArray(value) && value.some((item) => typeof item === "string" && item.length > 40)) {
      parts.push(...value.map((item) => el("p", { class: "note" }, String(item))));
      continue;
    }
    if (Array.isArray(value) && value.length && value.every((row) => row && typeof row === "object" && !Array.isArray(row))) {
      const flat = value.slice(0, 500).map(flatten);
      const columns = [...new Set(flat.flatMap(Object.keys))].filter((key) => flat.some((row) => row[key] !== null && row[key] !== ""));
      parts.push(el("h3", {}, name), table(flat, columns.map((key) => [key, (row) => row[key]]), name),
        el("div", { class: "tools" }, el("button", { type: "button", class: "plain", onclick: () => save(`${name}.csv`, csv([columns, ...flat.map((row) => columns.map((key) => row[key]))])) }, "CSV")));
    } else if (value === null || typeof value !== "object") scalars.push([name, figure(value)]);
    else if (Array.isArray(value) && value.length <= 12 && value.every((item) => item === null || typeof item !== "object")) scalars.push([name, value.map((item) => figure(item)).join(", ")]);
    else if (!Array.isArray(value) && Object.values(value).every((item) => item === null || typeof item !== "object")) scalars.push(...Object.entries(value).map(([key, item]) => [`${name}.${key}`, figure(item)]));
    else arrays.push(name);
  }
  if (scalars.length) parts.unshift(el("dl", {}, ...scalars.map(([name, value]) => definition(name, value))));
  if (arrays.length) parts.push(el("p", { class: "note" }, `In the JSON document besides: ${arrays.join(", ")}.`));
  return parts;
}

function flatten(row) {
  const found = {};
  for (const [name, value] of Object.entries(row)) {
    if (value === null || typeof value !== "object") found[name] = value;
    else if (!Array.isArray(value) && name !== "detail") {
      for (const [key, item] of Object.entries(value)) if (item === null || typeof item !== "object") found[`${name}.${key}`] = item;
    }
  }
  return found;
}


export const COLUMNS = [
  ["engine", (r) => LABELS[r.engine] ?? r.engine], ["code", (r) => r.code], ["cells", (r) => r.cells], ["area [m²]", (r) => r.area_m2],
  ["IoU vs exact", (r) => r.iou_vs_exact], ["IoU vs HJ", (r) => r.iou_vs_hj], ["area / HJ", (r) => r.area_ratio_vs_hj],
  ["outside exact", (r) => r.violation_vs_exact], ["run [s]", (r) => r.run_s], ["compile [s]", (r) => r.compile_s], ["faster than HJ", (r) => r.speedup_vs_hj],
  ["paper: IoU vs HJ", (r) => r.published?.iou_vs_hj ?? null], ["paper: area / HJ", (r) => r.published?.area_ratio ?? null], ["paper: run [s]", (r) => r.published?.run_s ?? null],
];

function benchmark(job, { outputs, inputs }) {
  const { rows, notes } = outputs;
  const parts = [
    el("dl", {}, definition("Operating point", `${inputs.omega_t_deg_s} deg/s, ${inputs.a_max_m_s2} m/s²`), definition("Horizon", `${inputs.horizon_s} s`),
      definition("Corridor cells", String(outputs.corridor_cells)), definition("Certified region contained from", outputs.containment_horizon_s === null ? "–" : `${figure(outputs.containment_horizon_s)} s`)),
    table(rows, COLUMNS, "Engines"),
    el("div", { class: "tools" }, el("button", {
      type: "button", class: "plain", onclick: () => save(`benchmark-${job.jobID.slice(0, 8)}.csv`, csv([COLUMNS.map(([title]) => title), ...rows.map((row) => COLUMNS.map(([, of]) => of(row)))])),
    }, "CSV")),
    ...notes.map((note) => el("p", { class: "note" }, note)),
    el("h2", {}, "The certificate against each engine"), el("p", { class: "lead" }, "Rows: the certificate's word. Columns: in the engine's set or not. Intervals: Wilson, 95 %."),
    el("div", { class: "two" }, ...rows.filter((row) => row.confusion && row.engine !== "analytical").map((row) => matrix(LABELS[row.engine], row.confusion, "in the set", "not in it"))),
    el("h2", {}, "Agreement on the map"),
    el("div", { class: "inline on-screen" }, pick("first", rows, "analytical"), " against ", pick("second", rows, "exact")),
    el("div", { id: "masks", class: "chart", role: "group", "aria-label": "Cells where both, one or neither of the two sets hold" }), el("p", { class: "note", id: "agreement" }),
  ];
  return parts;
}

function pick(name, rows, wanted) {
  const there = rows.filter((row) => row.cells !== null).map((row) => row.engine);
  const chosen = there.includes(wanted) ? wanted : there[there.length - 1];
  return el("select", { id: name, "aria-label": `${name} set` }, ...there.map((engine) => el("option", { value: engine, selected: engine === chosen }, LABELS[engine] ?? engine)));
}

/** A confusion matrix as a labelled picture: what was claimed against what was so. */
function matrix(title, { tp, fp, fn, tn, precision, recall }, so, notSo) {
  const cell = (count, of, kind, text) => {
    const span = wilson(count, of);
    return el("td", { class: kind }, String(count), el("small", {}, text), span ? el("small", {}, `${(100 * span[0]).toFixed(1)}–${(100 * span[1]).toFixed(1)} %`) : null);
  };
  return el("figure", { class: "card" }, el("figcaption", {}, el("b", {}, title), ` precision ${figure(precision, 3)}, recall ${figure(recall, 3)}`),
    el("table", { class: "matrix" }, el("thead", {}, el("tr", {}, el("td"), el("th", { scope: "col" }, so), el("th", { scope: "col" }, notSo))),
      el("tbody", {}, el("tr", {}, el("th", { scope: "row" }, "certified"), cell(tp, tp + fp, "right", "true GO"), cell(fp, tp + fp, "wrong", "false GO")),
        el("tr", {}, el("th", { scope: "row" }, "not certified"), cell(fn, fn + tn, "wrong", "missed"), cell(tn, fn + tn, "right", "true NO_GO")))));
}

/** Of a sweep, also while it runs: matrices first, then the figures. */
export function sweep({ confusion, worst, ...rest }) {
  const pairs = Object.entries(confusion ?? {}).flatMap(([certificate, row]) => Object.entries(row).map(([controller, counts]) => [certificate, controller, counts]));
  return [
    el("h2", {}, "Each certificate against each controller"), el("p", { class: "lead" }, "Rows: the certificate's word. Columns: whether the flight stayed in the corridor. Intervals: Wilson, 95 %."),
    el("div", { class: "two" }, ...pairs.map(([certificate, controller, counts]) => matrix(`${certificate}, flown by ${controller}`, counts, "stayed", "left"))),
    worst && Object.keys(worst).length ? el("h2", {}, "Worst cases") : null,
    worst && Object.keys(worst).length ? el("div", { id: "replay" }, ...Object.entries(worst).flatMap(([controller, cases]) => [el("h3", {}, controller), cases.length ? table(cases, CASES, `worst cases of ${controller}`) : el("p", { class: "note" }, "None.")])) : null,
    ...plain(rest),
  ].filter(Boolean);
}

const explored = (one) => el("a", {
  href: `${root}/dashboard?${new URLSearchParams({ omega_t_deg_s: one.omega_t_deg_s, a_max_m_s2: one.a_max_m_s2, x_m: one.x_m, y_m: one.y_m })}`,
}, "explore");
const CASES = [["case", (c) => c.case], ["deg/s", (c) => c.omega_t_deg_s], ["m/s²", (c) => c.a_max_m_s2], ["x [m]", (c) => c.x_m], ["y [m]", (c) => c.y_m],
  ["margin [m]", (c) => c.margin_m], ["left after [s]", (c) => c.violated_at_s], ["certified by", (c) => Object.entries(c.certified).filter(([, yes]) => yes).map(([name]) => name).join(", ") || "none"], ["", explored]];

async function replays(place, job, { outputs, inputs, artifacts }) {
  const at = place.querySelector("#replay");
  if (!at || !artifacts.some((file) => file.name === "trajectories.npz")) return;
  const chart = el("div", { class: "chart", role: "group", "aria-label": "Flights of the worst cases in the body frame" });
  at.prepend(el("div", { class: "card" }, chart));
  try {
    const arrays = await get(`/jobs/${job.jobID}/artifacts/trajectories.npz/arrays`);
    const flights = Object.keys(arrays).filter((name) => name.endsWith("_body_m"));
    if (!flights.length) { chart.parentElement.remove(); return; }
    const top = Math.max(20, ...flights.flatMap((name) => arrays[name].map((p) => 1.1 * p[1])));
    const shape = inputs.corridor ?? { c_x: 1.5, x0_m: 2.5, r_h_m: 0.5 };
    const outline = corridor(shape, top);
    await draw(chart, [
      { name: "corridor", x: outline.x, y: outline.y, mode: "lines", fill: "toself", fillcolor: "rgba(128,128,128,0.09)", line: { color: theme().soft }, hoverinfo: "skip" },
      ...flights.map((name) => ({ name: name.slice(0, -7).replace("_", " "), x: arrays[name].map((p) => p[0]), y: arrays[name].map((p) => p[1]), text: arrays[`${name.slice(0, -7)}_time_s`].map((t) => `${t} s`), mode: "lines+markers", marker: { size: 4 } })),
    ], { xaxis: { title: { text: "x body [m]" }, constrain: "domain" }, yaxis: { title: { text: "y body [m]" }, scaleanchor: "x", constrain: "domain" } });
    chart.after(saveButtons(chart, "worst-cases", el));
  } catch (error) {
    fail(chart, error);
  }
}

async function masks(place, job, result) {
  const at = place.querySelector("#masks");
  if (!result.artifacts.some((file) => file.name === "maps.npz")) return;
  try {
    const arrays = await get(`/jobs/${job.jobID}/artifacts/maps.npz/arrays`);
    const show = () => {
      const [one, two] = ["first", "second"].map((name) => place.querySelector(`#${name}`).value);
      const { z, counts } = agreement(arrays.inside, arrays[`${one}_mask`], arrays[`${two}_mask`]);
      const { line } = theme();
      const steps = [line, "#999999", COLOURS.analytical, COLOURS.hamilton_jacobi, COLOURS.monte_carlo];
      const scale = steps.flatMap((colour, k) => [[k / 5, colour], [(k + 1) / 5, colour]]);
      const words = ["outside the corridor", "neither", "both", `only ${LABELS[one] ?? one}`, `only ${LABELS[two] ?? two}`];
      draw(at, [{
        type: "heatmap", x: arrays.x_m, y: arrays.y_m, z, zmin: -0.5, zmax: 4.5, colorscale: scale, text: z.map((row) => row.map((k) => words[k])), hovertemplate: "(%{x:.1f}, %{y:.1f}) m: %{text}<extra></extra>",
        colorbar: { tickvals: [1, 2, 3, 4], ticktext: words.slice(1).map((word) => word.replace(/ \(.*\)/, "")) },
      }], { xaxis: { title: { text: "x body [m]" }, constrain: "domain" }, yaxis: { title: { text: "y body [m]" }, scaleanchor: "x", constrain: "domain" } });
      place.querySelector("#agreement").textContent = `Both ${counts[2]}, ${words[3]} ${counts[3]}, ${words[4]} ${counts[4]}, neither ${counts[1]} cells.`;
    };
    for (const name of ["first", "second"]) place.querySelector(`#${name}`).addEventListener("change", show);
    show();
    at.after(saveButtons(at, "agreement", el));
  } catch (error) {
    fail(at, error);
  }
}
