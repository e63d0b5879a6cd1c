// Shared by all pages: elements, tables, the states empty, loading and failed, the key dialog.

import { clock, figure, moment, rounding } from "../logic/words.js";
import { Problem, hasKey, useKey } from "./api.js";

/** An element with attributes and children; text stays text. */
export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** A text of the service in which commands stand between backticks: they become code. */
export const coded = (text) => text.split(/`+([^`]+)`+/).map((part, k) => (k % 2 ? el("code", {}, part) : part));

export const $ = (id) => document.getElementById(id);

/** Show a failure in place of the content, with a way to continue. */
export function fail(place, error, again) {
  if (error.name === "AbortError") return;
  const known = error instanceof Problem;
  const asks = document.getElementById("key");
  // The user may be typing a key there; a second refusal must not erase it.
  if (known && error.status === 401 && asks && place.contains(asks)) return;
  if (known && error.status === 401) {
    place.replaceChildren(asks ? el("p", { class: "empty" }, "This needs the key that this page asks for.") : keyCard());
    return;
  }
  const box = el("div", { class: "problem", role: "alert" });
  box.append(el("h2", {}, known ? error.document.title ?? "Refused" : "This page has a fault"));
  box.append(el("p", {}, ...coded(error.message)));
  if (known && error.document.required && !error.message.includes(error.document.required)) {
    box.append(el("p", { class: "note" }, `Required: ${error.document.required}. Received: ${error.document.received}.`));
  }
  if (again) box.append(el("button", { type: "button", onclick: again }, "Try again"));
  place.replaceChildren(box);
  if (!known) console.error(error);
}

export function loading(place, text = "Loading") {
  place.replaceChildren(el("p", { class: "empty", role: "status" }, `${text} …`));
}

/** A form that asks for a key; the page is loaded anew with it. */
export function keyForm(id = "key", text = hasKey() ? "This key is not accepted. Another one:" : "API key") {
  const field = el("input", { type: "password", id, autocomplete: "off", required: true });
  const form = el("form", { class: "inline" }, el("label", { for: id }, text), field, el("button", { type: "submit" }, "Use this key"));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    useKey(field.value);
    location.reload();
  });
  return form;
}

/** The card that asks for a key in place of what it opens. */
const keyCard = () => el("section", { class: "card alone" }, el("h2", {}, "This service needs a key"), keyForm(),
  el("p", { class: "note" }, "The browser keeps it until this tab is closed. ", el("code", {}, "safestart keys create"), " makes a key on the machine of the database; whoever runs this service can give you one."));

/** A word in a frame, and its subject: a job's status says nothing about the verdict of its result. */
export const badge = (about, word, kind) => el("span", { class: `badge ${about}` }, el("span", { class: "about" }, about), " ", el("b", { class: about === "job" ? `status ${kind}` : `outcome ${kind}` }, word));

/** The words for a job's status; the wire's own stay the classes. */
const STATUS = { accepted: "waiting", dismissed: "cancelled" };

/** A status of the wire in a word for people. */
export const statusWord = (wire) => STATUS[wire] ?? wire;

/** The name under which the browser keeps the zone of times. */
export const TIMES = "safestart-times";

function isLocal() {
  try {
    return localStorage.getItem(TIMES) === "local";
  } catch {
    return false;
  }
}

/** A moment, for people and for programs; in the zone that the header chooses. */
export const time = (text) => (text ? el("time", { datetime: text }, moment(text, isLocal())) : "–");

/** The time of day of a moment. */
export const hour = (text) => el("time", { datetime: text, "data-clock": true }, clock(text, isLocal()));

export const status = (job) => badge("job", job.dismissal_requested && job.status === "running" ? "stopping" : STATUS[job.status] ?? job.status, job.status);

/** A link to a file of the API, fetched with the key. */
export function download(call, href, name, text) {
  const anchor = el("a", { href, download: name }, text);
  anchor.addEventListener("click", async (event) => {
    event.preventDefault();
    try {
      save(name, await (await call(href)).blob());
    } catch (error) {
      const place = el("div");
      anchor.after(place);
      fail(place, error);
    }
  });
  return anchor;
}

export const definition = (name, value, behind = []) => el("div", {}, el("dt", {}, name, ...behind), el("dd", {}, value));

/** A table: columns of [title, function of the row]; numbers to the right. */
export function table(rows, columns, label) {
  const cells = rows.map((row) => columns.map(([, of]) => of(row)));
  const least = columns.map((_, k) => rounding(cells.map((row) => row[k]))), numeric = columns.map((_, k) => cells.some((row) => typeof row[k] === "number"));
  const head = el("tr", {}, ...columns.map(([title], k) => (title === "" ? el("td") : el("th", { scope: "col", class: numeric[k] ? "number" : null }, title))));
  const body = cells.map((row) => el("tr", {}, ...row.map((value, k) => {
    if (value instanceof Node) return el("td", {}, value);
    const number = typeof value === "number", text = figure(number && Math.abs(value) < least[k] ? 0 : value);
    return el("td", { class: number || (numeric[k] && text === "–") ? "number" : text.length > 40 ? "text" : null }, text);
  })));
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label },
    el("table", {}, el("thead", {}, head), el("tbody", {}, ...body)));
}

/** Give a text (CSV) or a blob to the user as a file. */
export function save(name, content) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: "text/csv" }));
  el("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
