// Pictures of a job's stored arrays: comparisons of masks, and flights.

import { corridor } from "../logic/geometry.js";
import { agreement } from "../logic/statistics.js";
import { get } from "./api.js";
import { draw, saveButtons, theme } from "./chart.js";
import { el, fail } from "./page.js";

const AXES = { xaxis: { title: { text: "x [m], target's body frame" }, constrain: "domain" }, yaxis: { title: { text: "y [m], target's body frame" }, scaleanchor: "x", constrain: "domain" } };
const arraysOf = ({ job }, { artifact }) => get(`/jobs/${job}/artifacts/${artifact}/arrays`);

/** The comparison of two masks; `one` and `two` are the selects that name them. */
export async function drawOverlay({ view, result, chart, said, one, two }) {
  try {
    const arrays = await arraysOf(result, view);
    const show = () => {
      const { z, counts } = agreement(arrays.inside, arrays[`${one.value}_mask`], arrays[`${two.value}_mask`]);
      const { line, soft } = theme(), { title, colour } = result.names;
      const only = one.value === two.value ? [soft, soft] : [colour(one.value), colour(two.value)];
      const steps = [line, "#999999", "#F0E442", ...only], words = ["outside the corridor", "in neither", "in both", `only ${title(one.value)}`, `only ${title(two.value)}`];
      draw(chart, [{
        type: "heatmap", x: arrays.x_m, y: arrays.y_m, z, zmin: -0.5, zmax: 4.5, colorscale: steps.flatMap((shade, k) => [[k / 5, shade], [(k + 1) / 5, shade]]),
        text: z.map((row) => row.map((k) => words[k])), hovertemplate: "(%{x:.1f}, %{y:.1f}) m: %{text}<extra></extra>",
        showscale: false,
      }, ...words.slice(1).map((word, k) => ({
        name: word.replace(/ \(.*\)/, ""), x: [null], y: [null], mode: "markers", marker: { symbol: "square", size: 10, color: steps[k + 1] },
      }))], AXES);
      said.textContent = `In both ${counts[2]}, ${words[3]} ${counts[3]}, ${words[4]} ${counts[4]}, in neither ${counts[1]} cells.`;
    };
    for (const select of [one, two]) select.addEventListener("change", show);
    show();
    chart.after(saveButtons(chart, "agreement", el));
  } catch (error) {
    fail(chart, error);
  }
}

/** The flights of a file in the corridor. */
export async function drawFlights({ view, result, chart }) {
  try {
    const arrays = await arraysOf(result, view);
    const flights = Object.keys(arrays).filter((name) => name.endsWith("_body_m")).map((name) => name.slice(0, -7));
    if (!flights.length || !result.inputs.corridor) {
      chart.parentElement.remove();
      return;
    }
    const top = Math.max(20, ...flights.flatMap((name) => arrays[`${name}_body_m`].map((p) => 1.1 * p[1])));
    const outline = corridor(result.inputs.corridor, top);
    await draw(chart, [
      { name: "corridor", x: outline.x, y: outline.y, mode: "lines", fill: "toself", fillcolor: "rgba(128,128,128,0.09)", line: { color: theme().soft }, hoverinfo: "skip" },
      ...flights.map((name) => ({
        name: name.replace("_", " "), x: arrays[`${name}_body_m`].map((p) => p[0]), y: arrays[`${name}_body_m`].map((p) => p[1]), text: arrays[`${name}_time_s`].map((t) => `${t} s`),
        mode: "lines+markers", marker: { size: 4 },
      })),
    ], AXES);
    chart.after(saveButtons(chart, view.title.toLowerCase().replaceAll(" ", "-"), el));
  } catch (error) {
    fail(chart, error);
  }
}
