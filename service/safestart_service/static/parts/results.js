// The result of a job: first its verdicts, then pictures, outputs without a view, downloads, provenance.

import { keyInputs } from "../logic/inputs.js";
import { outcome } from "../logic/outcome.js";
import { columnsOf, tablesOf } from "../logic/tables.js";
import { inputTitle } from "../logic/titles.js";
import { figure, spoken } from "../logic/words.js";
import { explained } from "./glossary.js";
import { badge, definition, download, el, time } from "./page.js";
import { names } from "./process.js";
import { listed, shown } from "./views.js";

/** The data for the views: outputs with their tables, and the names in them. */
export const known = (spec, outputs, inputs, { artifacts = [], job = null } = {}) => ({
  spec, outputs, inputs, artifacts, job, names: names(spec), tables: tablesOf(outputs, spec["safestart:tables"]),
});

/** The badge of a result's verdict; null if its process gives none. */
export function verdictBadge({ spec, tables }) {
  const found = outcome(spec["safestart:views"], tables);
  if (found === null) return null;
  const many = found.of > 1 ? ` (${found.count} of ${found.of})` : "", claimed = found.basis === null ? "" : `, ${found.basis.replace("_", " ")}, no proof`;
  return badge("verdict", found.word.replace("_", " ") + many + claimed, found.sense);
}

/** What the first screen of a result holds: the head of its views and its inputs beside the first of its pictures. */
export function firstScreen(result, head, picture) {
  const inputs = keyInputs(result.spec, result.inputs), short = !head.some((node) => node.matches(".findings, .scroll, .two"));
  const told = el("section", { class: "key-inputs", "aria-label": "Key inputs" }, el("h2", {}, "Asked with"), el("dl", {}, ...inputs.map(([path, value]) => definition(inputTitle(path), value, explained(inputTitle(path).replace(/ \[[^\]]*\]$/, ""))))));
  return el("div", { class: short ? "first brief" : "first" }, el("div", { class: "said" }, ...head, ...(short ? [told] : [])), el("div", { class: "beside" }, ...(picture ? [picture] : []), ...(short ? [] : [told])));
}

/** Show the result of a job. */
export async function results(place, job, spec, call) {
  const document = await (await call(`/jobs/${job.jobID}/results`)).json();
  const result = known(spec, document.outputs, document.inputs, { artifacts: document.artifacts, job: job.jobID });
  const { head, pictures, parts: views, draws } = shown(result), [first, ...more] = [...pictures, ...images(call, job.processID, document.artifacts)];
  const notes = (document.provenance?.notes ?? []).map((note) => el("p", { class: "note" }, note));
  const parts = [firstScreen(result, head, first), ...notes, ...(more.length ? [el("div", { class: "two pictures" }, ...more)] : []), ...views, ...rest(result)];
  parts.push(el("h2", { class: "on-screen" }, "Downloads"), el("ul", { class: "files" },
    el("li", {}, download(call, `/jobs/${job.jobID}/results`, `${job.processID}-${job.jobID.slice(0, 8)}.json`, "result document")),
    ...document.artifacts.map((file) => el("li", {}, download(call, file.href, file.name, `${file.name} (${file.media_type}, ${Math.ceil(file.size / 1024)} KiB)`))),
    ...Object.keys(result.tables).filter(Boolean).map((name) => el("li", {}, download(call, `/jobs/${job.jobID}/results?${new URLSearchParams({ format: "csv", table: name })}`, `${name}.csv`, `table ${name} (CSV)`)))),
  el("div", { class: "tools" }, el("button", { type: "button", class: "plain", onclick: () => print() }, "Print a report")),
  el("h2", {}, "Provenance"), el("dl", {}, definition("SHA-256 of the result", document.sha256),
    ...Object.entries(document.provenance ?? {}).filter(([, value]) => typeof value !== "object" && value !== null).map(([name, value]) => definition(name.replaceAll("_", " "), ["started", "finished"].includes(name) ? time(value) : String(value)))));
  place.replaceChildren(...parts);
  for (const drawn of draws) await drawn();
  return result;
}

/** A picture this much wider than tall takes the width of the first screen. */
const PANORAMA = 2.2;

function spread({ target: { naturalWidth: wide, naturalHeight: high } }) {
  this.closest(".first")?.classList.toggle("panorama", wide > PANORAMA * high);
}

function images(call, process, artifacts) {
  return artifacts.filter((file) => file.media_type === "image/png").map((file) => {
    const image = el("img", { alt: `${process}: ${file.name}`, onload: spread }), whole = el("a", { target: "_blank", title: "in full size" }, image);
    call(file.href).then((answer) => answer.blob()).then((blob) => { whole.href = image.src = URL.createObjectURL(blob); }, () => { image.alt += " (not loaded)"; });
    return el("figure", {}, whole, el("figcaption", {}, file.name));
  });
}

/** Parts of outputs that no view shows: tables, sentences, figures; large arrays by name. */
export function rest({ spec, outputs, tables }) {
  const views = spec["safestart:views"], seen = new Set(views.flatMap((view) => [view.table, view.path, ...(view.columns ?? []).map(({ path }) => path)]).filter(Boolean).map((path) => path.split(".")[0]));
  const parts = [], figures = [], arrays = [];
  const declared = new Set(spec["safestart:tables"].flatMap(({ columns, axes }) => [...columns, ...axes]));
  for (const [name, value] of Object.entries(outputs)) {
    if (seen.has(name) || declared.has(name)) continue;
    if (Array.isArray(value) && value.length && value.every((item) => typeof item === "string" && item.includes(" "))) parts.push(...value.map((item) => el("p", { class: "note" }, item)));
    else if (value === null || typeof value !== "object" || name in tables[""][0]) figures.push([name, tables[""][0][name]]);
    else if (tables[name]) parts.push(el("h3", {}, name), ...listed(tables[name], columnsOf(tables[name]).map((key) => [key, (row) => row[key]]), name, name));
    else if (Object.keys(tables[""][0]).some((key) => key.startsWith(`${name}.`))) figures.push(...Object.entries(tables[""][0]).filter(([key]) => key.startsWith(`${name}.`)));
    else if (!Array.isArray(value) || value.length) arrays.push(name);
  }
  const told = figures.filter(([, value]) => value !== null && value !== "");
  if (told.length) parts.push(el("dl", {}, ...told.map(([name, value]) => definition(spoken(name).replace(".", ": "), figure(value)))));
  if (arrays.length) parts.push(el("p", { class: "note" }, `In the result document besides: ${arrays.join(", ")}.`));
  return parts.length ? [el("h2", {}, "Also in the result"), ...parts] : [];
}
