// The question of Explore's inputs: from the texts of its fields to each panel's request, and to words.

import { NUMBER, addressOf, textsFrom } from "./fields.js";
import { HELD, figure, spoken } from "./words.js";

/** Fields by name: their initial texts and their labels. `words` are the choices of a select. */
export const FIELDS = {
  omega_t_deg_s: { first: "3", title: "Tumble rate", unit: "deg/s" },
  a_max_m_s2: { first: "0.1", title: "Thrust acceleration", unit: "m/s²" },
  horizon_s: { first: "60", title: "Time in corridor", unit: "s" },
  y_max_m: { first: "150", title: "Show up to", unit: "m" },
  question: { first: "stay", title: "Requirement", words: ["stay", "synchronize"] },
  within_s: { first: "200", title: "within", unit: "s" },
  rest: { first: "lvlh", title: "Start at rest in", words: ["lvlh", "body"] },
  mean_motion_rad_s: { first: "0.0011", title: "Mean motion", unit: "rad/s" },
  c_x: { first: "1.5", title: "Slope of the sides", unit: "" },
  x0_m: { first: "2.5", title: "Port half-width", unit: "m" },
  r_h_m: { first: "0.5", title: "Hold radius", unit: "m" },
  omega_t_half_width_deg_s: { first: "0", title: "Tumble rate ±", unit: "deg/s" },
  a_max_half_width_m_s2: { first: "0", title: "Thrust ±", unit: "m/s²" },
  position_half_width_m: { first: "0", title: "Start position ±", unit: "m" },
  velocity_half_width_m_s: { first: "0", title: "Start velocity ±", unit: "m/s" },
  disturbance_m_s2: { first: "0", title: "Disturbance up to", unit: "m/s²" },
  x_m: { first: "", title: "x", unit: "m" },
  y_m: { first: "", title: "y", unit: "m" },
};
export const FIRST = Object.fromEntries(Object.entries(FIELDS).map(([name, field]) => [name, field.first]));
const SPREADS = ["omega_t_half_width_deg_s", "a_max_half_width_m_s2", "position_half_width_m", "velocity_half_width_m_s", "disturbance_m_s2"];
const SHAPE = ["c_x", "x0_m", "r_h_m"];
/** What a verdict's question has besides its start. */
export const ASKED = ["omega_t_deg_s", "a_max_m_s2", "question", "horizon_s", "within_s", "rest", "mean_motion_rad_s", ...SHAPE, ...SPREADS];

/**
 * Values of the texts, and errors by field: `{ values, wrong }`. A start has both coordinates or none. Only texts that
 * are not numbers are errors here; the service checks the ranges.
 */
export function read(texts) {
  const values = {}, wrong = {};
  const started = texts.x_m !== "" || texts.y_m !== "";
  for (const [name, { words }] of Object.entries(FIELDS)) {
    const text = texts[name].trim();
    if (words) {
      values[name] = text;
      if (!words.includes(text)) wrong[name] = `one of ${words.join(", ")} is required, not ${text || "nothing"}`;
      continue;
    }
    const number = NUMBER.test(text) && Number.isFinite(Number(text));
    values[name] = number ? Number(text) : null;
    if (!number && (started || !["x_m", "y_m"].includes(name))) wrong[name] = `a number is required, not ${text || "nothing"}`;
  }
  return { values, wrong, started };
}

const pick = (values, names) => Object.fromEntries(names.map((name) => [name, values[name]]));
const shape = (values) => pick(values, SHAPE);
const scenario = (values) => ({ ...pick(values, ["omega_t_deg_s", "a_max_m_s2", "mean_motion_rad_s"]), corridor: shape(values) });
/** Spreads other than 0; a negative one is sent too, so that the service refuses it. */
const spreads = (values) => pick(values, SPREADS.filter((name) => values[name] !== 0));

export const spread = (values) => Object.keys(spreads(values)).length > 0;

/** The request for the map's certified set: the sound certificate, on a grid. */
export const certificate = (values) => ({ ...scenario(values), rest: values.rest, grid: { nx: 81, ny: 81, y_max_m: values.y_max_m } });

/** The request for the map's exact region, which exists only for starts at rest in LVLH; otherwise null. */
export const region = (values) => (values.rest === "lvlh" ? { ...scenario(values), horizon_s: values.horizon_s, y_max_m: values.y_max_m } : null);

