// The kinds of views that a process's description names for its outputs. Each makes elements; some are drawn once these are on the page.

import { layersOf } from "../logic/layers.js";
import { exploreAddress, findings } from "../logic/outcome.js";
import { wilson } from "../logic/statistics.js";
import { each } from "../logic/tables.js";
import { csv, figure } from "../logic/words.js";
import { root } from "./api.js";
import { drawFlights, drawOverlay } from "./arrays.js";
import { explained } from "./glossary.js";
import { definition, el, save, table } from "./page.js";
import { drawPicture } from "./picture.js";
import { drawScene, sceneParts } from "./scene.js";

/** Rows shown at most; the download has all of them. */
const MOST_ROWS = 500;
const SHORT = 12;

/**
 * Elements of a result by its views: `{ head, pictures, parts, draws }`; `head` belongs on the first screen, beside the
 * first picture. `result` is `{ spec, names, outputs, tables, inputs, artifacts, job }`; `draws` are to be called once
 * the elements are on the page.
 */
export function shown(result) {
  const head = [], pictures = [], parts = [], draws = [], views = result.spec["safestart:views"], long = views.findIndex((view) => isLong(view, result));
  // A long table that comes first is the finding: its beginning belongs on the first screen.
  const from = long === 0 && views[0].kind === "rows" ? 1 : long;
  views.forEach((view, k) => KINDS[view.kind]?.(view, result, view.kind === "picture" ? pictures : from < 0 || k < from ? head : parts, draws));
  return { head, pictures, parts, draws };
}

/** Whether a view is large: the pictures precede the first large one. */
const isLong = ({ kind, table: name }, { tables }) => ["overlay", "flights", "scene"].includes(kind) || (kind === "rows" && (tables[name] ?? []).length > SHORT);

const KINDS = {
  findings(view, { tables, names }, parts) {
    const all = findings(view, tables);
    if (!all.length) return;
    const word = (found) => el("b", { class: `word ${found.shown}` }, found.word.replace("_", " "));
    const columns = used(view.columns, all.map(({ row }) => row), names).map(([title, of]) => [title, (found) => of(found.row)]);
    // What only some findings have, such as a counter-example, stands in one cell of theirs.
    const some = columns.filter(([, of]) => all.some((found) => missing(of(found)))), every = columns.filter((column) => !some.includes(column));
    const besides = (found) => some.filter(([, of]) => !missing(of(found))).map(([title, of]) => `${title} ${figure(of(found))}`).join(" · ");
    const last = some.length > 1 ? [["besides", besides]] : some;
    parts.push(el("h2", {}, view.title), el("div", { class: "findings" }, table(all, [["verdict", word], ...every, ...last], view.title)));
  },

  facts({ columns }, { tables, names }, parts) {
    const [row] = tables[""], said = used(columns, [row], names);
    if (said.length) parts.push(el("dl", { class: "facts" }, ...said.map(([title, of]) => definition(title, figure(of(row)), explained(title)))));
  },

  rows(view, { tables, names, inputs }, parts) {
    const rows = tables[view.table] ?? [];
    if (!rows.length) return;
    const columns = used(view.columns, rows, names);
    if (view.explore && rows.some((row) => "x_m" in row)) columns.push(["", (row) => explored(row, inputs)]);
    parts.push(el("h2", {}, view.title), ...(view.note ? [el("p", { class: "lead" }, view.note)] : []), ...listed(rows, columns, view.title, view.table));
  },

  matrices(view, { outputs, names }, parts) {
    const all = each(outputs, view.path, view.names).filter((found) => !found.names.some((name) => view.omit.includes(name)));
    if (!all.length) return;
    const heading = (found) => view.heading.replace(/\{(\d)\}/g, (_, place) => names.title(found.names[place]).replace("_", " "));
    parts.push(el("h2", {}, view.title), el("p", { class: "lead" }, view.note), el("div", { class: "two" }, ...all.map((found) => matrix(view, heading(found), found.value))));
  },

  overlay(view, result, parts, draws) {
    const rows = (result.tables[view.table] ?? []).filter((row) => row.cells !== null && row.cells !== undefined);
    if (rows.length < 2 || !result.artifacts.some((file) => file.name === view.artifact)) return;
    const all = rows.map((row) => row[view.by]), first = all.includes(view.certain) ? view.certain : all[0], second = all.find((name) => name !== first);
    const pick = (label, chosen) => el("select", { "aria-label": label }, ...all.map((name) => el("option", { value: name, selected: name === chosen }, result.names.title(name))));
    const [one, two] = [pick("first set", first), pick("second set", second)];
    const chart = el("div", { class: "chart masks", role: "group", "aria-label": "Cells where both, one or neither of the two sets hold" }), said = el("p", { class: "note agreement" });
    parts.push(el("h2", {}, view.title), el("div", { class: "inline on-screen" }, one, " against ", two), chart, said);
    draws.push(() => drawOverlay({ view, result, chart, said, one, two }));
  },

  scene(view, result, parts, draws) {
    if (!result.artifacts.some((file) => file.name === view.artifact)) return;
    const made = sceneParts(view.title);
    parts.push(el("h2", {}, view.title), made.card);
    draws.push(() => drawScene({ view, result, parts: made }));
  },

  picture(view, result, parts, draws) {
    const layers = layersOf(view, result.tables, result.inputs);
    if (!layers.length) return;
    const chart = el("div", { class: "chart", role: "group", "aria-label": `${view.title}; the tables have the figures` });
    parts.push(el("figure", { class: "card" }, chart));
    draws.push(() => drawPicture({ view, result, chart, layers }));
  },

  flights(view, result, parts, draws) {
    const groups = each(result.outputs, `${view.path}.*`);
    if (!groups.length) return;
    const chart = el("div", { class: "chart", role: "group", "aria-label": `${view.title}: flights in the body frame` });
    const has = result.artifacts.some((file) => file.name === view.artifact);
    parts.push(el("h2", {}, view.title), ...(has ? [el("div", { class: "card replay" }, chart)] : []));
    for (const { value: cases, names: [group] } of groups) {
      const rows = cases.map((one) => ({ ...one, ...Object.fromEntries(Object.entries(one.certified ?? {}).map(([name, yes]) => [`certified.${name}`, yes])) }));
      const columns = [...used(view.columns, rows, result.names), ["", (row) => explored(row, result.inputs)]];
      parts.push(el("h3", {}, group.replace("_", " ")), rows.length ? table(rows, columns, `${view.title} of ${group}`) : el("p", { class: "note" }, "None."));
    }
    if (has) draws.push(() => drawFlights({ view, result, chart }));
  },
};

