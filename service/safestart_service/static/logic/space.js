// The question in space: from the texts of the page's fields to the inputs of its processes, back, and to words.

import { NUMBER, valuesOf } from "./fields.js";
import { figure } from "./words.js";

export const STARTS = "start-in-space", REGIONS = "region-in-space";
/** Inputs of start-in-space that stand in the field of further inputs. */
const FURTHER = [
  "keep_outs", "field_of_view", "plume", "position_half_width_m", "velocity_half_width_m_s", "attitude_half_angle_deg", "body_rate_half_width_deg_s",
  "inertia_half_width", "disturbance_m_s2", "method", "tracking",
];
const FRAMES = ["body", "lvlh"], AXES = ["inertial", "lvlh"];
const word = (title, first, words) => ({ title, first, words });
const number = (title, first) => ({ title, first: String(first) });
/** Several numbers in one field, `rows` of them on lines; `names`: each row begins with a name; `ends`: and ends with a frame. */
const numbers = (title, first, size, more = {}) => ({ title, first, size, ...more });

/** Fields by name: initial texts, titles, what they hold. */
export const FIELDS = {
  position_m: numbers("Position", "2 25 1", 3), velocity_m_s: numbers("Velocity", "0 0 0", 3), start_frame: word("Start in", "body", FRAMES),
  attitude: word("Attitude", "torque_free", ["spin", "torque_free", "table"]),
  axis: numbers("Axis", "0 0 1", 3), axis_frame: word("Axis fixed in", "lvlh", AXES), rate_deg_s: number("Rate", -2.67), phase_deg: number("Phase at t = 0", 0),
  inertia_kg_m2: numbers("Inertia", "17023 0 0 0 124826 0 0 0 129112", 9), attitude_wxyz: numbers("Attitude at t = 0 (s x y z)", "1 0 0 0", 4), body_rate_deg_s: numbers("Body rate", "0.3 0.5 -2", 3),
  table: numbers("Table: t s x y z, one time on each line", "0 1 0 0 0\n300 0.87 0 0 0.5", 5, { rows: 2 }), reference: word("Rate, table against", "inertial", AXES),
  orbit: word("Orbit", "circular", ["circular", "elliptic"]), mean_motion_rad_s: number("Mean motion", 0.0011),
  semi_major_axis_m: number("Semi-major axis", 7143500), eccentricity: number("Eccentricity", 0.00012), true_anomaly_deg: number("True anomaly at t = 0", 0),
  corridor: word("Corridor", "five", ["five", "faces"]), corridor_axis: numbers("Opens along (body)", "0 1 0", 3),
  c_x: number("Slope in x", 1.5), c_z: number("Slope in z", 1.5), x0_m: number("Port half-width in x", 2.5), z0_m: number("Port half-width in z", 2.5), r_h_m: number("Hold radius", 0.5),
  faces: numbers("Faces: name, normal, offset, frame, one on each line", "near 0 -1 0 -2 body", 4, { rows: 1, names: true, ends: true }),
  thrust: word("Thrust", "ball", ["ball", "box", "thrusters"]), a_max_m_s2: number("Thrust acceleration", 0.1), box_m_s2: numbers("Largest per axis", "0.1 0.1 0.1", 3),
  thrusters: numbers("Thrusters: direction, largest, one on each line", "1 0 0 0.1\n-1 0 0 0.1\n0 1 0 0.1\n0 -1 0 0.1\n0 0 1 0.1\n0 0 -1 0.1", 4, { rows: 3 }), thrust_frame: word("Its axes", "lvlh", FRAMES),
  question: word("Requirement", "stay", ["stay", "synchronize"]), horizon_s: number("Time in corridor", 60), within_s: number("within", 200),
  hold_m: numbers("Hold point (body)", "", 3, { may: true }), ball_radius_m: number("Ball around it", 0.5), rest_speed_m_s: number("At rest below", 0.05), speed_limit_m_s: numbers("Speed limit", "", 1, { may: true }),
  further: { title: "Further inputs (JSON)", first: "", json: true },
  size_m: number("Show up to", 80), gap: number("Undecided share of a slice", 0.05),
};