const nominal = (values, start) => ({
  ...pick(values, ["omega_t_deg_s", "a_max_m_s2", "mean_motion_rad_s"]), ...shape(values), rest: values.rest, ...start,
});

/** The paper's conditions for one start; they are not sound and ignore time, requirement and spread. */
export const paper = (values, start) => ({ ...nominal(values, start), method: "paper" });

/** The request for the verdict, with the service's choice of method, which gives no GO without a proof. */
export const proven = (values, start) => ({
  ...nominal(values, start), question: values.question, horizon_s: values.horizon_s,
  ...(values.question === "synchronize" ? { within_s: values.within_s } : {}), ...spreads(values),
});

/** The request for the flight, at the nominal values, undisturbed. */
export const flight = (values, start) => ({
  ...scenario(values), rest: values.rest, question: values.question, horizon_s: values.horizon_s,
  ...(values.question === "synchronize" ? { within_s: values.within_s } : {}), start,
});

/** The verdict's question as inputs of the process that answers it for many starts. */
export const asProcess = (values, ...starts) => ({
  id: "go-no-go",
  inputs: {
    ...scenario(values), rest: values.rest, question: values.question, horizon_s: values.horizon_s,
    ...(values.question === "synchronize" ? { within_s: values.within_s } : {}), ...spreads(values), states: starts,
  },
});

const said = (name, value) => `${FIELDS[name].title[0].toLowerCase()}${FIELDS[name].title.slice(1)} ${value}${FIELDS[name].unit ? ` ${FIELDS[name].unit}` : ""}`;
/** Orbit and corridor values that differ from the usual ones. */
const UNUSUAL = ["mean_motion_rad_s", ...SHAPE], isUnusual = (name, values) => values[name] !== Number(FIELDS[name].first);
const unusual = (values) => UNUSUAL.filter((name) => isUnusual(name, values)).map((name) => said(name, values[name]));
const operating = (values) => [`${values.omega_t_deg_s} deg/s`, `${values.a_max_m_s2} m/s²`];
const atRest = (values) => `at rest in ${values.rest === "lvlh" ? "LVLH" : "the body frame"}`;
const staying = (values) => `stay ${values.horizon_s} s`;
const required = (values) => (values.question === "stay" ? staying(values) : `come to rest at the hold point within ${values.within_s} s`);

/** The verdict's question in words. */
export const verdictWords = (values, { x_m, y_m }) => [
  `start (${x_m}, ${y_m}) m ${atRest(values)}`, ...operating(values), required(values),
  ...Object.entries(spreads(values)).map(([name, value]) => said(name, value)), ...unusual(values),
].join(" · ");

/** What questions that differ in some values ask alike, in words; `values` are those of one of them. */
export function sharedWords(values, differ) {
  const same = (name) => !differ.includes(name), requirement = ["question", "horizon_s", "within_s"].every(same);
  return [
    ...["omega_t_deg_s", "a_max_m_s2", ...(requirement ? [] : ["question", "horizon_s"])].filter(same).map((name) => said(name, values[name])),
    ...(requirement ? [required(values)] : []), ...(same("rest") ? [atRest(values)] : []),
    ...[...Object.keys(spreads(values)), ...UNUSUAL.filter((name) => isUnusual(name, values))].filter(same).map((name) => said(name, values[name])),
  ].join(" · ");
}

/** The map's question in words. */
export const mapWords = (values) => [
  `Map: ${values.rest === "lvlh" ? `${staying(values)}, nominal` : "certified for ever, nominal"}`, ...operating(values), atRest(values), ...unusual(values),
].join(" · ");

/** What the verdict asks beyond the map, in words; empty if they ask the same. */
export function mapLacks(values) {
  const lacks = [];
  if (values.question !== "stay") lacks.push(required(values));
  lacks.push(...Object.entries(spreads(values)).map(([name, value]) => said(name, value)));
  if (values.rest !== "lvlh") lacks.push("the exact answer");
  return lacks;
}

/** The deciding method in words, by its name on the wire. */
export const DECIDED = {
  certified: "by the certificate in closed form: a known manoeuvre, for ever", exact: "by a cone program", atlas: "by an atlas of cone programs",
  families: "by cone programs", tube: "by a cone program in the tightened corridor", tracking: "by a flight of the tracking MPC, proved and certified",
};

