// Jobs: newest first, kept up to date while something waits or runs.

import { get, remove, root } from "../parts/api.js";
import { duration, moment } from "../logic/words.js";
import { $, el, fail, loading, status } from "../parts/page.js";

const asked = new URLSearchParams(location.search), chosen = new Set();
let pages = 1, timer = 0;

async function filters() {
  const { processes } = await get("/processes");
  $("process").append(...processes.map((one) => el("option", { value: one.id }, one.title)));
  $("process").value = asked.get("process") ?? "";
  $("status").value = asked.get("status") ?? "";
}

async function show() {
  clearTimeout(timer);
  try {
    const found = new URLSearchParams({ limit: 25 });
    if ($("process").value) found.append("processID", $("process").value);
    if ($("status").value) found.append("status", $("status").value);
    const jobs = [];
    let next = `/jobs?${found}`;
    for (let k = 0; k < pages && next; k++) {
      const page = await get(next);
      jobs.push(...page.jobs);
      next = page.links.find((link) => link.rel === "next")?.href ?? null;
    }
    $("older").hidden = !next;
    $("list").replaceChildren(jobs.length ? el("ul", { class: "jobs" }, ...jobs.map(row)) : el("p", { class: "empty" },
      "No jobs here yet. ", el("a", { href: `${root}/dashboard/submit` }, "Submit one"), "."));
    const busy = jobs.some((job) => ["accepted", "running"].includes(job.status));
    timer = setTimeout(show, busy ? 1500 : 8000);
  } catch (error) {
    fail($("list"), error, show);
    if (error.status === 0) timer = setTimeout(show, 3000);
  }
}

function row(job) {
  const name = el("a", { href: `${root}/dashboard/jobs/${job.jobID}` }, job.processID);
  const box = el("input", { type: "checkbox", "aria-label": `choose ${job.processID} ${job.jobID.slice(0, 8)}` });
  box.checked = chosen.has(job.jobID);
  box.addEventListener("change", () => {
    chosen[box.checked ? "add" : "delete"](job.jobID);
    $("compare").disabled = chosen.size < 2;
  });
  const comparable = job.processID === "benchmark" && job.status === "successful";
  const line = el("div", { class: "line" }, comparable ? box : null, name, el("code", {}, job.jobID.slice(0, 8)), status(job), el("time", {}, moment(job.created)));
  const below = [];
  if (job.status === "running") {
    below.push(el("div", { class: "line" }, el("progress", { max: 100, value: job.progress, "aria-label": "progress" }),
      el("span", { class: "percent" }, `${job.progress} %`), job.eta_s === null ? null : el("span", {}, `about ${duration(job.eta_s)} left`)));
  }
  if (job.reason) below.push(el("p", { class: "note" }, `Waits: ${job.reason}.`));
  else if (["running", "failed"].includes(job.status) && job.message) below.push(el("p", { class: "note" }, job.message));
  if (["accepted", "running"].includes(job.status) && !job.dismissal_requested) {
    line.append(el("button", { type: "button", class: "danger", onclick: () => cancel(job.jobID) }, "Cancel"));
  }
  return el("li", {}, line, ...below);
}

async function cancel(job) {
  try {
    await remove(`/jobs/${job}`);
  } catch (error) {
    fail($("list"), error, show);
    return;
  }
  show();
}

for (const id of ["process", "status"]) {
  $(id).addEventListener("change", () => {
    pages = 1;
    history.replaceState(null, "", `?${new URLSearchParams({ process: $("process").value, status: $("status").value })}`);
    show();
  });
}
$("older").addEventListener("click", () => { pages += 1; show(); });
$("compare").addEventListener("click", () => location.assign(`${root}/dashboard/compare?jobs=${[...chosen].join(",")}`));
loading($("list"));
try {
  await filters();
  await show();
} catch (error) {
  fail($("list"), error, () => location.reload());
}