/** Which fields count, by the choices of others. */
const NEEDS = {
  spin: ["axis", "axis_frame", "rate_deg_s", "phase_deg"], torque_free: ["inertia_kg_m2", "attitude_wxyz", "body_rate_deg_s", "reference"], table: ["table", "reference"],
  circular: ["mean_motion_rad_s"], elliptic: ["semi_major_axis_m", "eccentricity", "true_anomaly_deg"],
  five: ["corridor_axis", "c_x", "c_z", "x0_m", "z0_m", "r_h_m"], faces: ["faces"],
  ball: ["a_max_m_s2"], box: ["box_m_s2", "thrust_frame"], thrusters: ["thrusters", "thrust_frame"],
  stay: ["horizon_s"], synchronize: ["within_s", "hold_m", "ball_radius_m", "rest_speed_m_s"],
};
const CHOICES = ["attitude", "orbit", "corridor", "thrust", "question"];
const ALWAYS = ["position_m", "velocity_m_s", "start_frame", ...CHOICES, "speed_limit_m_s", "further", "size_m", "gap"];

/** The names of the fields that count for these texts. */
export const counting = (texts) => new Set([...ALWAYS, ...CHOICES.flatMap((name) => NEEDS[texts[name]] ?? [])]);

const cells = (line) => line.split(/[\s,;]+/).filter(Boolean);

/** One field's text as rows of numbers (with names and frames); a text says what is wrong. */
function rowsOf(text, { size, rows = 0, names = false, ends = false, may = false }) {
  const found = rows ? text.split("\n").map(cells).filter((row) => row.length) : [cells(text)];
  if (may && found[0].length === 0) return null;
  if (found.length < rows) return `at least ${rows} ${rows === 1 ? "line is" : "lines are"} required, not ${found.length}`;
  const out = [];
  for (const row of found) {
    const told = `${names ? "a name, " : ""}${size} ${size === 1 ? "number is" : "numbers are"} required${ends ? ", then body or lvlh" : ""}, not ${row.join(" ") || "nothing"}`;
    const end = ends ? (FRAMES.includes(row.at(-1)) ? row.at(-1) : null) : undefined, values = row.slice(names ? 1 : 0, ends ? -1 : undefined);
    if (end === null || values.length !== size || !values.every((one) => NUMBER.test(one) && Number.isFinite(Number(one)))) return told;
    out.push({ name: names ? row[0] : undefined, values: values.map(Number), frame: end });
  }
  return out;
}

/** Values of the texts that count, and what is wrong by field. */
export function readSpace(texts) {
  const counts = counting(texts), plain = Object.fromEntries(Object.entries(FIELDS).filter(([name, { size, json }]) => counts.has(name) && !size && !json));
  const { values, wrong } = valuesOf(plain, texts);
  for (const name of counts) {
    const field = FIELDS[name];
    if (field.size) {
      const found = rowsOf(texts[name], field);
      if (typeof found === "string") wrong[name] = found;
      else values[name] = found === null ? null : field.rows ? found : found[0].values;
    }
  }
  values.further = {};
  if (texts.further.trim()) {
    try {
      values.further = JSON.parse(texts.further);
    } catch {
      wrong.further = "a JSON object is required";
    }
    const strange = Object.keys(values.further ?? {}).filter((name) => !FURTHER.includes(name));
    if (!wrong.further && (typeof values.further !== "object" || values.further === null || Array.isArray(values.further))) wrong.further = "a JSON object is required";
    else if (strange.length) wrong.further = `members ${FURTHER.join(", ")} are required, not ${strange.join(", ")}`;
  }
  return { values, wrong };
}

const pick = (values, names) => Object.fromEntries(names.map((name) => [name, values[name]]));

function attitudeOf(values) {
  if (values.attitude === "spin") return { kind: "spin", ...pick(values, NEEDS.spin) };
  const { reference } = values;
  if (values.attitude === "table") return { kind: "table", times_s: values.table.map((row) => row.values[0]), attitude_wxyz: values.table.map((row) => row.values.slice(1)), reference };
  const j = values.inertia_kg_m2;
  return { kind: "torque_free", inertia_kg_m2: [j.slice(0, 3), j.slice(3, 6), j.slice(6)], attitude_wxyz: values.attitude_wxyz, body_rate_deg_s: values.body_rate_deg_s, reference };
}

