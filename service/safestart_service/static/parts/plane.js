// The orbit plane of an approach: its line, hops and drifts; the start and the hold point can be dragged.

import { drifts, onLine } from "../logic/approach.js";
import { draw, theme } from "./chart.js";

const REACH = 24; // px around a handle

function circle(radius) {
  const x = [], y = [];
  for (let k = 0; k <= 96; k++) {
    x.push(radius * Math.cos((2 * Math.PI * k) / 96));
    y.push(radius * Math.sin((2 * Math.PI * k) / 96));
  }
  return { x, y };
}

/** Hops and drifts of an answer; of an old one they are grey and claim nothing. */
function answered(answer, old) {
  const { soft, exact, certified, lost, limit } = theme();
  const fan = (name, verdict, colour, width) => {
    const points = drifts(answer, verdict);
    return points.x.length ? [{ name, ...points, mode: "lines", line: { color: old ? soft : colour, width }, opacity: old ? 0.15 : 0.55, hoverinfo: "skip", showlegend: !old }] : [];
  };
  const along = answer.path.map(([, y]) => y), radial = answer.path.map(([x]) => x);
  return [
    ...fan("proved to keep out", "PROVED", certified, 1),
    ...fan("not proved", "UNKNOWN", limit, 1.2),
    ...fan("may enter the sphere", "VIOLATED", lost, 1.6),
    { name: "hops", x: along, y: radial, mode: "lines", line: { color: old ? soft : exact, width: 2.5 }, opacity: old ? 0.3 : 1, hoverinfo: "skip", showlegend: !old },
    ...(old ? [] : [{
      name: "burns", x: answer.burns.map(({ position_m: at }) => at[1]), y: answer.burns.map(({ position_m: at }) => at[0]), mode: "markers", marker: { symbol: "x", size: 8, color: exact },
      text: answer.burns.map(({ burn, impulse_m_s: v }) => `burn ${burn}: ${Math.hypot(...v).toFixed(4)} m/s`), hovertemplate: "%{text}<extra></extra>", showlegend: false,
    }]),
  ];
}

/** Draw; `answer` belongs to `values`, or is `old`. `near`: only what surrounds the target. */
export function drawPlane(place, { values, answer, old, says, near }) {
  const { ink, soft, lost, accent } = { ...theme(), accent: theme().limit };
  const start = onLine(values.angle_deg, values.start_m), hold = onLine(values.angle_deg, values.hold_m), far = near ? 2 * Math.max(values.hold_m, values.keep_out_m) : values.start_m, narrow = place.clientWidth < 520;
  const shown = answer ?? old, above = values.angle_deg > 180 && values.angle_deg < 360;
  const handle = (name, [x, y], size, symbol) => ({ name, x: [x], y: [y], mode: "markers", marker: { size, color: accent, symbol, line: { color: ink, width: 1.5 } }, hovertemplate: `${name}<extra></extra>`, showlegend: false });
  const traces = [
    { name: "keep-out sphere", showlegend: !narrow, ...circle(values.keep_out_m), mode: "lines", fill: "toself", fillcolor: `${lost}33`, line: { color: lost, width: 1.5 }, hoverinfo: "skip" },
    { name: "line", x: [0, start[0]], y: [0, start[1]], mode: "lines", line: { color: soft, width: 1, dash: "dot" }, hoverinfo: "skip", showlegend: false },
    ...(shown ? answered(shown, answer === null) : []),
    { name: "target", x: [0], y: [0], mode: "markers", marker: { symbol: "square", size: 8, color: ink }, hoverinfo: "name", showlegend: false },
    handle("hold point: drag", hold, 12, "diamond"), handle("start: drag to turn the line", start, 16, "circle"),
  ];
  const [low, high] = near ? [-1, 1] : above ? [-0.55, 1.2] : [-1.2, 0.55];
  return draw(place, traces, {
    uirevision: `${near}/${values.start_m}/${above}`, showlegend: true, dragmode: "pan", ...(narrow ? {} : { title: { text: says } }),
    xaxis: { title: { text: narrow ? "along-track [m], flight to the left" : "along-track y [m] (the target flies to the left)" }, tickangle: 0, nticks: narrow ? 5 : 11, range: [1.25 * far, -1.25 * far], constrain: "domain" },
    yaxis: { title: { text: narrow ? "radial [m]" : "radial x [m] (Earth below)" }, range: [low * far, high * far], scaleanchor: "x", constrain: "domain" },
  });
}

/** Let start and hold point be dragged: `values()` are the present ones or null, `moved(handle, [along, radial])` hears of every move. */
export function draggable(place, values, moved) {
  let held = null;
  const axes = () => { const { xaxis, yaxis } = place._fullLayout ?? {}; return xaxis && { xaxis, yaxis, box: place.getBoundingClientRect() }; };
  const near = (event) => {
    const at = axes(), now = values();
    if (!at || !now) return null;
    const apart = ([along, radial]) => Math.hypot(at.xaxis.d2p(along) + at.xaxis._offset - (event.clientX - at.box.left), at.yaxis.d2p(radial) + at.yaxis._offset - (event.clientY - at.box.top));
    const all = [["hold", apart(onLine(now.angle_deg, now.hold_m))], ["start", apart(onLine(now.angle_deg, now.start_m))]].filter(([, far]) => far <= REACH);
    return all.length ? all.sort(([, one], [, two]) => one - two)[0][0] : null;
  };
  const end = () => { held = null; place.classList.remove("dragging"); };
  place.addEventListener("pointerdown", (event) => {
    held = event.button === 0 ? near(event) : null;
    if (held === null) return;
    place.setPointerCapture(event.pointerId);
    place.classList.add("dragging");
  }, true);
  // Plotly would pan the picture with the same press.
  for (const kind of ["mousedown", "touchstart"]) {
    place.addEventListener(kind, (event) => {
      if (held === null) return;
      event.preventDefault();
      event.stopPropagation();
    }, { capture: true, passive: false });
  }
  place.addEventListener("pointermove", (event) => {
    if (held === null) { place.classList.toggle("near", near(event) !== null); return; }
    const { xaxis, yaxis, box } = axes();
    moved(held, [xaxis.p2d(event.clientX - box.left - xaxis._offset), yaxis.p2d(event.clientY - box.top - yaxis._offset)]);
  });
  for (const kind of ["pointerup", "pointercancel"]) place.addEventListener(kind, end);
}
