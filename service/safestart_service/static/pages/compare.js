// Compare: runs of one process side by side, by the measures that its description names.

import { differing } from "../logic/outcome.js";
import { tablesOf } from "../logic/tables.js";
import { csv } from "../logic/words.js";
import { get, root } from "../parts/api.js";
import { draw, saveButtons } from "../parts/chart.js";
import { $, el, fail, loading, save, table } from "../parts/page.js";
import { description, names, viewsOf } from "../parts/process.js";

const ids = (new URLSearchParams(location.search).get("jobs") ?? "").split(",").filter(Boolean).slice(0, 12);

const empty = (...text) => $("state").replaceChildren(el("p", { class: "empty" }, ...text, el("a", { href: `${root}/dashboard/jobs?status=successful` }, "among the jobs"), "."));

async function show() {
  if (ids.length < 2) {
    empty("Choose two or more successful runs ");
    return;
  }
  loading($("state"));
  try {
    const jobs = await Promise.all(ids.map((id) => get(`/jobs/${id}`)));
    const processes = [...new Set(jobs.map((job) => job.processID))];
    if (processes.length > 1) {
      empty(`These are runs of ${processes.join(" and ")}, which cannot be compared. Choose runs of one process `);
      return;
    }
    const spec = await description(processes[0]), [view] = viewsOf(spec, "comparison");
    if (!view) {
      empty(`Runs of ${processes[0]} have nothing to be compared by. Choose others `);
      return;
    }
    const results = await Promise.all(ids.map((id) => get(`/jobs/${id}/results`)));
    await compare(view, names(spec), results.map(({ inputs, outputs }, k) => ({ id: ids[k], inputs, rows: tablesOf(outputs)[view.table] ?? [] })));
  } catch (error) {
    fail($("state"), error, show);
  }
}

async function compare(view, { title, colour }, runs) {
  const differ = differing(runs.map((run) => run.inputs));
  const value = (run, name, path) => run.rows.find((row) => row[view.by] === name)?.[path] ?? null;
  const told = (inputs, path) => path.split(".").reduce((part, key) => part?.[key], inputs);
  const heading = (run) => [...differ.slice(0, 3).map((path) => `${path} ${told(run.inputs, path)}`), run.id.slice(0, 8)].join(", ");
  const all = [...new Set(runs.flatMap((run) => run.rows.map((row) => row[view.by])))];
  const parts = [], charts = [];
  for (const { title: name, path } of view.measures) {
    const place = el("div", { class: "chart low", role: "group", "aria-label": `${name}; the table has the figures` });
    charts.push([place, path, name]);
    const columns = [[view.by, title], ...runs.map((run) => [heading(run), (one) => value(run, one, path)])];
    parts.push(el("h2", {}, name), el("div", { class: "card" }, place), table(all, columns, name), el("div", { class: "tools" }, el("button", {
      type: "button", class: "plain", onclick: () => save(`${path}.csv`, csv([columns.map(([head]) => head), ...all.map((one) => columns.map(([, of]) => of(one)))])),
    }, "CSV")));
  }
  $("compare").replaceChildren(...parts);
  $("state").replaceChildren(el("p", { class: "lead" }, `${runs.length} runs; inputs that differ: ${differ.join(", ") || "none"}.`));
  for (const [place, path, name] of charts) {
    await draw(place, all.map((one) => ({
      type: "bar", name: title(one), x: runs.map(heading), y: runs.map((run) => value(run, one, path)), marker: { color: colour(one) }, hovertemplate: "%{y:.4g}",
    })), { barmode: "group", yaxis: { title: { text: name }, type: view.logarithmic.includes(path) ? "log" : "linear" }, legend: { orientation: "h", y: -0.25 } });
    place.after(saveButtons(place, path, el));
  }
}

await show();
