// How this browser shows the pages: colours and times. Kept in the browser, never sent.

import { clock, moment } from "../logic/words.js";
import { $, el, TIMES } from "./page.js";

function keep(name, value) {
  try {
    localStorage.setItem(name, value);
  } catch {
    // A browser that keeps nothing forgets the choice with the page.
  }
}

function kept(name, values) {
  try {
    const found = localStorage.getItem(name);
    return values.includes(found) ? found : values[0];
  } catch {
    return values[0];
  }
}

function colours(chosen) {
  if (chosen === "system") delete document.documentElement.dataset.colours;
  else document.documentElement.dataset.colours = chosen;
  document.dispatchEvent(new Event("colours"));
}

function times(chosen) {
  document.documentElement.dataset.times = chosen;
  for (const node of document.querySelectorAll("time[datetime]")) node.textContent = (node.dataset.clock === undefined ? moment : clock)(node.dateTime, chosen === "local");
}

/** A choice of the header: `[value, word]` for each, the first one the usual. */
function choice(label, name, words, use) {
  const values = words.map(([value]) => value), now = kept(name, values);
  const field = el("select", { "aria-label": label, title: label }, ...words.map(([value, word]) => el("option", { value, selected: value === now }, word)));
  field.addEventListener("change", () => {
    keep(name, field.value);
    use(field.value);
  });
  use(now);
  return field;
}

$("looks").replaceChildren(
  choice("Colours", "safestart-colours", [["system", "Colours: system"], ["light", "Light"], ["dark", "Dark"]], colours),
  choice("Times", TIMES, [["utc", "Times: UTC"], ["local", "Local time"]], times),
);
