// Trade study: certified share over (tumble rate, thrust), and the thrust that a stand-off needs.

import { Store } from "../logic/store.js";
import { closedWords, readTrade, tradeAddress, tradeExplore } from "../logic/trade.js";
import { csv, figure, roundTicks } from "../logic/words.js";
import { onMove, writeAddress } from "../parts/address.js";
import { execute, root } from "../parts/api.js";
import { draw, saveButtons, theme } from "../parts/chart.js";
import { $, el, fail, loading, save, table } from "../parts/page.js";

const FIELDS = ["low", "high", "stand_off_m", "y_max_m", "rest"];
const texts = () => Object.fromEntries(FIELDS.map((name) => [name, $(name).value]));
const usual = texts(), store = new Store(usual);

/** Put what an address says into the fields, and ask it. */
function open(search) {
  const told = new URLSearchParams(search);
  for (const name of FIELDS) $(name).value = told.get(name) ?? usual[name];
  store.set(texts());
  store.hasten();
}

store.panel({
  quiet: 250,
  poses: readTrade,
  asks: (question, signal) => execute("thrust-map", question, { signal }),
  shows: ({ state, question, answer, old, error }) => {
    $("shown").classList.toggle("old", old !== null);
    $("shown").hidden = answer === null && old === null;
    if (state === "failed") fail($("state"), error, () => store.hasten());
    else if (state === "asking") loading($("state"), "Certifying 500 corridors");
    else if (state === "none") $("state").replaceChildren(el("p", { class: "problem", role: "alert" }, "Not shown: each field must hold a number."));
    else {
      $("state").replaceChildren();
      picture(answer, question);
      figures(answer, question);
    }
  },
});

async function picture(found, inputs) {
  const share = found.a_max_m_s2.map((_, k) => found.safe_percent.map((row) => row[k]));
  const [low, high] = [Math.min(...inputs.a_max_m_s2), Math.max(...inputs.a_max_m_s2)];
  const ticks = roundTicks(low, high);
  await draw($("map"), [
    {
      type: "heatmap", x: found.omega_t_deg_s, y: found.a_max_m_s2, z: share, zmin: 0, zmax: 100, colorscale: "Cividis",
      colorbar: { title: { text: "certified [%]" } }, hovertemplate: "%{x} deg/s, %{y} m/s²<br>%{z:.1f} % certified<extra></extra>",
    },
    {
      name: `needed for a start at ${figure(inputs.stand_off_m)} m`, x: found.omega_t_deg_s, y: found.required_a_max_m_s2, mode: "lines+markers",
      line: { color: theme().lost, width: 3 }, hovertemplate: "%{x} deg/s needs %{y:.4f} m/s²<extra></extra>",
    },
    {
      name: "by the paper's conditions, not sound", x: found.omega_t_deg_s, y: found.paper_required_a_max_m_s2, mode: "lines",
      line: { color: theme().soft, width: 1.5, dash: "dot" }, hovertemplate: "%{x} deg/s: the paper says %{y:.4f} m/s²; not sound<extra></extra>",
    },
  ], {
    title: { text: closedWords(inputs) },
    xaxis: { title: { text: "tumble rate [deg/s]" } }, showlegend: true,
    yaxis: { title: { text: "thrust acceleration [m/s²]" }, type: "log", range: [Math.log10(low), Math.log10(high)], tickvals: ticks, ticktext: ticks.map(String) },
  });
  const place = $("map");
  place.removeAllListeners?.("plotly_click");
  place.on("plotly_click", ({ points: [point] }) => location.assign(`${root}/dashboard${tradeExplore(point.x, point.y, inputs)}`));
}

function figures(found, inputs) {
  const rows = found.omega_t_deg_s.map((rate, k) => ({ rate, needed: found.required_a_max_m_s2[k], paper: found.paper_required_a_max_m_s2[k] }));
  $("said").textContent = `Thrust acceleration that certifies a start on the axis, ${figure(inputs.stand_off_m)} m from the target.`;
  const explore = (row) => (row.needed === null ? "–" : el("a", { href: `${root}/dashboard${tradeExplore(row.rate, Number((row.needed * 1.02).toPrecision(3)), inputs)}` }, "explore"));
  $("table").replaceChildren(
    table(rows, [["tumble rate [deg/s]", (r) => r.rate], ["required thrust [m/s²]", (r) => r.needed], ["by the paper's conditions, not sound [m/s²]", (r) => r.paper], ["", explore]], "Required thrust"),
    el("div", { class: "tools" }, el("button", {
      type: "button", class: "plain", onclick: () => save("required-thrust.csv", csv([["omega_t_deg_s", "required_a_max_m_s2", "paper_required_a_max_m_s2"], ...rows.map((r) => [r.rate, r.needed, r.paper])])),
    }, "CSV"), saveButtons($("map"), "trade", el)));
}

// What fills in forms may tell of a change alone.
for (const kind of ["input", "change"]) {
  $("controls").addEventListener(kind, () => {
    store.set(texts());
    if (readTrade(store.inputs)) writeAddress(tradeAddress(store.inputs));
  });
}
$("controls").addEventListener("submit", (event) => { event.preventDefault(); store.hasten(); });
onMove(open);
open(location.search);
