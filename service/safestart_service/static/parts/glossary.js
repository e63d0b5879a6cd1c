// A word's meaning behind a small button after it: a popover that opens by click or key and closes by Escape.

import { meaning } from "../logic/glossary.js";
import { el } from "./page.js";

let number = 0;

/** The button and its popover for a word, or nothing if the glossary does not have it. */
export function explained(text) {
  const found = meaning(text);
  if (found === null) return [];
  const id = `term-${number++}`, said = el("span", { popover: "auto", id, class: "meaning", role: "note" }, el("dfn", {}, found.term), ` ${found.means}`);
  return [el("button", { type: "button", class: "term on-screen", popovertarget: id, "aria-label": `What is ${found.term}?` }, "?"), said];
}

/** Explain the labels and marked words of a part of the page that are in the glossary. */
export function explain(place) {
  for (const word of place.querySelectorAll("label, [data-term]")) {
    if (word.nextElementSibling?.classList.contains("term")) continue;
    const parts = explained(word.dataset.term || word.textContent);
    if (parts.length === 0) continue;
    // Label and button share one cell of whatever grid the label stands in.
    const both = el("span", { class: "named" });
    word.before(both);
    both.append(word, ...parts);
  }
}
