// One job: live while it waits or runs, then its results. What is shown survives a reload: it is all on the server.

import { Problem, call, follow, get, post, remove, root } from "../parts/api.js";
import { duration, moment } from "../logic/words.js";
import { $, definition, el, fail, loading, status } from "../parts/page.js";
import { results, sweep } from "../parts/results.js";

const id = $("job").dataset.job;
const log = el("div", { class: "log", role: "log", "aria-label": "Log", tabindex: "0" });
const bar = el("progress", { max: 100, value: 0, "aria-label": "progress" });
const percent = el("span", { class: "percent" }), left = el("span", {}), message = el("p", { class: "note" });
const connection = el("p", { class: "note", role: "status" });

function tell(at, text) {
  const low = log.scrollTop + log.clientHeight >= log.scrollHeight - 4;
  log.append(el("p", {}, `${at.slice(11, 19)}  ${text}`));
  if (low) log.scrollTop = log.scrollHeight;
}

function frame(job) {
  $("title").replaceChildren(`${job.processID} `, status(job));
  document.title = `${job.processID} ${job.status} · safestart`;
  $("inputs").textContent = JSON.stringify(job.inputs, null, 1);
  const active = ["accepted", "running"].includes(job.status);
  $("tools").replaceChildren(...[
    active && !job.dismissal_requested ? el("button", { type: "button", class: "danger", onclick: cancel }, "Cancel") : null,
    active ? null : el("button", { type: "button", onclick: again }, job.status === "successful" ? "Run again" : "Try again"),
    el("a", { href: `${root}/dashboard/submit?process=${job.processID}&from=${id}` }, "Change inputs"),
  ].filter(Boolean));
  const facts = [["Submitted", moment(job.created)], ["Started", moment(job.started)], ["Finished", moment(job.finished)], ["Attempts", String(job.attempts)]];
  if (job.position) facts.push(["Place in the queue", String(job.position)]);
  if (job.starts_in_s) facts.push(["Starts in about", duration(job.starts_in_s)]);
  const parts = [el("dl", {}, ...facts.map(([name, value]) => definition(name, value)))];
  if (job.reason) parts.unshift(el("p", { class: "note" }, `Waits: ${job.reason}.`));
  if (job.problem) parts.unshift(el("section", { class: "problem", role: "alert" }, el("h2", {}, job.problem.title ?? "Failed"), el("p", {}, job.problem.detail ?? "")));
  if (active) parts.unshift(el("div", { class: "line big" }, bar, percent, left), message, connection);
  if (log.childElementCount) parts.push(el("section", { class: "on-screen" }, el("h2", {}, "Log"), log));
  $("state").replaceChildren(...parts);
  at(job.progress, job.message, job.eta_s);
}

function at(progress, text, eta) {
  bar.value = progress;
  percent.textContent = `${Math.floor(progress)} %`;
  left.textContent = eta === null || eta === undefined ? "" : `about ${duration(eta)} left`;
  message.textContent = text ?? "";
}

async function show() {
  const job = await get(`/jobs/${id}`);
  frame(job);
  return job;
}

async function live() {
  loading($("state"));
  try {
    let job = await show();
    const waiting = setInterval(async () => {
      try {
        if (job.status === "accepted") job = await show();
      } catch {
        // The stream below tells of a service that is away.
      }
    }, 2000);
    const cut = job.links.some((link) => link.rel === "partial");
    const part = cut ? setInterval(partial, 3000) : 0;
    await follow(id, async (kind, data) => {
      if (kind === "progress") {
        at(data.progress, data.message, data.eta_s);
        tell(data.at, `${Math.floor(data.progress)} %  ${data.message}`);
      } else if (kind === "log") tell(data.at, data.message);
      else if (kind === "status") {
        tell(data.at, [data.status, data.message].filter(Boolean).join(": "));
        job = await show();
      }
    }, (error) => { connection.textContent = error ? "The connection broke; trying again." : ""; }, new AbortController().signal);
    clearInterval(waiting);
    clearInterval(part);
    job = await show();
    if (job.status === "successful") await results($("results"), job, call);
  } catch (error) {
    fail($("state"), error, error instanceof Problem && error.status === 404 ? null : live);
  }
}

/** What the finished shards say already, for a process that is cut into shards. */
async function partial() {
  try {
    const { shards, outputs, processID, status: now } = await get(`/jobs/${id}/partial`);
    if (now !== "running" || !outputs) return;
    $("results").replaceChildren(el("h2", {}, `So far: ${shards.done} of ${shards.total} shards`), ...(processID === "sweep" ? sweep(outputs) : []));
  } catch {
    // Not cut into shards, or nothing yet.
  }
}

async function cancel() {
  try {
    await remove(`/jobs/${id}`);
    await show();
  } catch (error) {
    fail($("tools"), error, () => location.reload());
  }
}

async function again() {
  try {
    const { processID, inputs } = await get(`/jobs/${id}`);
    const job = await post(`/processes/${processID}/execution`, { inputs }, { headers: { Prefer: "respond-async" } });
    location.assign(`${root}/dashboard/jobs/${job.jobID}`);
  } catch (error) {
    fail($("tools"), error, () => location.reload());
  }
}

await live();
