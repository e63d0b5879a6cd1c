// Figures, times and tables as text.

/** A value for people, with `digits` significant digits; – for a missing value. */
export function figure(value, digits = 4) {
  if (value === null || value === undefined) return "–";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return String(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return String(value);
  return String(Number(value.toPrecision(digits)));
}

/** A figure smaller than this beside the others of its column is 0 but for rounding, as sin(180 deg) is. */
export const rounding = (column) => 1e-14 * Math.max(0, ...column.filter((value) => Number.isFinite(value)).map(Math.abs));

/** A name of the wire as people write it. */
export const spoken = (name) => name.replaceAll("_", " ");

export function duration(seconds) {
  if (seconds === null || seconds === undefined) return "–";
  if (seconds < 0.1) return `${Number(seconds.toPrecision(1))} s`;
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

const two = (number) => String(number).padStart(2, "0");

/** The time of day of a moment, in UTC or in the browser's zone. */
export function clock(text, local = false) {
  const at = new Date(text);
  return local ? [at.getHours(), at.getMinutes(), at.getSeconds()].map(two).join(":") : at.toISOString().slice(11, 19);
}

/** A moment, in UTC or in the browser's zone, which stands behind it. */
export function moment(text, local = false) {
  if (!text) return "–";
  const at = new Date(text), minutes = -at.getTimezoneOffset();
  if (!local) return `${at.toISOString().slice(0, 10)} ${clock(text)} UTC`;
  const zone = `${minutes < 0 ? "−" : "+"}${two(Math.floor(Math.abs(minutes) / 60))}:${two(Math.abs(minutes) % 60)}`;
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${clock(text, true)} ${zone}`;
}

/** What a NO GO of the exact answer is about: thrust that changes within a step may do better. */
export const HELD = "held over steps of 2 s";

/** A text as a sentence: begins with a capital, ends with one full stop. */
export const sentence = (text) => (text ? `${text[0].toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}` : "");

/** Break a text at its dots into lines (<br>) of at most `letters` characters if its parts allow that. */
export function lines(text, letters) {
  const found = [];
  for (const part of text.split(" · ")) {
    const last = found.at(-1);
    if (last !== undefined && last.length + part.length + 3 <= letters) found[found.length - 1] = `${last} · ${part}`;
    else found.push(part);
  }
  return found.join("<br>");
}

/** Ticks of a logarithmic axis that people read as they are: 1, 2 and 5 of every decade between two values. */
export function roundTicks(low, high) {
  const found = [];
  for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); decade++) {
    for (const digit of [1, 2, 5]) {
      const value = Number(`${digit}e${decade}`);
      if (value >= low * 0.999 && value <= high * 1.001) found.push(value);
    }
  }
  return found;
}

const MOST_TICKS = 10;

/** A logarithmic axis for bars, with round ticks: it begins below the least value, so that each bar has a height. */
export function barAxis(values) {
  const there = values.filter((value) => value > 0);
  if (!there.length) return { type: "log" };
  const [low, high] = [Math.min(...there), Math.max(...there)], around = roundTicks(low / 10, high * 10);
  const [first, last] = [around.findLast((tick) => tick < low), around.find((tick) => tick >= high)];
  const all = around.filter((tick) => tick >= first && tick <= last), ticks = all.length > MOST_TICKS ? all.filter((tick) => Number.isInteger(Math.log10(tick))) : all;
  return { type: "log", range: [Math.log10(first), Math.log10(last)], tickvals: ticks, ticktext: ticks.map(String) };
}

/** Rows of cells as CSV (RFC 4180 with plain line ends). */
export const csv = (rows) => `${rows.map((row) => row.map((cell) => {
  const text = cell === null || cell === undefined ? "" : String(cell);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}).join(",")).join("\n")}\n`;
