// An answer that is slow: how long it has been awaited, of how long it is estimated to take.

import { passedWords } from "../logic/estimate.js";
import { post } from "./api.js";
import { el } from "./page.js";

const SOON_MS = 700;

/** The estimate for inputs of a process; null if the service gives none. */
export const estimated = (id, inputs, options) => post(`/processes/${id}/estimate`, { inputs }, options);

/** Show in a place that `text` goes on, until the place shows something else. `asked` is `{ id, inputs }`. */
export function waiting(place, text, asked) {
  const said = el("span", {}, `${text} …`), bar = el("progress", { max: 1, "aria-label": text, hidden: true });
  const node = el("div", { class: "empty waiting", role: "status" }, said, " ", bar), begun = performance.now();
  let seconds = null;
  place.replaceChildren(node);
  const tick = setInterval(() => {
    if (!node.isConnected) {
      clearInterval(tick);
      return;
    }
    const passed = (performance.now() - begun) / 1000;
    said.textContent = `${text}: ${passedWords(passed, seconds)}`;
    bar.hidden = false;
    if (seconds !== null && passed <= seconds) bar.value = passed / seconds;
    else bar.removeAttribute("value");
  }, 500);
  setTimeout(async () => {
    if (!node.isConnected) return;
    // Without an estimate the time that has passed is told alone.
    seconds = (await estimated(asked.id, asked.inputs).catch(() => ({ seconds: null }))).seconds;
  }, SOON_MS);
}
