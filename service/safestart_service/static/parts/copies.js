// "Copy as": what is on the screen as a command. It is shown as well, as not every page may write to the clipboard.

import { COPIES } from "../logic/copies.js";
import { root } from "./api.js";
import { el } from "./page.js";

/** Buttons that copy a question; `asked()` gives its process and inputs, or null. What is shown leaves with the inputs of `store`. */
export function copies(asked, store = null) {
  const said = el("pre", { tabindex: "0", hidden: true });
  store?.panel({ poses: asked, asks: async () => null, shows: () => { said.hidden = true; } });
  const button = (name) => el("button", {
    type: "button", class: "plain", onclick: async () => {
      const question = asked();
      said.hidden = question === null;
      if (question === null) return;
      said.textContent = COPIES[name]({ address: location.origin + root, ...question });
      await navigator.clipboard?.writeText(said.textContent).catch(() => null);
    },
  }, name);
  return el("div", { class: "copies on-screen" }, el("span", { class: "saves" }, "Copy as ", ...Object.keys(COPIES).map(button)), said);
}