function corridorOf(values) {
  if (values.corridor === "five") return { axis: values.corridor_axis, ...pick(values, ["c_x", "c_z", "x0_m", "z0_m", "r_h_m"]) };
  return { faces: values.faces.map(({ name, values: [x, y, z, offset], frame }) => ({ name, normal: [x, y, z], offset_m: offset, frame })) };
}

function thrustOf(values) {
  const frame = values.thrust_frame;
  if (values.thrust === "ball") return { kind: "ball", a_max_m_s2: values.a_max_m_s2 };
  if (values.thrust === "box") return { kind: "box", a_max_m_s2: values.box_m_s2, frame };
  return { kind: "thrusters", directions: values.thrusters.map((row) => row.values.slice(0, 3)), a_max_m_s2: values.thrusters.map((row) => row.values[3]), frame };
}

const scenario = (values) => ({ attitude: attitudeOf(values), orbit: pick(values, NEEDS[values.orbit]), corridor: corridorOf(values), thrust: thrustOf(values) });
const start = (values) => ({ ...pick(values, ["position_m", "velocity_m_s"]), frame: values.start_frame });

/** The verdict's question, as inputs of start-in-space. */
export const startQuestion = (values) => ({
  starts: [start(values)], ...scenario(values), question: values.question,
  ...(values.question === "stay" ? { horizon_s: values.horizon_s } : { ...pick(values, ["within_s", "ball_radius_m", "rest_speed_m_s"]), ...(values.hold_m ? { hold_m: values.hold_m } : {}) }),
  ...(values.speed_limit_m_s ? { speed_limit_m_s: values.speed_limit_m_s[0] } : {}), ...values.further,
});

/** The address of the proof of a question: the service's own bytes, as a script would write numbers another way. */
export function proofAddress({ starts: [one], ...asked }) {
  const flat = Object.entries({ ...one, ...asked }).map(([name, value]) => [name, typeof value === "string" ? value : JSON.stringify(value)]);
  return `/go-no-go/proof?${new URLSearchParams(flat)}`;
}

const UNITS = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
export const PLANES = { xy: [0, 1], zy: [2, 1], xz: [0, 2] };

/** The three planes of positions through the start, in its frame and at its velocity, as inputs of region-in-space. */
export function regionQuestion(values) {
  const { position_m: at, velocity_m_s, start_frame: frame, size_m: size } = values;
  const planes = Object.entries(PLANES).map(([name, [a, b]]) => ({
    name, frame, rest: frame, velocity_m_s, origin_m: at.map((one, k) => (k === a || k === b ? 0 : one)),
    first: { direction: UNITS[a], low: -size, high: size }, second: { direction: UNITS[b], low: -size, high: size },
  }));
  return { ...scenario(values), planes, horizon_s: values.question === "stay" ? values.horizon_s : values.within_s, gap: values.gap };
}

/** Corners of a slice's polygon as points of the start's frame. */
export const onSlice = (values, name, polygon) => polygon.map(([first, second]) => values.position_m.map((one, k) => (k === PLANES[name][0] ? first : k === PLANES[name][1] ? second : one)));

/** What the verdict asks beyond the slices, in words; empty if they ask the same. */
export function sliceLacks(values) {
  const asks = [];
  if (values.question === "synchronize") asks.push("coming to rest at the hold point (the slices: to stay as long)");
  if (values.speed_limit_m_s) asks.push("the speed limit");
  asks.push(...Object.keys(values.further).filter((name) => !["method", "tracking"].includes(name)).map((name) => name.replaceAll("_", " ")));
  return asks;
}

const list = (vector) => `(${vector.map((one) => figure(one)).join(", ")})`;
const TURNS = {
  spin: (v) => `spin of ${figure(v.rate_deg_s)} deg/s about ${list(v.axis)}`,
  torque_free: (v) => `torque-free body, ${list(v.body_rate_deg_s)} deg/s`,
  table: (v) => `attitude from a table of ${v.table.length} times`,
};

