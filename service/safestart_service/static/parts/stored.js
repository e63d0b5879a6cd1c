// Sets of stored jobs on Explore's map: shown only where they are about the operating point in the fields.

import { isAbout, textsOf } from "../logic/question.js";
import { get } from "./api.js";
import { COLOURS, LABELS } from "./chart.js";
import { $, el, fail } from "./page.js";

const known = new Map();

/** Offer the stored jobs that have sets. */
export async function listStored() {
  try {
    const { jobs } = await get("/jobs?processID=benchmark&status=successful&limit=20");
    const details = await Promise.all(jobs.map((job) => get(`/jobs/${job.jobID}`)));
    $("stored-list").replaceChildren();
    for (const { jobID, inputs } of details) {
      known.set(jobID, inputs);
      $("stored").append(el("option", { value: jobID }, `${inputs.omega_t_deg_s} deg/s, ${inputs.a_max_m_s2} m/s², ${inputs.horizon_s} s (${jobID.slice(0, 8)})`));
    }
    if (!known.size) $("stored-list").textContent = "None yet: submit a benchmark, and its sets appear here.";
  } catch (error) {
    fail($("stored-list"), error, listStored);
  }
}

/** Texts for the fields, so that they ask what the job asked. */
export const storedInputs = (job) => (job ? textsOf(known.get(job)) : {});

/** The sets of a job. */
export async function storedSets(job, signal) {
  const arrays = await get(`/jobs/${job}/artifacts/maps.npz/arrays`, { signal });
  return Object.keys(arrays).filter((name) => name.endsWith("_mask") && name !== "analytical_mask").map((name) => {
    const engine = name.slice(0, -5);
    return { title: LABELS[engine] ?? engine, colour: COLOURS[engine], x: arrays.x_m, y: arrays.y_m, mask: arrays[name].map((row) => row.map(Number)) };
  });
}

/** What to draw of a chosen job, and what to say of it. */
export function storedNote({ state, answer, error, question }, values) {
  if (state === "none") return { sets: [], note: "" };
  if (state === "failed") return { sets: [], note: `Not shown: ${error.message}` };
  if (state === "asking") return { sets: [], note: "Loading …" };
  const inputs = known.get(question);
  if (!isAbout(inputs, values)) return { sets: [], note: `Not shown: these sets are about ${inputs.omega_t_deg_s} deg/s, ${inputs.a_max_m_s2} m/s² and the corridor of that job, not about the fields above.` };
  return { sets: answer, note: `Sets of reaching the corridor after ${inputs.horizon_s} s, another question than to stay in it.` };
}
