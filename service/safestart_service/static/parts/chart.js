// Plotly in our colours, light and dark.

/* global Plotly */

// Okabe-Ito: told apart with every kind of colour vision.
export const COLOURS = {
  analytical: "#009E73", exact: "#3B6FD4", backward: "#0072B2", forward: "#56B4E9",
  hamilton_jacobi: "#D55E00", monte_carlo: "#CC79A7", warn: "#E69F00",
};
export const LABELS = {
  analytical: "certificate (closed form)", exact: "exact", backward: "backward (box input)",
  forward: "forward (outer)", hamilton_jacobi: "Hamilton-Jacobi", monte_carlo: "Monte Carlo (flown)",
};
const shades = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
export const theme = () => ({
  ink: shades("--ink"), soft: shades("--soft"), line: shades("--line"), card: shades("--card"), good: shades("--good"), bad: shades("--bad"),
});

const drawn = new Map();

/** Draw or redraw; the picture follows the colour scheme and the width of its place. */
export function draw(place, traces, layout = {}, config = {}) {
  drawn.set(place, [traces, layout, config]);
  const { ink, soft, line, card } = theme();
  const axis = { gridcolor: line, zerolinecolor: line, linecolor: line, tickcolor: line, automargin: true };
  const whole = {
    paper_bgcolor: card, plot_bgcolor: card, font: { color: ink, size: 12, family: "system-ui, sans-serif" },
    margin: { l: 52, r: 12, t: layout.title ? 34 : 12, b: 44 }, hoverlabel: { font: { size: 12 } },
    legend: { orientation: "h", y: -0.16, x: 0, font: { color: soft } }, ...layout,
    xaxis: { ...axis, ...layout.xaxis }, yaxis: { ...axis, ...layout.yaxis },
  };
  if (layout.yaxis2) whole.yaxis2 = { ...axis, ...layout.yaxis2 };
  const bar = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d", "sendChartToCloud"], plotlyServerURL: "", ...config };
  return Plotly.react(place, traces, whole, bar);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const [place, args] of drawn) if (place.isConnected) draw(place, ...args);
});

export function saveButtons(place, name, el) {
  const button = (format) => el("button", {
    type: "button", onclick: () => Plotly.downloadImage(place, { format, filename: name, width: 1200, height: 900 }),
  }, format.toUpperCase());
  return el("span", { class: "saves" }, "Save picture: ", button("png"), button("svg"));
}
