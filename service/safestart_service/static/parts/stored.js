// Sets of stored jobs on Explore's map, shown only if they are for the operating point in the fields.

import { isAbout, textsOf } from "../logic/question.js";
import { get, root } from "./api.js";
import { $, el, fail } from "./page.js";
import { description, names, viewsOf } from "./process.js";

const known = new Map();
let offered = null;

/** Offer the stored jobs that have sets. */
export async function listStored() {
  try {
    const { processes } = await get("/processes"), found = processes.find((one) => one["safestart:view_kinds"].includes("overlay"));
    if (!found) return;
    offered = await description(found.id);
    const { jobs } = await get(`/jobs?${new URLSearchParams({ processID: found.id, status: "successful", limit: 20 })}`);
    const details = await Promise.all(jobs.map((job) => get(`/jobs/${job.jobID}`)));
    $("stored-list").replaceChildren();
    for (const { jobID, inputs } of details) {
      known.set(jobID, inputs);
      $("stored").append(el("option", { value: jobID }, `${inputs.omega_t_deg_s} deg/s, ${inputs.a_max_m_s2} m/s², ${inputs.horizon_s} s (${jobID.slice(0, 8)})`));
    }
    if (!known.size) $("stored-list").replaceChildren("None yet: ", el("a", { href: `${root}/dashboard/submit?process=${found.id}` }, `submit ${found.title.toLowerCase()}`), ", and its sets appear here.");
  } catch (error) {
    fail($("stored-list"), error, listStored);
  }
}

/** Texts for the fields that repeat the job's question. */
export const storedInputs = (job) => (job ? textsOf(known.get(job)) : {});

/** The sets of a job. */
export async function storedSets(job, signal) {
  const [view] = viewsOf(offered, "overlay"), { title, colour } = names(offered);
  const arrays = await get(`/jobs/${job}/artifacts/${view.artifact}/arrays`, { signal });
  return Object.keys(arrays).filter((name) => name.endsWith("_mask")).map((name) => name.slice(0, -5)).filter((name) => name !== view.certain).map((name) => (
    { title: title(name), colour: colour(name), x: arrays.x_m, y: arrays.y_m, mask: arrays[`${name}_mask`].map((row) => row.map(Number)) }));
}

/** The sets and the text to show for a chosen job. */
export function storedNote({ state, answer, error, question }, values) {
  if (state === "none") return { sets: [], note: "" };
  if (state === "failed") return { sets: [], note: `Not shown: ${error.message}` };
  if (state === "asking") return { sets: [], note: "Loading …" };
  const inputs = known.get(question);
  if (!isAbout(inputs, values)) return { sets: [], note: `Not shown: these sets are about ${inputs.omega_t_deg_s} deg/s, ${inputs.a_max_m_s2} m/s² and the corridor of that job, not about the fields above.` };
  return { sets: answer, note: `These sets answer another question: which starts reach the corridor after ${inputs.horizon_s} s, not which stay in it.` };
}