/** The question in words. */
export const spaceWords = (values) => [
  `start ${list(values.position_m)} m, ${list(values.velocity_m_s)} m/s in ${values.start_frame === "body" ? "the body frame" : "LVLH"}`, TURNS[values.attitude](values),
  values.orbit === "circular" ? `circular orbit, ${figure(values.mean_motion_rad_s)} rad/s` : `orbit with e = ${figure(values.eccentricity)}, true anomaly ${figure(values.true_anomaly_deg)} deg`,
  values.corridor === "five" ? `corridor along ${list(values.corridor_axis)}` : `${values.faces.length} faces`,
  values.thrust === "ball" ? `${figure(values.a_max_m_s2)} m/s²` : values.thrust === "box" ? `box ${list(values.box_m_s2)} m/s²` : `${values.thrusters.length} thrusters`,
  values.question === "stay" ? `stay ${figure(values.horizon_s)} s` : `at rest at the hold point within ${figure(values.within_s)} s`,
  ...(values.speed_limit_m_s ? [`at most ${figure(values.speed_limit_m_s[0])} m/s`] : []), ...Object.keys(values.further).map((name) => name.replaceAll("_", " ")),
].join(" · ");

const spaced = (vector) => vector.join(" ");

/** Texts for all fields from inputs of start-in-space, as an example or a mission writes them. */
export function textsOf(inputs) {
  const texts = Object.fromEntries(Object.entries(FIELDS).map(([name, { first }]) => [name, first]));
  const put = (given, names = Object.keys(given)) => { for (const name of names) if (given[name] !== undefined && name in FIELDS) texts[name] = String(given[name]); };
  const [{ position_m, velocity_m_s = [0, 0, 0], frame = "lvlh" }] = inputs.starts;
  Object.assign(texts, { position_m: spaced(position_m), velocity_m_s: spaced(velocity_m_s), start_frame: frame });
  const turn = inputs.attitude ?? { kind: "spin", rate_deg_s: inputs.omega_t_deg_s, phase_deg: inputs.phase_deg };
  texts.attitude = turn.kind;
  put(turn, ["rate_deg_s", "phase_deg", "axis_frame"]);
  texts.reference = turn.reference ?? (turn.kind === "table" ? "lvlh" : "inertial");
  for (const name of ["axis", "attitude_wxyz", "body_rate_deg_s"]) if (turn[name] && turn.kind !== "table") texts[name] = spaced(turn[name]);
  if (turn.inertia_kg_m2) texts.inertia_kg_m2 = spaced(turn.inertia_kg_m2.flat());
  if (turn.kind === "table") texts.table = turn.times_s.map((at, k) => spaced([at, ...turn.attitude_wxyz[k]])).join("\n");
  const orbit = inputs.orbit ?? { mean_motion_rad_s: inputs.mean_motion_rad_s };
  texts.orbit = "semi_major_axis_m" in orbit ? "elliptic" : "circular";
  put(orbit);
  const { faces, axis, ...shape } = inputs.corridor ?? {};
  texts.corridor = faces ? "faces" : "five";
  put(shape);
  if (axis) texts.corridor_axis = spaced(axis);
  if (faces) texts.faces = faces.map((face) => `${face.name} ${spaced(face.normal)} ${face.offset_m} ${face.frame ?? "body"}`).join("\n");
  const thrust = inputs.thrust ?? { kind: "ball", a_max_m_s2: inputs.a_max_m_s2 };
  texts.thrust = thrust.kind;
  texts.thrust_frame = thrust.frame ?? "lvlh";
  if (thrust.kind === "ball") texts.a_max_m_s2 = String(thrust.a_max_m_s2);
  else if (thrust.kind === "box") texts.box_m_s2 = spaced(thrust.a_max_m_s2);
  else texts.thrusters = thrust.directions.map((one, k) => spaced([...one, thrust.a_max_m_s2[k]])).join("\n");
  put(inputs, ["question", "horizon_s", "within_s", "ball_radius_m", "rest_speed_m_s", "speed_limit_m_s"]);
  if (inputs.hold_m) texts.hold_m = spaced(inputs.hold_m);
  const further = Object.fromEntries(FURTHER.filter((name) => inputs[name] !== undefined).map((name) => [name, inputs[name]]));
  texts.further = Object.keys(further).length ? JSON.stringify(further) : "";
  // A picture that holds the start and leaves some room beyond it.
  texts.size_m = String(Math.max(5, Math.ceil(1.6 * Math.hypot(...position_m) / 5) * 5));
  return texts;
}
