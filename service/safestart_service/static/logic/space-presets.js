// The missions of process start-in-space by name: what people call them, and where their numbers come from.

export const MISSIONS = {
  "envisat-tracked": { title: "Envisat, tumbling at 5 deg/s", from: "Start, rate, corridor: Rebollo et al., MPC for tracking, Table I. The paper prints no inertia; this one is of the studies for Envisat's removal" },
  "rocket-body": { title: "Rocket body, flat spin of 3 deg/s", from: "Rate of a CZ-3B stage: Zhao et al., Advances in Space Research 65, 2020. Inertia of a thin-walled cylinder of the stage's size (12.4 m by 3 m: Wikipedia, Long March 3B); mass (no answer depends on it) and orbit are assumptions" },
  envisat: { title: "Envisat, spun against its orbit", from: "2.67 deg/s in 2013: Kucharski et al., IEEE TGRS 52, 2014" },
  "envisat-estimated": { title: "Envisat, state and inertia estimated", from: "As before; the half-widths are assumptions" },
  "envisat-tumbling": { title: "Envisat, to rest at a hold point" },
  "r-bar": { title: "R-bar approach from below" },
  "v-bar": { title: "V-bar approach, start uncertain" },
  "transfer-perigee": { title: "Stage in a transfer orbit, perigee" },
  "transfer-apogee": { title: "Stage in a transfer orbit, apogee" },
  "molniya-perigee": { title: "Debris on a Molniya orbit" },
  "spinning-axis": { title: "Grapple on the spin axis" },
  "past-an-array": { title: "Past a solar array, camera and plume kept" },
};

/** Missions that the service offers, the named ones first: `[name, title, from]`. */
export function offered(examples) {
  const known = Object.keys(MISSIONS).filter((name) => name in examples), others = Object.keys(examples).filter((name) => !(name in MISSIONS));
  return [...known, ...others].map((name) => [name, MISSIONS[name]?.title ?? name.replaceAll("-", " "), MISSIONS[name]?.from ?? ""]);
}
