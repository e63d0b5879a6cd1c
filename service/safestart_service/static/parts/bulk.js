// What is done to several chosen jobs at once: one call after the other, told as it goes.

import { get, post, remove } from "./api.js";

const isActive = ({ status }) => ["accepted", "running"].includes(status);

/** Which of the chosen jobs each action is for. */
export const FOR = { cancel: (job) => isActive(job) && !job.dismissal_requested, again: (job) => !isActive(job) };

/** Run a job again: the same inputs, name, tags and note; the new job's id. */
export async function again({ jobID, processID }) {
  const { inputs, name, tags, note } = await get(`/jobs/${jobID}`);
  const made = await post(`/processes/${processID}/execution`, { inputs, name, tags, note }, { headers: { Prefer: "respond-async" } });
  return made.jobID;
}

const cancel = ({ jobID }) => remove(`/jobs/${jobID}`);

/**
 * Do one thing to each job: `{ done, missed, refusal }`. A job that ended meanwhile (409) is missed; any other refusal
 * ends it, as it would meet the next jobs too.
 */
async function each(jobs, act, tell) {
  let done = 0, missed = 0;
  for (const job of jobs) {
    tell(done + missed, jobs.length);
    try {
      await act(job);
      done += 1;
    } catch (error) {
      if (error.status !== 409 && error.status !== 404) return { done, missed, refusal: error };
      missed += 1;
    }
  }
  return { done, missed, refusal: null };
}

/** Cancel the jobs, or run them again; `{ text, refusal }` of how that went. */
export async function bulk(kind, jobs, tell) {
  const { done, missed, refusal } = await each(jobs, kind === "cancel" ? cancel : again, tell);
  const said = kind === "cancel" ? "cancelled" : "queued again";
  return { text: `${done} ${said}${missed ? `, ${missed} had ended or gone before` : ""}${refusal ? `; the other ${jobs.length - done - missed} were left as they are` : ""}.`, refusal };
}
