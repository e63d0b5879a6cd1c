// A picture that a process's description declares: layers of table rows over two axes.

import { corridor } from "../logic/geometry.js";
import { layerTitle, shapeOf } from "../logic/layers.js";
import { sense } from "../logic/outcome.js";
import { roundTicks } from "../logic/words.js";
import { draw, saveButtons, theme } from "./chart.js";
import { el } from "./page.js";

const LEAST_M = 20;
const SYMBOLS = { good: "circle", bad: "x", open: "diamond" };

/** The traces of one layer. */
const DRAWN = {
  line: (layer, colour) => ({ mode: layer.rows.length > 1 ? "lines" : "markers", line: { color: colour, width: 2 }, ...points(layer) }),
  area: (layer, colour) => ({ mode: "lines", fill: "toself", line: { color: colour, width: 2 }, fillcolor: `${colour}22`, ...points({ rows: [...layer.rows, layer.rows[0]] }) }),
  points: (layer, colour, senses) => ({
    mode: "markers", ...points(layer), text: layer.rows.map(({ value }) => (value ?? "").replace("_", " ")),
    marker: { size: 12, color: layer.rows.map(({ value }) => senses.colour(value, colour)), symbol: layer.rows.map(({ value }) => senses.symbol(value)) },
    hovertemplate: "(%{x:.4g}, %{y:.4g}) %{text}<extra></extra>",
  }),
  positive: (layer, colour) => ({
    type: "contour", ...points(layer), z: layer.rows.map(({ value }) => value), contours: { type: "constraint", operation: "<", value: 0 },
    fillcolor: `${colour}4d`, line: { color: colour, width: 2 }, showscale: false, showlegend: true, hoverinfo: "skip",
  }),
  heat: (layer) => ({
    type: "heatmap", ...points(layer), z: layer.rows.map(({ value }) => value), colorscale: "Cividis", colorbar: { title: { text: layer.title } }, showlegend: false,
    hovertemplate: "(%{x:.4g}, %{y:.4g}) %{z:.4g}<extra></extra>",
  }),
};

const points = ({ rows }) => ({ x: rows.map(({ x }) => x), y: rows.map(({ y }) => y) });

function logarithmic(layers) {
  const values = layers.flatMap(({ rows }) => rows.map(({ y }) => y)).filter((y) => y > 0), ticks = roundTicks(Math.min(...values), Math.max(...values));
  return { type: "log", ...(ticks.length > 1 ? { tickvals: ticks, ticktext: ticks.map(String) } : {}) };
}

/** Draw the layers of a view, in the inputs' corridor if it has one. */
export async function drawPicture({ view, result, chart, layers }) {
  const shades = theme(), traces = [], shape = view.equal ? shapeOf(result.inputs, result.spec.inputs) : null;
  const LINES = [shades.exact, shades.lost, shades.certified, shades.limit, "#CC79A7"];
  if (shape) {
    const top = Math.max(LEAST_M, ...layers.flatMap(({ rows }) => rows.map(({ y }) => y))) * 1.05;
    traces.push({ name: "corridor", ...corridor(shape, top), mode: "lines", fill: "toself", fillcolor: "rgba(128,128,128,0.09)", line: { color: shades.soft }, hoverinfo: "skip" });
  }
  const judged = result.spec["safestart:views"].find(({ kind }) => kind === "findings");
  const found = (word) => (judged && word ? sense(judged, word) : "open");
  const senses = { colour: (word, colour) => (word ? { good: shades.certified, bad: shades.lost, open: shades.limit }[found(word)] : colour), symbol: (word) => SYMBOLS[found(word)] };
  const plain = layers.filter(({ drawn }) => drawn === "line");
  for (const layer of layers) {
    // Several lines of one colour would be one: they take the colours of the palette in turn.
    const colour = plain.length > 1 && layer.colour === "ink" ? LINES[plain.indexOf(layer) % LINES.length] : shades[layer.colour];
    traces.push({ name: layerTitle(layer.title, result.outputs), ...DRAWN[layer.drawn](layer, colour, senses) });
  }
  const equal = view.equal ? { scaleanchor: "x", constrain: "domain" } : {};
  await draw(chart, traces, {
    title: { text: view.title }, xaxis: { title: { text: layerTitle(view.x, result.outputs) }, ...(view.equal ? { constrain: "domain" } : {}) },
    yaxis: { title: { text: layerTitle(view.y, result.outputs) }, ...equal, ...(view.logarithmic ? logarithmic(layers) : {}) },
  });
  chart.after(saveButtons(chart, view.title.toLowerCase().replaceAll(/[^a-z]+/g, "-"), el));
}
