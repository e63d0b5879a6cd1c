// The approach designer's questions: from the texts of its fields to the plan's and the study's inputs, and to words.

import { digest } from "./store.js";
import { figure } from "./words.js";

/** Fields by name: their initial texts and their labels. */
export const FIELDS = {
  angle_deg: { first: "130", title: "Angle from the V-bar" },
  hops: { first: "5", title: "Hops" },
  hold_m: { first: "100", title: "Hold distance" },
  start_m: { first: "2000", title: "Start distance" },
  keep_out_m: { first: "50", title: "Keep out of" },
  abort_orbits: { first: "2", title: "Drift after a failure" },
  semi_major_axis_m: { first: "8100000", title: "Orbit radius" },
  inclination_deg: { first: "0", title: "Inclination" },
  position_m: { first: "0.5", title: "Position" },
  velocity_m_s: { first: "0.001", title: "Velocity" },
  thrust_share: { first: "0.01", title: "Thrust, relative" },
  thrust_deg: { first: "0.5", title: "Thrust direction" },
  barrier: { first: "off", title: "Barrier", words: ["off", "nominal", "tightened"] },
  kappa: { first: "3", title: "Tightened by" },
  runs: { first: "400", title: "Approaches flown" },
  seed: { first: "0", title: "Seed" },
};
const SIGMA = ["position_m", "velocity_m_s", "thrust_share", "thrust_deg"];
const PLAN = ["angle_deg", "hops", "start_m", "hold_m", "keep_out_m", "semi_major_axis_m", "abort_orbits"];
const STUDY = ["inclination_deg", "barrier", "kappa", "runs", "seed"];
const pick = (values, names) => Object.fromEntries(names.map((name) => [name, values[name]]));

/** Inputs of the plan: hops, burns, proof. */
export const planOf = (values) => ({ ...pick(values, PLAN), sigma: pick(values, SIGMA) });

/** Inputs of the study of the same approach; every input is there, so that a stored one can be told apart. */
export const studyOf = (values) => ({ ...planOf(values), ...pick(values, STUDY), eccentricity: 0, gamma: null, drag_m_s2: 0, proof_model: "linear" });

/** Whether a job's inputs are these. */
export const isOf = (inputs, question) => digest(inputs) === digest(question);

/** Fields without which there is no plan; the others belong to the study alone. */
export const planNeeds = (wrong) => Object.keys(wrong).filter((name) => !STUDY.includes(name));

// ---- the plane: along-track, with the target's flight to the left, and radial, with the Earth below

const RADIANS = Math.PI / 180;

/** A point of the line, [along-track, radial], at a distance. */
export const onLine = (angle, distance) => [distance * Math.cos(angle * RADIANS), -distance * Math.sin(angle * RADIANS)];

/** The angle of a point, deg in [0, 360), to half a degree; null at the target. */
export function angleOf([along, radial]) {
  if (along === 0 && radial === 0) return null;
  return ((Math.round(2 * Math.atan2(-radial, along) / RADIANS) / 2) + 360) % 360;
}

/** How far along the line a point lies, m, kept between the keep-out sphere and the start, to a metre. */
export function holdOf([along, radial], { angle_deg, keep_out_m, start_m }) {
  const [x, y] = onLine(angle_deg, 1), least = Math.ceil(keep_out_m);
  return Math.max(least, Math.min(Math.round(along * x + radial * y), Math.max(Math.ceil(start_m) - 1, least)));
}

/** Paths one after the other, with gaps between them: `{ x, y }`. */
export function joined(paths) {
  const x = [], y = [];
  for (const { along_track_m: along, radial_m: radial } of paths) {
    if (x.length) { x.push(null); y.push(null); }
    x.push(...along); y.push(...radial);
  }
  return { x, y };
}

/** Drifts by what is proved of their hop. */
export const drifts = (answer, verdict) => joined(answer.drifts.filter((one) => one.verdict === verdict));

// ---- words

/** The question in words. */
export const planWords = (values) => `${figure(values.angle_deg)} deg · ${values.hops} ${values.hops === 1 ? "hop" : "hops"} · ${figure(values.start_m)} to ${figure(values.hold_m)} m · thrusters dead after any hop, ${figure(values.abort_orbits)} orbits · keep out ${figure(values.keep_out_m)} m`;

/** What the verdict says, beside its word. */
export const SAYS = {
  PROVED: "to keep out after every hop, whatever the errors of one sigma (linear motion)",
  VIOLATED: "a drift within errors of one sigma enters the sphere (linear motion)",
  UNKNOWN: "neither proved nor refuted (linear motion)",
};

/** Length of the approach in words. */
export const lasting = (answer) => `${figure(answer.plan.orbits)} orbits, ${figure(answer.burns.at(-1).time_s / 60)} min`;

/** The abort probability of a study in words. */
export function risk({ breach }) {
  const percent = (share) => `${figure(100 * share, 3)} %`;
  return `${percent(breach.probability)} (95 %: ${percent(breach.low)} to ${percent(breach.high)})`;
}

/** Rows of the table of burns for a file. */
export const burnRows = (answer) => [
  ["burn", "time_s", "distance_m", "x_m", "y_m", "z_m", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"],
  ...answer.burns.map(({ burn, time_s, distance_m, position_m, impulse_m_s }) => [burn, time_s, distance_m, ...position_m, ...impulse_m_s]),
];
