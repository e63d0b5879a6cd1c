// One flight: its curves, its clock, and its state on the map at the clock's time.

import { figure, spoken } from "../logic/words.js";
import { draw, theme } from "./chart.js";
import { $ } from "./page.js";

const FACES = ["#0072B2", "#D55E00", "#CC79A7", "#E69F00", "#56B4E9"];
const DASHES = ["solid", "dash", "dot", "dashdot"];
const SPEED = 6; // seconds of flight per second of animation

export class Flight {
  /** `redraw` draws the scene at the clock's time; `controls` are of use only while there is a flight. */
  constructor(redraw, controls = ["play", "clock", "frame"]) {
    this.redraw = redraw;
    this.controls = controls.map($);
    this.data = null;
    this.step = 0;
    this.running = 0;
    $("play").addEventListener("click", () => (this.running ? this.stop() : this.play()));
    $("clock").addEventListener("input", () => { this.stop(); this.show(Number($("clock").value)); });
  }

  /** Remove the flight; `text` says why there is none. */
  clear(text = "") {
    this.stop();
    this.data = null;
    for (const control of this.controls) control.disabled = true;
    $("flown").textContent = text;
    $("time").textContent = $("instant").textContent = "";
    $("flight-line").hidden = true;
    $("flight").classList.toggle("empty-flight", true);
  }

  /** Show a flight at its end; `text` describes it, `limit` is its largest thrust acceleration, null for none. */
  load(data, text, limit) {
    this.stop();
    this.data = data;
    this.limit = limit;
    $("flight-line").hidden = false;
    $("clock").max = data.time_s.length - 1;
    for (const control of this.controls) control.disabled = false;
    $("flown").textContent = text;
    $("flight").classList.toggle("empty-flight", false);
    this.curves();
    this.show(data.time_s.length - 1, false);
  }

  /** Angle (rad) by which the corridor has turned at the clock's time. */
  turn(rate) {
    return (rate * Math.PI / 180) * this.data.time_s[this.step];
  }

  traces(frame, start) {
    const { ink, certified, lost } = theme();
    if (!this.data) {
      return start ? [{ name: "start", x: [start[0]], y: [start[1]], mode: "markers", marker: { size: 11, color: ink, symbol: "x" }, hoverinfo: "name", showlegend: false }] : [];
    }
    const all = frame === "lvlh" ? this.data.lvlh_m : this.data.body_m;
    const path = all.slice(0, this.step + 1), now = path[path.length - 1];
    const left = this.data.distance_m[this.step].some((distance) => distance < 0);
    return [
      { name: "flight", x: path.map((p) => p[0]), y: path.map((p) => p[1]), mode: "lines", line: { color: ink, width: 2.5 }, hoverinfo: "skip" },
      { name: "start", x: [all[0][0]], y: [all[0][1]], mode: "markers", marker: { size: 11, color: ink, symbol: "x" }, hoverinfo: "name", showlegend: false },
      { name: "chaser", x: [now[0]], y: [now[1]], mode: "markers", marker: { size: 13, color: left ? lost : certified, line: { color: ink, width: 2 } }, hoverinfo: "name", showlegend: false },
    ];
  }

  curves() {
    const { time_s: x, thrust_m_s2: thrust, distance_m: distance, faces } = this.data;
    const { soft, ink, limit } = theme(), ends = [x[0], x.at(-1)];
    const traces = faces.map((face, k) => ({
      name: spoken(face), x, y: distance.map((row) => row[k]), mode: "lines", line: { color: FACES[k % FACES.length], width: 2, dash: DASHES[Math.floor(k / FACES.length) % DASHES.length] }, hovertemplate: "%{y:.2f} m",
    }));
    traces.push({
      name: "thrust", x, y: thrust.map((u) => Math.hypot(...u)), mode: "lines", line: { color: soft, width: 1.5, shape: "hv", dash: "dot" },
      yaxis: "y2", hovertemplate: "%{y:.4f} m/s²",
    });
    if (this.limit !== null) traces.push({ name: "thrust limit", x: ends, y: [this.limit, this.limit], mode: "lines", line: { color: limit, width: 1.5, dash: "dash" }, yaxis: "y2", hoverinfo: "skip" });
    traces.push({ name: "face", x: ends, y: [0, 0], mode: "lines", line: { color: ink, width: 1.5 }, showlegend: false, hoverinfo: "skip" });
    draw($("curves"), traces, {
      hovermode: "x", shapes: [this.mark()], margin: { l: 46, r: 50, t: 8, b: 84 }, legend: { orientation: "h", xref: "container", yref: "container", y: 0, yanchor: "bottom", x: 0, xanchor: "left", font: { size: 11 } },
      xaxis: { title: { text: "time [s]" } }, yaxis: { title: { text: "to face [m]" }, rangemode: "tozero" },
      yaxis2: { title: { text: "thrust [m/s²]" }, overlaying: "y", side: "right", rangemode: "tozero", showgrid: false, tickmode: "auto", nticks: 5 },
    });
  }

  /** State, thrust and the nearest face at the clock's time, in words. */
  instant() {
    const { time_s: time, body_m: body, lvlh_m: orbit, lvlh_m_s: speed, thrust_m_s2: thrust, distance_m: distance, faces } = this.data, k = this.step;
    const at = (vector, digits) => `(${vector.map((value) => figure(value, digits)).join(", ")})`;
    const near = distance[k].indexOf(Math.min(...distance[k]));
    return `At ${figure(time[k], 4)} s: body ${at(body[k], 4)} m · LVLH ${at(orbit[k], 4)} m, ${at(speed[k], 3)} m/s · thrust ${at(thrust[k], 3)} m/s² · ${figure(Math.abs(distance[k][near]), 4)} m ${distance[k][near] < 0 ? "beyond" : "to"} ${spoken(faces[near])}`;
  }

  mark() {
    const at = this.data.time_s[this.step];
    return { type: "line", x0: at, x1: at, y0: 0, y1: 1, yref: "paper", line: { color: theme().ink, width: 1 } };
  }

  show(step, draws = true) {
    this.step = step;
    $("clock").value = step;
    $("time").textContent = `${figure(this.data.time_s[step], 3)} s`;
    $("instant").textContent = this.instant();
    window.Plotly.relayout($("curves"), { shapes: [this.mark()] });
    if (draws) this.redraw();
  }

  play() {
    const begun = performance.now(), last = this.data.time_s.length - 1;
    const from = this.step >= last ? 0 : this.data.time_s[this.step];
    $("play").textContent = "Pause";
    const tick = (now) => {
      const time = from + (SPEED * (now - begun)) / 1000;
      const next = this.data.time_s.findIndex((at) => at >= time);
      this.show(next < 0 ? last : next);
      if (next < 0 || next === last) this.stop();
      else this.running = requestAnimationFrame(tick);
    };
    this.running = requestAnimationFrame(tick);
  }

  stop() {
    cancelAnimationFrame(this.running);
    this.running = 0;
    $("play").textContent = "Fly it";
  }
}