/** A decided member of a family in words: `GO at nominal`, or `NO-GO at` the values that it has. */
export function memberWords({ verdict, omega_t_deg_s: rate, a_max_m_s2: thrust, position_m: [x, y], velocity_m_s: speed = [] }, values, at) {
  const near = (one, two) => Math.abs(one - two) <= 1e-9 * Math.max(1, Math.abs(two));
  // Where the velocity is uncertain, only one at rest in LVLH is known here to be as given.
  const moves = values.velocity_half_width_m_s !== 0, still = !moves || (values.rest === "lvlh" && speed.every((one) => near(one, 0)));
  const given = still && near(rate, values.omega_t_deg_s) && near(thrust, values.a_max_m_s2) && near(x, at.x_m) && near(y, at.y_m);
  const where = `${figure(rate)} deg/s, ${figure(thrust)} m/s², (${figure(x)}, ${figure(y)}) m${moves ? `, (${speed.map((one) => figure(one, 3)).join(", ")}) m/s` : ""}`;
  return `${verdict.replace("_", "-")} at ${given ? "nominal" : where}`;
}

/** How sure the verdict is, beside its word. */
export function proved(verdict, values) {
  const given = spreads(values), [disturbed, ranges] = ["disturbance_m_s2" in given, Object.keys(given).some((name) => name !== "disturbance_m_s2")];
  const whom = ranges ? " for all within the ranges" : disturbed ? " against every such disturbance" : "";
  return verdict === "UNDECIDED" ? `neither proved nor refuted${whom}` : `proved${whom}`;
}

/** The flight in words, for its caption. `verdict` is the flight's own: nominal, undisturbed. */
export function flownWords(verdict, values) {
  const where = spread(values) ? " at the nominal values, undisturbed" : "";
  if (verdict === "GO") return `Flown: the proof's thrust history, to ${required(values)}${where}`;
  if (values.question === "stay") return `Flown: the best attempt to ${staying(values)}${where}; ${verdict === "NO_GO" ? `no thrust ${HELD} can` : "whether any can is undecided"}`;
  return `Flown: the best attempt to ${staying(values)}${where}, as none is known to ${required(values)}`;
}

/**
 * The flight in words, and whether to show one: from a start outside the corridor none is flown, as it would already
 * have failed.
 */
export function flightWords(flown, values) {
  const [first] = flown.distance_m, outside = first.reduce((least, distance, k) => (distance < first[least] ? k : least), 0);
  if (first[outside] < 0) {
    return { flies: false, text: `Nothing is flown: the start lies outside the corridor, ${figure(-first[outside])} m beyond ${spoken(flown.faces[outside])}.` };
  }
  const nearest = flown.closest_m < 0 ? `${figure(-flown.closest_m)} m beyond ${spoken(flown.closest_face)}` : `${figure(flown.closest_m)} m from ${spoken(flown.closest_face)}`;
  return {
    flies: true,
    text: `${flownWords(flown.verdict, values)}. At worst ${nearest}, at ${figure(flown.closest_s)} s; delta-v ${figure(flown.delta_v_m_s, 3)} m/s.`,
  };
}

/** The start that the values give, null without one. */
export const start = ({ x_m, y_m }) => (x_m === null || y_m === null ? null : { x_m, y_m });

/** Texts for the fields from a job's inputs: the operating point of its sets. */
export const textsOf = ({ omega_t_deg_s, a_max_m_s2, rest, mean_motion_rad_s, corridor, grid }) => Object.fromEntries(
  Object.entries({ omega_t_deg_s, a_max_m_s2, rest, mean_motion_rad_s, ...pick(corridor, SHAPE), y_max_m: grid.y_max_m }).map(([name, value]) => [name, String(value)]));

/** Whether a job's sets are for the operating point of these values, whatever the extent of the map. */
export const isAbout = (inputs, values) => Object.entries(textsOf(inputs)).every(
  ([name, text]) => name === "y_max_m" || (FIELDS[name].words ? values[name] === text : values[name] === Number(text)));

/** Texts for the fields from an address; `unknown` are its names without a field. */
export const fromAddress = (search) => textsFrom(FIELDS, search);

/** The address that gives these texts; it leaves initial texts out. */
export const toAddress = (texts) => addressOf(FIELDS, texts);
