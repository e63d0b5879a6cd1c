// Explore's map: the corridor with the certified and the exact region, stored sets, and the flight in either frame.

import { arc, closed, corridor, turned } from "../logic/geometry.js";
import { lines } from "../logic/words.js";
import { draw, theme } from "./chart.js";

/** Places narrower than this (px) give the map all of their width: no title along y, small letters, short names. */
const NARROW = 420;
const FILL = "rgba(128,128,128,0.09)";

/** The corridor at rest with all sets of starts. `sets` are stored ones: { title, colour, x, y, mask }. */
function body({ values, certified, region, sets, narrow }) {
  const { ink, soft, certified: green, exact: blue, limit } = theme();
  const shape = values, traces = [];
  const line = (name, points, colour, more = {}) => traces.push({
    name, ...points, mode: "lines", line: { color: colour, width: 2, dash: more.dash }, hoverinfo: "skip", ...more,
  });
  line("corridor", corridor(shape, values.y_max_m), soft, { fill: "toself", fillcolor: FILL });
  if (region?.inner_polygon_m.length) {
    line("exact: proved GO", closed(region.inner_polygon_m), blue, { fill: "toself", fillcolor: "rgba(59,111,212,0.16)" });
  }
  if (region?.outer_polygon_m.length) line("outside: proved NO GO", closed(region.outer_polygon_m), blue, { dash: "dot" });
  if (certified) {
    traces.push({
      name: "certified, for ever", type: "contour", x: certified.x_m, y: certified.y_m, z: certified.margin_m,
      contours: { type: "constraint", operation: "<", value: 0 }, fillcolor: "rgba(0,158,115,0.30)",
      line: { color: green, width: 2 }, showscale: false, hoverinfo: "skip", showlegend: true,
    });
    if (certified.r_sync_m) line(narrow ? "the paper's radius" : "the paper's synchronization radius", arc(certified.r_sync_m, shape, values.y_max_m), limit, { dash: "dash" });
  }
  for (const { title, colour, x, y, mask } of sets) {
    traces.push({
      name: `stored: ${title}`, type: "contour", x, y, z: mask,
      contours: { type: "constraint", operation: "=", value: 0.5 }, line: { color: colour, width: 2, dash: "dashdot" },
      showscale: false, hoverinfo: "skip", showlegend: true,
    });
  }
  traces.push(target(ink));
  return traces;
}

/** The corridor turned with the target, at the clock's time. */
function orbit({ values, region }, turn) {
  const { ink, soft, exact: blue } = theme();
  const outline = corridor(values, values.y_max_m);
  const traces = [{ name: "corridor", ...turned(outline.x, outline.y, turn), mode: "lines", fill: "toself", fillcolor: FILL, line: { color: soft }, hoverinfo: "skip" }];
  if (region?.inner_polygon_m.length) {
    traces.push({ name: "exact region at t = 0", ...closed(region.inner_polygon_m), mode: "lines", line: { color: blue, dash: "dot" }, hoverinfo: "skip" });
  }
  traces.push(target(ink));
  return traces;
}

const target = (ink) => ({ name: "target", x: [0], y: [0], mode: "markers", marker: { symbol: "square", size: 11, color: ink }, hoverinfo: "name", showlegend: false });

/** Draw the map; `says` are the words on the picture, `overlay(frame)` the traces of start and flight. */
export function drawMap(place, { values, certified, region, sets, turn, overlay, says }) {
  const inOrbit = turn !== null;
  const reach = corridor(values, values.y_max_m).half * 1.03;
  const far = Math.max(reach, values.y_max_m * 1.03);
  const narrow = place.clientWidth < NARROW, known = { values, certified, region, sets, narrow };
  const traces = [...(inOrbit ? orbit(known, turn) : body(known)), ...overlay(inOrbit ? "lvlh" : "body")];
  const high = inOrbit ? 2 * far : 1.09 * values.y_max_m, wide = 2 * (inOrbit ? far : reach);
  // As tall as equal axes need, plus title, ticks and legend; the clock below stays on the same screen.
  const small = narrow ? smallLayout(place, traces, says) : null;
  const beside = narrow ? small.margin.t + small.margin.b : 100 + 20 * Math.ceil(7 / Math.max(1, Math.floor((place.clientWidth - 64) / 190)));
  const above = Math.min(place.getBoundingClientRect().top + scrollY, 0.35 * innerHeight);
  const height = Math.max(narrow ? 200 : 280, Math.min(innerHeight - above - 90, ((place.clientWidth - (narrow ? 46 : 70)) * high) / wide + beside));
  place.style.height = `${height}px`;
  return draw(place, traces, {
    ...small, height,
    uirevision: `${inOrbit}/${values.y_max_m}/${values.c_x}`, showlegend: true, title: { text: says },
    xaxis: { automargin: false, title: { text: inOrbit ? `x [m], LVLH: radial${narrow ? "; y: along-track" : ""}` : `x${narrow ? ", y" : ""} [m], target's body frame` }, range: inOrbit ? [-far, far] : [-reach, reach], constrain: "domain" },
    yaxis: { automargin: false, title: { text: narrow ? "" : inOrbit ? "y [m], LVLH: along-track" : "y [m], target's body frame" }, range: inOrbit ? [-far, far] : [-0.06 * values.y_max_m, 1.03 * values.y_max_m], scaleanchor: "x", constrain: "domain" },
  });
}

/** Names that the legend has room for from the beginning: the map does not jump when its answers come. */
const USUAL_NAMES = 6;

/** Fixed margins and the legend of a narrow map, as small as their words allow. */
function smallLayout(place, traces, says) {
  const named = traces.filter(({ name, showlegend }) => name && showlegend !== false).map(({ name }) => name), longest = Math.max(18, ...named.map((name) => name.length));
  const columns = Math.max(1, Math.floor((place.clientWidth - 20) / (5.4 * longest + 45)));
  return {
    margin: { autoexpand: false, l: 38, r: 8, t: 18 + 15 * lines(says, (place.clientWidth - 64) / 6.3).split("<br>").length, b: 56 + 19 * Math.ceil(Math.max(USUAL_NAMES, named.length) / columns) },
    legend: { orientation: "h", yref: "container", y: 0, yanchor: "bottom", xref: "container", x: 0, font: { size: 10, color: theme().soft } },
  };
}

/** The point of the map under a pointer event, to a centimetre; null outside the axes. */
export function pointAt(place, event) {
  const { xaxis, yaxis } = place._fullLayout ?? {};
  if (!xaxis) return null;
  const box = place.getBoundingClientRect();
  const x = xaxis.p2d(event.clientX - box.left - xaxis._offset), y = yaxis.p2d(event.clientY - box.top - yaxis._offset);
  const within = (value, [low, high]) => value >= Math.min(low, high) && value <= Math.max(low, high);
  return within(x, xaxis.range) && within(y, yaxis.range) ? [x.toFixed(2), y.toFixed(2)].map(Number) : null;
}