const missing = (value) => value === null || value === undefined || value === "";

/** Non-empty columns as [title, function of the row]; names among their values are replaced by titles. */
function used(columns, rows, names) {
  const there = columns.filter(({ path }) => rows.some((row) => !missing(row[path])));
  return there.map(({ title, path }) => [title, (row) => (typeof row[path] === "string" ? names.title(row[path]) : row[path])]);
}

/** A table and its download. */
export function listed(rows, columns, title, name) {
  const told = rows.length > MOST_ROWS ? el("p", { class: "note" }, `The first ${MOST_ROWS} of ${rows.length} rows; the download has all.`) : null;
  const plain = columns.filter(([head]) => head !== "");
  const download = el("button", { type: "button", class: "plain", onclick: () => save(`${name}.csv`, csv([plain.map(([head]) => head), ...rows.map((row) => plain.map(([, of]) => of(row)))])) }, "CSV");
  return [table(rows.slice(0, MOST_ROWS), columns, title), told, el("div", { class: "tools" }, download)].filter(Boolean);
}

const explored = (row, inputs) => el("a", { href: `${root}/dashboard${exploreAddress(row, inputs)}` }, "explore");

/** A confusion matrix as a labelled picture: claim against truth. */
function matrix({ claims, facts, cells }, title, { tp, fp, fn, tn, precision, recall }) {
  const cell = (count, of, kind, text) => {
    const span = wilson(count, of);
    return el("td", { class: kind }, String(count), el("small", {}, text), span ? el("small", {}, `${(100 * span[0]).toFixed(1)}–${(100 * span[1]).toFixed(1)} %`) : null);
  };
  const [both, claimed, missed, neither] = cells;
  return el("figure", { class: "card" }, el("figcaption", {}, el("b", {}, title), ` precision ${figure(precision, 3)}, recall ${figure(recall, 3)}`),
    el("table", { class: "matrix" }, el("thead", {}, el("tr", {}, el("td"), ...facts.map((fact) => el("th", { scope: "col" }, fact)))),
      el("tbody", {}, el("tr", {}, el("th", { scope: "row" }, claims[0]), cell(tp, tp + fp, "right", both), cell(fp, tp + fp, "wrong", claimed)),
        el("tr", {}, el("th", { scope: "row" }, claims[1]), cell(fn, fn + tn, "missed", missed), cell(tn, fn + tn, "right", neither)))));
}
