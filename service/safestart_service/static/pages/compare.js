// Compare: successful benchmarks side by side, engine by engine.

import { get } from "../parts/api.js";
import { COLOURS, LABELS, draw, saveButtons } from "../parts/chart.js";
import { csv } from "../logic/words.js";
import { $, el, fail, loading, save, table } from "../parts/page.js";
import { root } from "../parts/api.js";

const ids = (new URLSearchParams(location.search).get("jobs") ?? "").split(",").filter(Boolean).slice(0, 12);

const MEASURES = [
  ["area_m2", "area [m²]"], ["iou_vs_exact", "IoU vs exact"], ["iou_vs_hj", "IoU vs HJ"], ["violation_vs_exact", "share outside exact"], ["run_s", "run [s]"],
];

async function show() {
  if (ids.length < 2) {
    $("state").replaceChildren(el("p", { class: "empty" }, "Choose two or more successful benchmarks ", el("a", { href: `${root}/dashboard/jobs?process=benchmark&status=successful` }, "among the jobs"), "."));
    return;
  }
  loading($("state"));
  try {
    const runs = await Promise.all(ids.map(async (id) => ({ id, ...(await get(`/jobs/${id}/results`)) })));
    const title = (run) => `${run.inputs.omega_t_deg_s} deg/s, ${run.inputs.a_max_m_s2} m/s², ${run.inputs.horizon_s} s (${run.id.slice(0, 8)})`;
    const engines = [...new Set(runs.flatMap((run) => run.outputs.rows.map((row) => row.engine)))];
    const value = (run, engine, measure) => run.outputs.rows.find((row) => row.engine === engine)?.[measure] ?? null;
    const parts = [], charts = [];
    for (const [measure, name] of MEASURES) {
      const place = el("div", { class: "chart low", role: "group", "aria-label": `${name}; the table has the figures` });
      charts.push([place, measure, name]);
      const columns = [["engine", (engine) => LABELS[engine] ?? engine], ...runs.map((run) => [title(run), (engine) => value(run, engine, measure)])];
      parts.push(el("h2", {}, name), el("div", { class: "card" }, place), table(engines, columns, name), el("div", { class: "tools" }, el("button", {
        type: "button", class: "plain", onclick: () => save(`${measure}.csv`, csv([columns.map(([head]) => head), ...engines.map((engine) => columns.map(([, of]) => of(engine)))])),
      }, "CSV")));
    }
    $("compare").replaceChildren(...parts);
    $("state").replaceChildren(el("p", { class: "lead" }, `${runs.length} runs; inputs that differ: ${differing(runs).join(", ") || "none"}.`));
    for (const [place, measure, name] of charts) {
      await draw(place, engines.map((engine) => ({
        type: "bar", name: LABELS[engine] ?? engine, x: runs.map(title), y: runs.map((run) => value(run, engine, measure)), marker: { color: COLOURS[engine] }, hovertemplate: "%{y:.4g}",
      })), { barmode: "group", yaxis: { title: { text: name }, type: measure === "run_s" ? "log" : "linear" }, legend: { orientation: "h", y: -0.25 } });
      place.after(saveButtons(place, measure, el));
    }
  } catch (error) {
    fail($("state"), error, show);
  }
}

function differing(runs) {
  const flat = (value, path) => (value && typeof value === "object" && !Array.isArray(value)
    ? Object.entries(value).flatMap(([key, inner]) => flat(inner, path ? `${path}.${key}` : key)) : [[path, JSON.stringify(value)]]);
  const all = runs.map((run) => new Map(flat(run.inputs, "")));
  const names = [...new Set(all.flatMap((one) => [...one.keys()]))];
  return names.filter((name) => new Set(all.map((one) => one.get(name))).size > 1);
}

await show();
