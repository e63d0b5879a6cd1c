// A form from a JSON schema; it needs only a process's description.

import { bounds, filled, numbers, parsed, resolve } from "../logic/schema.js";
import { plainly, titled } from "../logic/titles.js";
import { el } from "./page.js";

/** `{ node, value() }` of one schema; `value()` gives undefined if nothing was entered. */
export function field(schema, whole, name, path, given) {
  schema = resolve(schema, whole);
  const fallback = given ?? schema.default ?? schema.const;
  if (schema.properties) return group(schema, whole, name, path, given ?? schema.default);
  if (schema.enum) return choice(schema, name, path, fallback);
  if (schema.type === "boolean") return tick(schema, name, path, fallback);
  if (schema.type === "array") return list(schema, whole, name, path, fallback);
  if (schema.type === "number" || schema.type === "integer") return number(schema, name, path, fallback);
  if (schema.type === "string") return text(schema, name, path, fallback);
  return json(schema, name, path, fallback);
}

/** The fields of an object: the first ones are open, those that hardly anybody changes are folded. */
function group(schema, whole, name, path, given) {
  const example = whole.examples?.[0] ?? {};
  const parts = Object.entries(schema.properties).map(([key, inner]) => {
    const required = schema.required?.includes(key), known = given?.[key];
    return [key, field(inner, whole, key, path ? `${path}.${key}` : key, known), path !== "" || required || key in example || known !== undefined];
  });
  const open = parts.filter(([, , first]) => first), rare = parts.filter(([, , first]) => !first);
  const folded = rare.length ? el("details", { class: "rare" }, el("summary", {}, `${rare.length} more ${rare.length === 1 ? "setting" : "settings"}, as usual unless changed: ${rare.map(([key]) => titled(key).text.toLowerCase()).join(", ")}`),
    ...rare.map(([, part]) => part.node)) : null;
  const node = el("fieldset", {}, name ? el("legend", {}, titled(name).text) : null, ...open.map(([, part]) => part.node), folded);
  return {
    node,
    value: () => filled(parts.map(([key, part]) => [key, part.value()]), path !== "" && !given, schema),
  };
}

function dial(schema, name, path, control, more) {
  const id = `in-${path}`, { text: title, unit } = titled(name);
  control.id = id;
  control.dataset.path = path;
  const said = [plainly(schema.description), bounds(schema)].filter(Boolean).join(" ");
  if (said) control.setAttribute("aria-describedby", `${id}-said`);
  return el("div", { class: "dial" }, el("label", { for: id, title: name }, title), unit ? el("span", { class: "value" }, control, el("span", { class: "unit" }, unit)) : control, more ?? null,
    said ? el("p", { class: "note", id: `${id}-said` }, said) : null);
}

/** A number. A browser gives no text for what it cannot read as one; the service refuses what stands for it, in place of taking its default. */
function number(schema, name, path, given) {
  const control = el("input", { type: "number", step: "any", inputmode: "decimal" });
  if (given !== undefined && given !== null) control.value = given;
  control.classList.toggle("long", control.value.length > 6);
  return { node: dial(schema, name, path, control), value: () => (control.validity.badInput ? "no number" : control.value === "" ? undefined : Number(control.value)) };
}

/** A line; where the text of a file is wanted, many lines, which may come from a file. */
function text(schema, name, path, given) {
  const long = schema.maxLength > 10000, control = el(long ? "textarea" : "input", long ? { rows: 4, spellcheck: "false" } : { type: "text" });
  if (given !== undefined && given !== null) control.value = given;
  const file = long ? el("input", { type: "file", "aria-label": `${titled(name).text}, from a file`, onchange: async () => {
    control.value = await file.files[0]?.text() ?? control.value;
    control.dispatchEvent(new Event("input", { bubbles: true }));
  } }) : null;
  return { node: dial(schema, name, path, control, file), value: () => (control.value === "" ? undefined : control.value) };
}

function choice(schema, name, path, given) {
  const control = el("select", {}, ...(schema.optional ? [el("option", { value: "" }, "–")] : []),
    ...schema.enum.map((one) => el("option", { value: JSON.stringify(one), selected: one === given }, String(one))));
  return { node: dial(schema, name, path, control), value: () => (control.value === "" ? undefined : JSON.parse(control.value)) };
}

function tick(schema, name, path, given) {
  const control = el("input", { type: "checkbox" });
  control.checked = Boolean(given);
  return { node: dial(schema, name, path, control), value: () => control.checked };
}

function list(schema, whole, name, path, given) {
  const items = resolve(schema.items ?? {}, whole);
  if (items.enum) {
    const boxes = items.enum.map((one) => {
      const box = el("input", { type: "checkbox" });
      box.checked = (given ?? []).includes(one);
      return [one, box];
    });
    const node = el("fieldset", {}, el("legend", {}, titled(name).text),
      el("div", { class: "checks" }, ...boxes.map(([one, box]) => el("label", {}, box, ` ${one}`))),
      schema.description ? el("p", { class: "note" }, plainly(schema.description)) : null);
    node.dataset.path = path;
    return { node, value: () => boxes.filter(([, box]) => box.checked).map(([one]) => one) };
  }
  if (items.type === "number" || items.type === "integer") {
    const control = el("input", { type: "text", inputmode: "text" });
    control.value = (given ?? []).join(", ");
    return { node: dial({ ...schema, description: `${schema.description ?? ""} Numbers, separated by commas.` }, name, path, control), value: () => numbers(control.value) };
  }
  return json(schema, name, path, given);
}

function json(schema, name, path, given) {
  const control = el("textarea", { rows: 4, spellcheck: "false" });
  if (given !== undefined && given !== null) control.value = JSON.stringify(given, null, 1);
  return { node: dial({ ...schema, description: `${schema.description ?? ""} JSON.` }, name, path, control), value: () => parsed(control.value) };
}

/** Mark the field that a problem names, with what is wrong beside it; true if it exists. */
export function mark(form, name, wrong = "") {
  for (const old of form.querySelectorAll(".field-error")) old.remove();
  for (const old of form.querySelectorAll('[aria-invalid="true"]')) old.removeAttribute("aria-invalid");
  const plain = String(name ?? "").replace(/^inputs\.?/, "");
  for (let path = plain; path; path = path.includes(".") ? path.slice(0, path.lastIndexOf(".")) : "") {
    const found = form.querySelector(`[data-path="${CSS.escape(path)}"]`);
    if (found) {
      found.setAttribute("aria-invalid", "true");
      for (let fold = found.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
      if (wrong) found.closest(".dial, fieldset").append(el("p", { class: "note field-error" }, wrong));
      found.scrollIntoView({ block: "center" });
      found.focus?.();
      return true;
    }
  }
  return false;
}
