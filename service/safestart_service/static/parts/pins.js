// The pinned starts: compared in a table, marked on the map where it asks the same.

import { added, alike, differing, pinnedAll, startsOf } from "../logic/pins.js";
import { ASKED, FIELDS, asProcess, sharedWords } from "../logic/question.js";
import { csv, figure } from "../logic/words.js";
import { execute } from "./api.js";
import { theme } from "./chart.js";
import { $, el, fail, save, table } from "./page.js";

const unit = (name) => (FIELDS[name].unit ? ` [${FIELDS[name].unit}]` : "");
const word = (verdict) => verdict.replace("_", " ");

export class Pins {
  list = [];

  /** `given()` are the values of the fields or null; `open(values)` puts a question into them; `changed()` redraws. */
  constructor({ given, open, changed }) {
    Object.assign(this, { given, open, changed });
    $("several").addEventListener("submit", (event) => { event.preventDefault(); this.ask(); });
    this.show();
  }

  add(fresh) {
    this.list = added(this.list, fresh);
    this.show();
    this.changed();
  }

  /** Ask the current question for all starts of the text at once. */
  async ask() {
    const values = this.given(), { starts, wrong } = startsOf($("starts").value), said = $("several-state");
    if (values === null || wrong) {
      said.replaceChildren(el("p", { class: "note field-error", role: "alert" }, values === null ? "A field above cannot be read." : `${wrong[0].toUpperCase()}${wrong.slice(1)}.`));
      return;
    }
    const { id, inputs } = asProcess(values, ...starts), button = $("several").querySelector("button");
    button.disabled = true;
    said.replaceChildren(el("p", { class: "note", role: "status" }, `Checking ${starts.length} starts …`));
    try {
      this.add(pinnedAll(values, starts, await execute(id, inputs)));
      said.replaceChildren();
    } catch (error) {
      fail(said, error, () => this.ask());
    }
    button.disabled = false;
  }

  /** Markers for the map that asks what these values ask. */
  traces(values) {
    const { certified, lost, limit, ink } = theme(), colours = { GO: certified, NO_GO: lost, UNDECIDED: limit };
    const shapes = { GO: "circle", NO_GO: "x", UNDECIDED: "diamond-open" }, list = alike(this.list, values);
    if (!list.length) return [];
    return [{
      name: "pinned starts", x: list.map(({ start }) => start.x_m), y: list.map(({ start }) => start.y_m), mode: "markers", text: list.map(({ verdict }) => word(verdict)),
      marker: { size: 10, color: list.map(({ verdict }) => colours[verdict]), symbol: list.map(({ verdict }) => shapes[verdict]), line: { color: ink, width: 1 } }, hovertemplate: "(%{x}, %{y}) m: %{text}<extra></extra>",
    }];
  }

  show() {
    if (!this.list.length) {
      $("pinned").replaceChildren(el("p", { class: "note" }, "None yet. A pinned start keeps its question and its answer beside others."));
      return;
    }
    const differ = differing(this.list);
    const columns = [
      ["verdict", ({ verdict }) => el("span", {}, el("b", { class: `word ${{ GO: "good", NO_GO: "bad" }[verdict] ?? "open"}` }, word(verdict)), el("span", { class: "note elsewhere" }, "other inputs"))],
      ["x [m]", ({ start }) => start.x_m], ["y [m]", ({ start }) => start.y_m],
      ...differ.map((name) => [`${FIELDS[name].title}${unit(name)}`, ({ values }) => values[name]]),
      ["margin [m]", ({ margin_m: margin }) => (margin === null ? null : Number(figure(margin, 4)))], ["why", ({ reason }) => reason],
      ["", (pin) => el("span", { class: "inline" }, el("button", { type: "button", class: "plain", onclick: () => this.open(pin.values) }, "Show"),
        el("button", { type: "button", class: "plain", "aria-label": `unpin (${pin.start.x_m}, ${pin.start.y_m})`, onclick: () => { this.list = this.list.filter((one) => one !== pin); this.show(); this.changed(); } }, "Unpin"))],
    ];
    const rows = [["verdict", "x_m", "y_m", ...ASKED, "margin_m", "decided_by", "reason"], ...this.list.map(({ verdict, start, values, margin_m: margin, decided_by: by, reason }) => [verdict, start.x_m, start.y_m, ...ASKED.map((name) => values[name]), margin, by, reason])];
    $("pinned").replaceChildren(el("p", { class: "note" }, `${this.list.length > 1 ? "All asked" : "Asked"}: ${sharedWords(this.list[0].values, differ)}.`), table(this.list, columns, "Pinned starts"),
      el("div", { class: "tools" }, el("button", { type: "button", class: "plain", onclick: () => save("starts.csv", csv(rows)) }, "CSV"),
        el("button", { type: "button", class: "plain", onclick: () => { this.list = []; this.show(); this.changed(); } }, "Unpin all")));
    this.mark();
  }

  /** Say of each pinned start whether the fields ask the same now. */
  mark() {
    const same = alike(this.list, this.given());
    [...$("pinned").querySelectorAll("tbody tr")].forEach((row, k) => row.classList.toggle("other", !same.includes(this.list[k])));
  }
}
