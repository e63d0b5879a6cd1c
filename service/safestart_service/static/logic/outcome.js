// The outcome of a result: its findings, worst first, and links of its starts to Explore.

const SENSES = ["bad", "open", "good"];

/** The sense of a verdict's word in a view of findings: "good", "bad", or "open" if it decides nothing. */
export const sense = ({ good, bad }, word) => (bad.includes(word) ? "bad" : good.includes(word) ? "good" : "open");

/** The basis of a view's verdicts if it is not a proof, else null. */
export function claim({ basis, unproved }, tables) {
  const found = basis ? tables[""][0][basis] : null;
  return unproved.includes(found) ? found : null;
}

/**
 * The findings of a view, worst first: rows with their word, its sense, and `shown`, the displayed sense, which is
 * "open" without a proof. Within a sense they keep their order.
 */
export const findings = (view, tables) => (tables[view.table] ?? []).map((row) => ({ row, word: row[view.word], sense: sense(view, row[view.word]) }))
  .filter(({ word }) => word !== null && word !== undefined)
  .map((found) => ({ ...found, basis: claim(view, tables), shown: claim(view, tables) === null ? found.sense : "open" }))
  .sort((one, two) => SENSES.indexOf(one.sense) - SENSES.indexOf(two.sense));

/** A result's verdict: the worst word of its findings, and how many have it; null if a process has no findings. */
export function outcome(views, tables) {
  const all = views.filter(({ kind }) => kind === "findings").flatMap((view) => findings(view, tables));
  if (!all.length) return null;
  const worst = SENSES.find((one) => all.some((found) => found.sense === one));
  const so = all.filter((found) => found.sense === worst);
  return { word: so[0].word, sense: so[0].shown, basis: so[0].basis, count: so.length, of: all.length };
}

/** The address of Explore for a start of a result, with the result's corridor, orbit and time. */
export function exploreAddress(row, inputs) {
  const corridor = inputs.corridor ?? {}, of = (name) => row[name] ?? inputs[name];
  const asked = {
    omega_t_deg_s: of("omega_t_deg_s"), a_max_m_s2: of("a_max_m_s2"), horizon_s: inputs.horizon_s, rest: inputs.rest,
    mean_motion_rad_s: inputs.mean_motion_rad_s, c_x: corridor.c_x, x0_m: corridor.x0_m, r_h_m: corridor.r_h_m, x_m: row.x_m, y_m: row.y_m,
  };
  const told = Object.entries(asked).filter(([, value]) => typeof value === "number" || typeof value === "string");
  return `?${new URLSearchParams(told.map(([name, value]) => [name, String(value)]))}`;
}

/** Names of the inputs in which runs differ, inner ones as `outer.inner`. */
export function differing(inputs) {
  const leaves = (value, path) => (value && typeof value === "object" && !Array.isArray(value)
    ? Object.entries(value).flatMap(([key, inner]) => leaves(inner, path ? `${path}.${key}` : key)) : [[path, JSON.stringify(value)]]);
  const all = inputs.map((one) => new Map(leaves(one, "")));
  return [...new Set(all.flatMap((one) => [...one.keys()]))].filter((name) => new Set(all.map((one) => one.get(name))).size > 1);
}
