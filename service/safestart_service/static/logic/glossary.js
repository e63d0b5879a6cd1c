// What the words of the pages mean; docs/glossary.md says the same.

/** Terms with their meanings; `also` are other forms under which the pages show them. */
export const TERMS = [
  { term: "GO", means: "A start from which the requirement is proved to be met: the service knows a manoeuvre or a thrust history that meets it, and its proof." },
  { term: "NO GO", means: "A start for which it is proved that no thrust within the limit, held over the steps that the answer states, meets the requirement, whatever the controller." },
  { term: "UNDECIDED", means: "Neither is proved. It never counts as a GO." },
  { term: "Tumble rate", means: "How fast the target turns about its axis, as seen from the orbit frame (LVLH), in degrees per second." },
  { term: "Thrust acceleration", means: "The largest acceleration that the chaser can give itself, in any direction, at any time." },
  { term: "Time in corridor", means: "How long the chaser must be able to stay in the corridor from its start on." },
  { term: "Requirement", means: "What the chaser must be able to do from its start: stay in the corridor for a time, or come to rest at the hold point within a time." },
  { term: "Start at rest in", means: "The frame in which the chaser does not move at its start. At rest in LVLH it sees the target turn; at rest in the body frame it turns with the target." },
  { term: "LVLH", means: "The orbit frame of the target: x points away from the Earth, y along the flight, z completes them." },
  { term: "Body frame", means: "The frame that is fixed in the target and turns with it; the corridor stands still in it." },
  { term: "Corridor", means: "The space in front of the port in which the chaser must stay: it widens with the distance and turns with the target." },
  { term: "Margin", means: "How far from the nearest limit the best thrust history keeps the chaser, in metres. A negative margin says by how much every thrust history, held over the steps, breaks it at some time.", also: ["margin [m]", "proved margin [m]"] },
  { term: "Mean motion", means: "The rate at which the target goes round its orbit, in radians per second." },
  { term: "Slope of the sides", means: "How much wider the corridor is on each side for every metre of distance." },
  { term: "Port half-width", means: "Half the width of the corridor at the hold radius." },
  { term: "Hold radius", means: "The distance from the target at which the corridor begins; the hold point lies there." },
  { term: "Certified", means: "Proved by the certificate in closed form: a known manoeuvre keeps the chaser in the corridor for ever." },
  { term: "Exact region", means: "The starts from which some thrust history meets the requirement, bounded by proofs from inside and from outside." },
  { term: "Outcome", means: "The verdict of a result, the worst of its findings. A job can be successful and its outcome NO GO." },
  { term: "Disturbance", means: "An unknown acceleration of at most this size, at any time and in any direction, against which the answer holds.", also: ["Or disturbance up to"] },
  { term: "Precision", means: "Of the starts that a method claims to be safe, the share that are." },
  { term: "Recall", means: "Of the starts that are safe, the share that a method claims." },
];

const known = new Map(TERMS.flatMap((entry) => [entry.term, ...(entry.also ?? [])].map((name) => [name.toLowerCase(), entry])));

/** The entry for a text of the pages, or null. */
export const meaning = (text) => known.get(text.trim().toLowerCase()) ?? null;
