// Plotly in our colours, light and dark.

import { recoloured } from "../logic/recolour.js";
import { lines } from "../logic/words.js";

const shades = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const SHADES = ["ink", "soft", "line", "card", "certified", "exact", "limit", "lost"];

/** The current colours of the style sheet. */
export const theme = () => Object.fromEntries(SHADES.map((name) => [name, shades(`--${name}`)]));

const drawn = new Map(), paper = matchMedia("print");
let worn = theme();

/** Rows that a legend of these traces takes below a picture. */
export const legendRows = (place, traces) => Math.ceil(traces.filter((trace) => trace.name && trace.showlegend !== false).length / Math.max(1, Math.floor((place.clientWidth - 64) / 190)));

/**
 * Draw or redraw; the picture follows the colour scheme and the width of its place. A title that is too long is broken
 * at its dots; a legend without a place in the layout goes below everything else.
 */
export function draw(place, traces, layout = {}, config = {}) {
  drawn.set(place, [traces, layout, config]);
  const { ink, soft, line, card } = theme();
  const axis = { gridcolor: line, zerolinecolor: line, linecolor: line, tickcolor: line, automargin: true };
  const told = layout.title && lines(layout.title.text, (place.clientWidth - 64) / 6.3), more = 15 * (told ? told.split("<br>").length - 1 : 0);
  // Plotly puts the first line of a title at its foot.
  const title = layout.title && { font: { size: 12 }, x: 0, xref: "paper", xanchor: "left", y: 1, yref: "paper", yanchor: "bottom", pad: { b: 8 + more }, ...layout.title, text: told };
  const rows = layout.legend ? 0 : legendRows(place, traces);
  const whole = {
    paper_bgcolor: card, plot_bgcolor: card, font: { color: ink, size: 12, family: "system-ui, sans-serif" }, hoverlabel: { font: { size: 12 } },
    margin: { l: 52, r: 12, t: title ? 33 + more : 12, b: 46 + 20 * rows },
    legend: { orientation: "h", yref: "container", y: 0, yanchor: "bottom", x: 0, font: { color: soft } }, ...layout, title,
    xaxis: { ...axis, ...layout.xaxis }, yaxis: { ...axis, ...layout.yaxis },
  };
  // Plotly fits a picture to its place a moment later, which is too late for printing.
  if (paper.matches) Object.assign(whole, { width: place.clientWidth, height: place.clientHeight });
  if (layout.yaxis2) whole.yaxis2 = { ...axis, ...layout.yaxis2 };
  const bar = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d", "sendChartToCloud"], plotlyServerURL: "", ...config };
  return Plotly.react(place, traces, whole, bar);
}

/** Colours and sizes change with these; printing a page resizes no window. */
function anew() {
  const next = theme(), pairs = new Map(SHADES.map((name) => [worn[name], next[name]]));
  worn = next;
  for (const [place, args] of drawn) if (place.isConnected) draw(place, ...recoloured(args, pairs));
}
for (const medium of [matchMedia("(prefers-color-scheme: dark)"), paper]) medium.addEventListener("change", anew);
document.addEventListener("colours", anew);

export function saveButtons(place, name, el) {
  const button = (format) => el("button", {
    type: "button", onclick: () => Plotly.downloadImage(place, { format, filename: name, width: 1200, height: 900 }),
  }, format.toUpperCase());
  return el("span", { class: "saves" }, "Save picture: ", button("png"), button("svg"));
}
