// The scene of a question in space: corridor, slices of the region, flight, the target's turning axes.

import { back, edges, fan, fiveFaces, keepOutLines, rotated, rowsOfQuaternion, spaceLines } from "../logic/polyhedron.js";
import { PLANES, onSlice } from "../logic/space.js";
import { draw, theme } from "./chart.js";

const SHADES = ["#0072B2", "#D55E00", "#009E73"], NAMES = ["x", "y", "z"];
const UNITS = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const TITLES = { body: ["x, body [m]", "y, body [m]", "z, body [m]"], lvlh: ["x, radial [m]", "y, along-track [m]", "z, orbit normal [m]"] };

const lines = (name, polylines, colour, width, more = {}) => ({
  type: "scatter3d", name, ...spaceLines(polylines), mode: "lines", line: { color: colour, width, ...more.line }, hoverinfo: "skip", showlegend: more.legend ?? true,
});
const point = (name, [x, y, z], marker) => ({ type: "scatter3d", name, x: [x], y: [y], z: [z], mode: "markers", marker, hoverinfo: "name", showlegend: false });

/** Corridor and keep-outs at one attitude `turn` (rows, LVLH to body) as lines of the frame that is shown. */
function solids(values, frame, turn, reach) {
  const into = (own) => (p) => (own === frame ? p : frame === "body" ? rotated(turn, p) : back(turn, p));
  const faces = values.corridor === "five" ? fiveFaces({ ...values, axis: values.corridor_axis })
    : values.faces.map(({ values: [x, y, z, offset], frame: own }) => ({ normal: [x, y, z], offset, frame: own }));
  return {
    corridor: edges(faces.map(({ normal, offset, frame: own }) => ({ normal: into(own)(normal), offset })), reach),
    keepOuts: (values.further.keep_outs ?? []).flatMap((one) => keepOutLines(one).map((line) => line.map(into(one.frame ?? "body")))),
  };
}

/** Slices of the region at t = 0: the proved GO as surfaces, the outline of what is not proved NO_GO. */
function slices(values, region, into) {
  const { exact } = theme(), found = [];
  for (const { name, inner_polygon: inner, outer_polygon: outer } of region?.planes ?? []) {
    if (!(name in PLANES)) continue;
    const corners = onSlice(values, name, inner).map(into), first = !found.length;
    if (corners.length > 2) {
      found.push({ type: "mesh3d", name: "starts proved GO", x: corners.map((p) => p[0]), y: corners.map((p) => p[1]), z: corners.map((p) => p[2]), ...fan(corners), color: exact, opacity: 0.22, hoverinfo: "skip", flatshading: true, showlegend: first, legendgroup: "slices" });
    }
    const around = onSlice(values, name, outer).map(into);
    if (around.length > 2) found.push(lines("outside: proved NO GO", [[...around, around[0]]], exact, 2, { line: { dash: "dot" }, legend: first }));
  }
  return found;
}

/** The target's axes and the axis it turns about at a time, and where the tips of the axes go. */
function turning(told, frame, turn, rate, reach) {
  const into = (p) => (frame === "body" ? p : back(turn, p)), { soft } = theme();
  const found = UNITS.map((unit, k) => lines(`target's ${NAMES[k]}`, [[[0, 0, 0], into(unit.map((one) => reach * one))]], SHADES[k], 6));
  if (frame === "lvlh" && told) {
    found.push(...UNITS.map((unit, k) => lines(`way of ${NAMES[k]}`, [told.attitude_wxyz.map((q) => back(rowsOfQuaternion(q), unit.map((one) => reach * one)))], SHADES[k], 1.5, { legend: false })));
  }
  const size = rate ? Math.hypot(...rate) : 0;
  if (size > 1e-9) {
    const tip = rate.map((one) => (1.3 * reach * one) / size);
    found.push(lines("turns about", [[into(tip.map((one) => -one)), into(tip)]], soft, 3, { line: { dash: "dash" } }));
  }
  return found;
}

/** Draw; `told` is the answer's turning, `flight` the flight or null, `step` the clock's place in it. */
export function drawSpace(place, { values, told, region, flight, step, frame, word, says }) {
  const { ink, soft, certified, lost, limit, line, card } = theme();
  const path = flight && (frame === "body" ? flight.body_m : flight.lvlh_m), reach = Math.max(values.size_m, ...(path ?? []).flat().map((one) => Math.ceil(1.05 * Math.abs(one))));
  const quaternion = flight ? flight.attitude_wxyz[step] : told?.attitude_wxyz[0] ?? null;
  const first = told ? rowsOfQuaternion(told.attitude_wxyz[0]) : null, own = values.start_frame;
  const traces = [point("target", [0, 0, 0], { size: 5, symbol: "square", color: ink })], into = (p) => (own === frame ? p : frame === "body" ? rotated(first, p) : back(first, p));
  if (quaternion) {
    const turn = rowsOfQuaternion(quaternion), { corridor, keepOuts } = solids(values, frame, turn, reach);
    const at = flight ? flight.time_s[step] : 0, near = told.time_s.reduce((best, one, k) => (Math.abs(one - at) < Math.abs(told.time_s[best] - at) ? k : best), 0);
    traces.push(lines("corridor", corridor, soft, 3), ...turning(told, frame, turn, told.rate_deg_s[near], 0.3 * reach));
    if (keepOuts.length) traces.push(lines("keep-outs", keepOuts, lost, 3));
  }
  if (first || own === frame) {
    traces.push(...slices(values, region, into));
    traces.push(point("start", into(values.position_m), { size: 5, symbol: "x", color: ink }));
  }
  if (flight) {
    const left = flight.distance_m[step].some((one) => one < 0);
    traces.push(lines("flight", [path.slice(0, step + 1)], ink, 5));
    traces.push(point("chaser", path[step], { size: 6, color: left ? lost : word === "GO" ? certified : limit, line: { color: ink, width: 1 } }));
  }
  const axis = (k) => ({ title: { text: TITLES[frame][k] }, range: [-reach, reach], color: soft, gridcolor: line, zerolinecolor: line, backgroundcolor: card, showspikes: false });
  return draw(place, traces, {
    uirevision: `${frame}/${values.size_m}`, showlegend: true, title: { text: says },
    scene: { xaxis: axis(0), yaxis: axis(1), zaxis: axis(2), aspectmode: "cube", camera: { eye: { x: 1.45, y: -1.45, z: 0.9 }, center: { x: 0, y: 0, z: -0.1 } }, uirevision: frame },
  });
}
