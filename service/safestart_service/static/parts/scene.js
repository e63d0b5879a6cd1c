// A flight about a turning body, in space: clock, frame and camera under the reader's hand.

import { back, camera, lines, rotated } from "../logic/projection.js";
import { figure } from "../logic/words.js";
import { get } from "./api.js";
import { draw, saveButtons, theme } from "./chart.js";
import { el, fail } from "./page.js";

const SPEED = 8; // seconds of flight per second of animation
const AXES = ["x", "y", "z"], SHADES = ["#0072B2", "#D55E00", "#009E73"];

/** Elements of a scene: `{ card, chart, play, clock, time, frame, around, above }`. */
export function sceneParts(title) {
  const range = (label, low, high, value) => el("input", { type: "range", min: low, max: high, step: 1, value, "aria-label": label });
  const chart = el("div", { class: "chart", role: "group", "aria-label": title });
  const [play, clock, time] = [el("button", { type: "button" }, "Fly it"), range("time", 0, 1, 0), el("output", {}, "")];
  const frame = el("select", { "aria-label": "frame" }, el("option", { value: "lvlh" }, "LVLH: the target tumbles"), el("option", { value: "body" }, "body: the corridor stands still"));
  const [around, above] = [range("camera: around the vertical, deg", -180, 180, 35), range("camera: from above, deg", -90, 90, 25)];
  const controls = el("div", { class: "inline on-screen" }, play, " ", clock, " ", time, " ", frame, " ", el("label", {}, "around ", around), " ", el("label", {}, "above ", above));
  return { card: el("div", { class: "card replay" }, chart, controls), chart, play, clock, time, frame, around, above };
}

/** Draw the scene of a view's file and animate it. */
export async function drawScene({ view, result, parts }) {
  const { chart, play, clock, time, frame, around, above } = parts;
  try {
    const arrays = await get(`/jobs/${result.job}/artifacts/${view.artifact}/arrays`);
    const { time_s: times, position_lvlh_m: path, attitude, outline_m: outline, reference_m: reference } = arrays;
    const last = times.length - 1, body = path.map((point, k) => rotated(attitude[k], point));
    const reach = 1.1 * Math.max(...path.map((point) => Math.hypot(...point)), ...outline.flat().map((point) => Math.hypot(...point)));
    let running = 0, step = last;
    clock.max = last;

    const show = (next) => {
      step = next;
      clock.value = step;
      time.textContent = `${figure(times[step], 3)} s`;
      const seen = camera(Number(around.value), Number(above.value)), still = frame.value === "body", turn = attitude[step];
      const fixed = (point) => seen(still ? point : back(turn, point));
      const moving = still ? body : path, { ink, soft, certified } = theme();
      const now = seen(moving[step]), theta = fixed(reference[Math.min(step, reference.length - 1)]);
      draw(chart, [
        { name: "corridor, fixed in the target", ...lines(outline, fixed), mode: "lines", line: { color: soft, width: 1.5 }, hoverinfo: "skip" },
        ...AXES.map((axis, k) => ({
          name: `target's ${axis}`, ...lines([[[0, 0, 0], AXES.map((_, j) => (j === k ? 0.35 * reach : 0))]], fixed), mode: "lines", line: { color: SHADES[k], width: 3 }, hoverinfo: "name",
        })),
        { name: "flown", ...lines([moving.slice(0, step + 1)], seen), mode: "lines", line: { color: ink, width: 2.5 }, hoverinfo: "skip" },
        { name: "artificial reference", x: [theta[0]], y: [theta[1]], mode: "markers", marker: { size: 9, symbol: "diamond-open", color: "#CC79A7", line: { width: 2 } }, hoverinfo: "name" },
        { name: "chaser", x: [now[0]], y: [now[1]], mode: "markers", marker: { size: 13, color: certified, line: { color: ink, width: 2 } }, hoverinfo: "name" },
      ], {
        xaxis: { range: [-reach, reach], constrain: "domain", title: { text: "seen from the camera [m]" } },
        yaxis: { range: [-reach, reach], scaleanchor: "x", constrain: "domain", title: { text: "[m]" } },
      });
    };
    const stop = () => {
      cancelAnimationFrame(running);
      running = 0;
      play.textContent = "Fly it";
    };
    play.addEventListener("click", () => {
      if (running) {
        stop();
        return;
      }
      const from = step >= last ? times[0] : times[step], begun = performance.now();
      play.textContent = "Pause";
      const tick = (at) => {
        const due = times.findIndex((one) => one >= from + (SPEED * (at - begun)) / 1000);
        show(due < 0 ? last : due);
        if (due < 0 || due === last || !chart.isConnected) stop();
        else running = requestAnimationFrame(tick);
      };
      running = requestAnimationFrame(tick);
    });
    clock.addEventListener("input", () => { stop(); show(Number(clock.value)); });
    for (const control of [frame, around, above]) control.addEventListener("input", () => show(step));
    show(last);
    chart.after(saveButtons(chart, view.title.toLowerCase().replaceAll(" ", "-"), el));
  } catch (error) {
    fail(chart, error);
  }
}
