// One job: live while it waits or runs, then its results. Everything is on the server and survives a reload.

import { newest } from "../logic/store.js";
import { duration } from "../logic/words.js";
import { Problem, call, follow, get, remove, root } from "../parts/api.js";
import { again } from "../parts/bulk.js";
import { copies } from "../parts/copies.js";
import { labelled } from "../parts/labels.js";
import { $, coded, definition, download, el, fail, hour, loading, status, statusWord, time } from "../parts/page.js";
import { description } from "../parts/process.js";
import { known, results, verdictBadge } from "../parts/results.js";
import { shown } from "../parts/views.js";

const LOOKS_MS = 3000; // how often the partial result of a job is looked at
const id = $("job").dataset.job;
const log = el("div", { class: "log", role: "log", "aria-label": "Log", tabindex: "0" });
const bar = el("progress", { max: 100, value: 0, "aria-label": "progress" });
const percent = el("span", { class: "percent" }), left = el("span", {}), message = el("p", { class: "note" });
const connection = el("p", { class: "note", role: "status" });
let job = null, verdict = null;

const isActive = () => ["accepted", "running"].includes(job.status);

function tell(at, text) {
  const low = log.scrollTop + log.clientHeight >= log.scrollHeight - 4;
  log.append(el("p", {}, hour(at), `  ${text}`));
  if (low) log.scrollTop = log.scrollHeight;
}

function title() {
  $("title").replaceChildren(...[`${job.name || job.processID} `, verdict, status(job)].filter(Boolean));
  $("process").textContent = job.name ? `${job.processID} ` : "";
  document.title = `${job.name || job.processID} ${job.status} · safestart`;
}

/** Name, tags and note, unless somebody is writing them. */
function labels() {
  if ($("labels").contains(document.activeElement) && $("labels").querySelector("form")) return;
  $("labels").replaceChildren(labelled(job, fail, (now) => {
    job = now;
    title();
    $("labels").replaceChildren();
    labels();
    $("label").focus();
  }));
}

function frame() {
  title();
  labels();
  $("inputs").textContent = JSON.stringify(job.inputs, null, 1);
  $("asked").hidden = false;
  const active = isActive();
  $("tools").replaceChildren(...[
    active && !job.dismissal_requested ? el("button", { type: "button", class: "danger", onclick: cancel }, "Cancel") : null,
    active ? null : el("button", { type: "button", onclick: repeat }, job.status === "successful" ? "Run again" : "Try again"),
    el("a", { href: `${root}/dashboard/submit?process=${job.processID}&from=${id}` }, "Change inputs"),
    active ? null : download(call, `/jobs/${id}/bundle`, `${id}.zip`, "Bundle"),
    active ? null : download(call, `/jobs/${id}/bundle?format=ro-crate`, `${id}.crate.zip`, "RO-Crate"),
    copies(() => ({ id: job.processID, inputs: job.inputs })),
  ].filter(Boolean));
  const facts = [["Submitted", time(job.created)], ["Started", time(job.started)], ["Finished", time(job.finished)], ["Attempts", String(job.attempts)]];
  if (job.position) facts.push(["Place in the queue", String(job.position)]);
  if (job.starts_in_s) facts.push(["Starts in about", duration(job.starts_in_s)]);
  const parts = [];
  if (job.problem) parts.push(el("section", { class: "problem", role: "alert" }, el("h2", {}, job.problem.title ?? "Failed"), el("p", {}, ...coded(job.problem.detail ?? ""))));
  if (active) parts.push(el("div", { class: "line big" }, bar, percent, left), message, connection);
  if (job.reason) parts.push(el("p", { class: "note" }, ...coded(`Waits: ${job.reason}.`)));
  $("state").replaceChildren(...parts);
  $("course").replaceChildren(el("h2", {}, "Course of the job"), el("dl", {}, ...facts.map(([name, value]) => definition(name, value))), ...(log.childElementCount ? [log] : []));
  progress(job.progress, job.message, job.eta_s);
}

function progress(part, text, eta) {
  bar.value = part;
  percent.textContent = `${Math.floor(part)} %`;
  left.textContent = eta === null || eta === undefined ? "" : `about ${duration(eta)} left`;
  message.textContent = text ?? "";
}

/** The current job; an answer that arrives after a newer one is dropped. */
const show = newest(() => get(`/jobs/${id}`), (found) => { job = found; frame(); });

async function live() {
  loading($("state"));
  // The stream begins with what has been told already.
  log.replaceChildren();
  const over = new AbortController();
  try {
    await show();
    const waiting = setInterval(() => {
      // The stream below reports an unavailable service.
      if (job.status === "accepted") show().catch(() => null);
    }, 2000);
    if (job.links.some((link) => link.rel === "partial")) partials(over.signal);
    await follow(id, heard, (error) => { connection.textContent = error ? "The connection broke; trying again." : ""; }, over.signal).finally(() => {
      clearInterval(waiting);
      over.abort();
    });
    await show();
    if (job.status === "successful") await finished();
  } catch (error) {
    const unknown = error instanceof Problem && error.status === 404;
    fail($("state"), error, unknown ? null : live);
    if (unknown) $("state").append(el("p", {}, el("a", { href: `${root}/dashboard/jobs` }, "All jobs")));
  }
}

async function heard(kind, data) {
  if (kind === "progress") {
    progress(data.progress, data.message, data.eta_s);
    tell(data.at, `${Math.floor(data.progress)} %  ${data.message}`);
  } else if (kind === "log") tell(data.at, data.message);
  else if (kind === "status") {
    tell(data.at, [statusWord(data.status), data.message].filter(Boolean).join(": "));
    await show();
  }
}

async function finished() {
  verdict = verdictBadge(await results($("results"), job, await description(job.processID), call));
  title();
}

/** The partial results of a sharded process, one look after the other, until the job has ended. */
async function partials(signal) {
  while (!signal.aborted) {
    await new Promise((resolve) => setTimeout(resolve, LOOKS_MS));
    await partial(signal);
  }
}

async function partial(signal) {
  try {
    const { shards, outputs } = await get(`/jobs/${id}/partial`, { signal });
    const spec = await description(job.processID);
    if (signal.aborted || !outputs) return;
    const { head, pictures, parts, draws } = shown(known(spec, outputs, job.inputs));
    $("results").replaceChildren(el("h2", {}, `So far: ${shards.done} of ${shards.total} parts`), ...head, ...pictures, ...parts);
    for (const drawn of draws) await drawn();
  } catch {
    // Nothing yet, or the service is unavailable, which the stream reports.
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

async function repeat({ target }) {
  target.disabled = true;
  try {
    location.assign(`${root}/dashboard/jobs/${await again(job)}`);
  } catch (error) {
    fail($("tools"), error, () => location.reload());
  }
}

await live();
