// Compare: runs of one process side by side, their inputs, verdicts and figures, and the measures that its description names.

import { differing, outcome } from "../logic/outcome.js";
import { tablesOf } from "../logic/tables.js";
import { inputTitle, inputWords } from "../logic/titles.js";
import { barAxis, csv } from "../logic/words.js";
import { get, root } from "../parts/api.js";
import { draw, legendRows, saveButtons } from "../parts/chart.js";
import { $, el, fail, loading, save, table } from "../parts/page.js";
import { description, names, viewsOf } from "../parts/process.js";
import { listed } from "../parts/views.js";

const ids = (new URLSearchParams(location.search).get("jobs") ?? "").split(",").filter(Boolean).slice(0, 12);

const LONG = 60, BARS_PX = 240;

const empty = (...text) => $("state").replaceChildren(el("p", { class: "empty" }, ...text, el("a", { href: `${root}/dashboard/jobs?status=successful` }, "among the jobs"), "."));

async function show() {
  if (ids.length < 2) {
    empty("Choose two or more successful runs of one process ");
    return;
  }
  loading($("state"));
  try {
    const jobs = await Promise.all(ids.map((id) => get(`/jobs/${id}`)));
    const processes = [...new Set(jobs.map((job) => job.processID))], open = jobs.filter((job) => job.status !== "successful");
    if (processes.length > 1) {
      empty(`These are runs of ${processes.join(" and ")}, which cannot be compared. Choose runs of one process `);
      return;
    }
    if (open.length) {
      empty(`Without a result: ${open.map((job) => `${job.jobID.slice(0, 8)} (${job.status})`).join(", ")}. Choose successful runs `);
      return;
    }
    const spec = await description(processes[0]), [view] = viewsOf(spec, "comparison");
    const results = await Promise.all(ids.map((id) => get(`/jobs/${id}/results`)));
    const runs = results.map(({ inputs, outputs }, k) => ({ id: ids[k], job: jobs[k], inputs, tables: tablesOf(outputs, spec["safestart:tables"]) }));
    document.title = `Compare ${processes[0]} · safestart`;
    await compare(spec, view, names(spec), runs);
  } catch (error) {
    fail($("state"), error, show);
  }
}

/** What every process can be compared by: inputs that differ, the verdict, the figures among its outputs. */
function figures(spec, runs, differ, heading) {
  const rows = [
    ...differ.map((path) => [inputTitle(path), (run) => told(run.inputs, path)]),
    ["verdict", (run) => { const found = outcome(spec["safestart:views"], run.tables); return found && `${found.word.replace("_", " ")}${found.of > 1 ? ` (${found.count} of ${found.of})` : ""}`; }],
    ...viewsOf(spec, "facts").flatMap(({ columns }) => columns.map(({ title, path }) => [title, (run) => run.tables[""][0][path]])),
  ];
  const known = new Set(viewsOf(spec, "facts").flatMap(({ columns }) => columns.map(({ path }) => path)));
  const others = [...new Set(runs.flatMap((run) => Object.keys(run.tables[""][0])))].filter((path) => !known.has(path));
  rows.push(...others.map((path) => [path, (run) => run.tables[""][0][path]]), ["run [s]", (run) => (Date.parse(run.job.finished) - Date.parse(run.job.started)) / 1000]);
  // A sentence that all runs have tells nothing about their differences.
  const same = (of) => typeof of(runs[0]) === "string" && of(runs[0]).length > LONG && runs.every((run) => of(run) === of(runs[0]));
  const there = rows.filter(([, of]) => runs.some((run) => ![null, undefined, ""].includes(of(run))) && !same(of));
  const columns = [["figure", ([name]) => name], ...runs.map((run) => [heading(run), ([, of]) => of(run)])];
  return [el("h2", {}, "Inputs that differ, outcome and figures"), ...listed(there, columns, "Figures of each run", "comparison")];
}

function told(inputs, path) {
  const found = path.split(".").reduce((part, key) => part?.[key], inputs);
  return Array.isArray(found) ? JSON.stringify(found) : found;
}

async function compare(spec, view, { title, colour }, runs) {
  const differ = differing(runs.map((run) => run.inputs));
  const rowsOf = (run) => run.tables[view?.table] ?? [];
  const value = (run, name, path) => rowsOf(run).find((row) => row[view.by] === name)?.[path] ?? null;
  const words = (run) => [run.job.name, ...differ.slice(0, run.job.name ? 1 : 3).map((path) => inputWords(path, told(run.inputs, path))), run.id.slice(0, 8)].filter(Boolean);
  const heading = (run) => words(run).join(", ");
  const all = view ? [...new Set(runs.flatMap((run) => rowsOf(run).map((row) => row[view.by])))] : [];
  const parts = figures(spec, runs, differ, heading), charts = [];
  const measures = (view?.measures ?? []).filter(({ path }) => runs.some((run) => all.some((one) => value(run, one, path) !== null)));
  for (const { title: name, path } of measures) {
    const place = el("div", { class: "chart low", role: "group", "aria-label": `${name}; the table has the figures` });
    charts.push([place, path, name]);
    const columns = [[view.by, title], ...runs.map((run) => [heading(run), (one) => value(run, one, path)])];
    parts.push(el("h2", {}, name), el("div", { class: "card" }, place), table(all, columns, name), el("div", { class: "tools" }, el("button", {
      type: "button", class: "plain", onclick: () => save(`${path}.csv`, csv([columns.map(([head]) => head), ...all.map((one) => columns.map(([, of]) => of(one)))])),
    }, "CSV")));
  }
  $("compare").replaceChildren(...parts);
  $("state").replaceChildren(el("p", { class: "lead" }, `${runs.length} runs; inputs that differ: ${differ.map(inputTitle).join(", ") || "none"}.`));
  for (const [place, path, name] of charts) {
    const traces = all.map((one) => ({
      type: "bar", name: title(one), x: runs.map((run) => words(run).join("<br>")), y: runs.map((run) => value(run, one, path)), marker: { color: colour(one) }, hovertemplate: "%{y:.4g}",
    }));
    // Bars of one height, however many rows the legend takes.
    place.style.height = `${BARS_PX + 20 * legendRows(place, traces)}px`;
    await draw(place, traces, { barmode: "group", yaxis: { title: { text: name }, ...(view.logarithmic.includes(path) ? barAxis(runs.flatMap((run) => all.map((one) => value(run, one, path)))) : {}) } });
    place.after(saveButtons(place, path, el));
  }
}

await show();
