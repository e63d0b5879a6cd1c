// Jobs: newest first, kept up to date while something waits or runs.

import { Store } from "../logic/store.js";
import { duration, moment } from "../logic/words.js";
import { get, remove, root } from "../parts/api.js";
import { $, el, fail, loading, status } from "../parts/page.js";

const asked = new URLSearchParams(location.search), chosen = new Set();
let timer = 0;

async function filters() {
  const { processes } = await get("/processes");
  $("process").append(...processes.map((one) => el("option", { value: one.id }, one.title)));
  $("process").value = asked.get("process") ?? "";
  $("status").value = asked.get("status") ?? "";
}

const store = new Store({ process: "", status: "", pages: 1 });
const list = store.panel({
  poses: (inputs) => inputs,
  asks: async ({ process, status: state, pages }, signal) => {
    const found = new URLSearchParams({ limit: 25 });
    if (process) found.append("processID", process);
    if (state) found.append("status", state);
    const jobs = [];
    let next = `/jobs?${found}`;
    for (let k = 0; k < pages && next; k++) {
      const page = await get(next, { signal });
      jobs.push(...page.jobs);
      next = page.links.find((link) => link.rel === "next")?.href ?? null;
    }
    return { jobs, more: next !== null };
  },
  shows: show,
});

function show({ state, answer, old, error }) {
  clearTimeout(timer);
  if (state === "failed") {
    fail($("list"), error, () => store.hasten());
    if (error.status === 0) timer = setTimeout(() => store.hasten(), 3000);
    return;
  }
  $("list").classList.toggle("old", old !== null);
  if (state !== "there") {
    if (old === null) loading($("list"));
    return;
  }
  const { jobs, more } = answer;
  $("older").hidden = !more;
  if (jobs.length) rows(jobs);
  else $("list").replaceChildren(el("p", { class: "empty" }, "No jobs here yet. ", el("a", { href: `${root}/dashboard/submit` }, "Submit one"), "."));
  const busy = jobs.some((job) => ["accepted", "running"].includes(job.status));
  timer = setTimeout(() => list.refresh(), busy ? 1500 : 8000);
}

/** The rows of the jobs: one that has not changed stays as it is, and one that has keeps the focus that was in it. */
function rows(jobs) {
  const place = $("list").querySelector(".jobs") ?? el("ul", { class: "jobs" });
  const old = new Map([...place.children].map((node) => [node.dataset.job, node]));
  const focused = document.activeElement?.closest?.(".jobs > li"), control = document.activeElement?.dataset?.control;
  const nodes = jobs.map((job) => {
    const now = JSON.stringify(job), node = old.get(job.jobID);
    if (node?.dataset.shows === now) return node;
    const made = row(job);
    made.dataset.job = job.jobID;
    made.dataset.shows = now;
    return made;
  });
  if (!place.isConnected) $("list").replaceChildren(place);
  // A node that is taken out and put back would lose the focus, so the ones that stay are not moved.
  for (const node of [...place.children]) if (!nodes.includes(node)) node.remove();
  nodes.forEach((node, k) => { if (place.children[k] !== node) place.insertBefore(node, place.children[k] ?? null); });
  if (focused && !focused.isConnected) nodes.find((node) => node.dataset.job === focused.dataset.job)?.querySelector(`[data-control="${control}"], [data-control]`)?.focus();
}

/** How long an ended job ran. */
const took = ({ started, finished }) => (started && finished ? el("span", { class: "took" }, `ran ${duration((Date.parse(finished) - Date.parse(started)) / 1000)}`) : null);

function row(job) {
  const name = el("a", { "data-control": "open", href: `${root}/dashboard/jobs/${job.jobID}` }, job.processID);
  const box = el("input", { type: "checkbox", "data-control": "choose", "aria-label": `choose ${job.processID} ${job.jobID.slice(0, 8)}` });
  box.checked = chosen.has(job.jobID);
  box.addEventListener("change", () => {
    chosen[box.checked ? "add" : "delete"](job.jobID);
    $("compare").disabled = chosen.size < 2;
  });
  const line = el("div", { class: "line" }, job.status === "successful" ? box : el("span", { class: "no-box" }),
    name, el("code", {}, job.jobID.slice(0, 8)), status(job), took(job), el("time", {}, moment(job.created)));
  const below = [];
  if (job.status === "running") {
    below.push(el("div", { class: "line" }, el("progress", { max: 100, value: job.progress, "aria-label": "progress" }),
      el("span", { class: "percent" }, `${job.progress} %`), job.eta_s === null ? null : el("span", {}, `about ${duration(job.eta_s)} left`)));
  }
  if (job.reason) below.push(el("p", { class: "note" }, `Waits: ${job.reason}.`));
  else if (["running", "failed"].includes(job.status) && job.message) below.push(el("p", { class: "note" }, job.message));
  if (["accepted", "running"].includes(job.status) && !job.dismissal_requested) {
    line.append(el("button", { type: "button", class: "danger", "data-control": "cancel", onclick: () => cancel(job.jobID) }, "Cancel"));
  }
  return el("li", {}, line, ...below);
}

async function cancel(job) {
  try {
    await remove(`/jobs/${job}`);
    list.refresh();
  } catch (error) {
    fail($("list"), error, () => list.refresh());
  }
}

function filter() {
  const now = { process: $("process").value, status: $("status").value };
  history.replaceState(null, "", `?${new URLSearchParams(now)}`);
  store.set({ ...now, pages: 1 });
}

for (const id of ["process", "status"]) $(id).addEventListener("change", filter);
$("older").addEventListener("click", () => store.set({ pages: store.inputs.pages + 1 }));
$("compare").addEventListener("click", () => location.assign(`${root}/dashboard/compare?jobs=${[...chosen].join(",")}`));
loading($("list"));
try {
  await filters();
  store.set({ process: $("process").value, status: $("status").value });
} catch (error) {
  fail($("list"), error, () => location.reload());
}
