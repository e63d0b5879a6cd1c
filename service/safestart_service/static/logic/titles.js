// Names of the wire as people write them: a title and a unit.

/** Units by the ends of names, the longest first. */
const UNITS = Object.entries({
  _kg_m2: "kg m²", _deg_s: "deg/s", _rad_s: "rad/s", _m_s2: "m/s²", _m_s: "m/s", _percent: "%", _deg: "deg", _rad: "rad", _min: "min", _m2: "m²", _m: "m", _s: "s",
});
/** Names that are symbols; all others are words. */
const WORDS = {
  omega_t: "Tumble rate", a_max: "Thrust acceleration", mean_motion: "Mean motion", c_x: "Slope of the sides in x", c_z: "Slope of the sides in z",
  x0: "Port half-width in x", z0: "Port half-width in z", r_h: "Hold radius", nx: "Nodes in x", ny: "Nodes in y", y_max: "Corridor cut at", rest: "Starts at rest in",
  omega_t_half_width: "Tumble rate ±", a_max_half_width: "Thrust ±", position_half_width: "Start position ±", velocity_half_width: "Start velocity ±", question: "Requirement",
  x: "x", y: "y", z: "z", n_c: "Steps of the controller", rho: "Share of the distance left (rho)",
};

/** `{ text, unit }` of a name: `stand_off_m` is Stand off, m. */
export function titled(name) {
  const [end, unit] = UNITS.find(([ending]) => name.endsWith(ending) && name.length > ending.length) ?? ["", ""];
  const stem = end ? name.slice(0, -end.length) : name;
  const words = WORDS[stem] ?? stem.replaceAll("_", " ");
  return { text: words.length > 1 ? words[0].toUpperCase() + words.slice(1) : words, unit };
}

/** A description without what only its source needs: powers as people write them, no backticks. */
export const plainly = (text) => (text ?? "").replaceAll("^2", "²").replaceAll("^3", "³").replaceAll("+-", "±").replaceAll("`", "");

/** An input and its value in words: `omega_t_deg_s`, 3 is tumble rate 3 deg/s. */
export function inputWords(path, value) {
  const { text, unit } = titled(path.split(".").at(-1));
  return `${text.length > 1 ? `${text[0].toLowerCase()}${text.slice(1)}` : text} ${value}${unit ? ` ${unit}` : ""}`;
}

/** The title of an input by its path, with its unit: `grid.y_max_m` is Grid: corridor cut at [m]. */
export function inputTitle(path) {
  const parts = path.split(".").map(titled), { unit } = parts.at(-1);
  const words = parts.map(({ text }, k) => (k ? `${text[0].toLowerCase()}${text.slice(1)}` : text)).join(": ");
  return unit ? `${words} [${unit}]` : words;
}
