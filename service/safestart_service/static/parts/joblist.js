// The list of jobs as a table, kept up to date without moving what has not changed.

import { sorted } from "../logic/paging.js";
import { inputWords } from "../logic/titles.js";
import { duration } from "../logic/words.js";
import { root } from "./api.js";
import { badge, coded, el, status, time } from "./page.js";

/** Columns with their names in `sort`; a falling one begins with its greatest. */
const COLUMNS = [["Run", "name"], ["Inputs"], ["Job", "status"], ["Outcome", "verdict"], ["Ran", "duration", true], ["Owner", "submitter"], ["Submitted", "created", true], [""]];
const MOST_INPUTS = 5;

/** The table; `acts` are `{ sort(order), choose(job, yes), all(yes), cancel(job), find(tag) }`. */
export function jobTable(acts) {
  const body = el("tbody"), every = el("input", { type: "checkbox", "aria-label": "choose all on this page", onchange: () => acts.all(every.checked) });
  const heads = COLUMNS.map(([title, column, falling = false]) => {
    if (!column) return title ? el("th", { scope: "col" }, title) : el("td");
    const head = el("th", { scope: "col", "data-sort": column }, el("button", { type: "button", class: "sort", onclick: () => acts.sort((now) => sorted(now, column, falling)) }, title));
    return head;
  });
  const node = el("div", { class: "scroll whole", tabindex: "0", role: "region", "aria-label": "Jobs" }, el("table", { class: "jobs" }, el("thead", {}, el("tr", {}, el("td", {}, every), ...heads)), body));
  return { node, fill: (jobs, state) => fill({ body, every, heads, acts }, jobs, state) };
}

function fill({ body, every, heads, acts }, jobs, { sort, chosen, own }) {
  for (const head of heads) {
    const { sort: column } = head.dataset;
    if (column) head.setAttribute("aria-sort", sort === column ? "ascending" : sort === `-${column}` ? "descending" : "none");
  }
  every.checked = jobs.length > 0 && jobs.every((job) => chosen.has(job.jobID));
  const old = new Map([...body.children].map((node) => [node.dataset.job, node]));
  const focused = document.activeElement?.closest?.(".jobs tbody > tr"), control = document.activeElement?.dataset?.control;
  const nodes = jobs.map((job) => {
    const now = JSON.stringify([job, own]), node = old.get(job.jobID);
    const kept = node?.dataset.shows === now ? node : row(job, own, acts);
    kept.querySelector('[data-control="choose"]').checked = chosen.has(job.jobID);
    kept.dataset.job = job.jobID;
    kept.dataset.shows = now;
    return kept;
  });
  // A node that is taken out and put back would lose the focus, so the ones that stay are not moved.
  for (const node of [...body.children]) if (!nodes.includes(node)) node.remove();
  nodes.forEach((node, k) => { if (body.children[k] !== node) body.insertBefore(node, body.children[k] ?? null); });
  if (focused && !focused.isConnected) nodes.find((node) => node.dataset.job === focused.dataset.job)?.querySelector(`[data-control="${control}"], [data-control]`)?.focus();
}

/** How long a job ran, or has been running. */
const ran = ({ started, finished }) => (started ? duration(((finished ? Date.parse(finished) : Date.now()) - Date.parse(started)) / 1000) : "–");

/** What to call a job in a sentence. */
export const called = (job) => job.name || `${job.processID} ${job.jobID.slice(0, 8)}`;

export function outcomeBadge(outcome) {
  if (outcome === null) return null;
  const many = outcome.of > 1 ? ` (${outcome.count} of ${outcome.of})` : "", claimed = outcome.basis === null ? "" : `, ${outcome.basis.replaceAll("_", " ")}, no proof`;
  return badge("verdict", `${outcome.word.replaceAll("_", " ")}${many}${claimed}`, outcome.sense);
}

function row(job, own, acts) {
  const box = el("input", { type: "checkbox", "data-control": "choose", "aria-label": `choose ${called(job)}`, onchange: () => acts.choose(job, box.checked) });
  const tags = job.tags.map((tag) => el("button", { type: "button", class: "tag", "data-control": `tag ${tag}`, onclick: () => acts.find(tag) }, tag));
  const below = el("div", { class: "line soft" }, job.name ? el("span", {}, job.processID) : null, el("code", {}, job.jobID.slice(0, 8)), ...tags);
  const inputs = Object.entries(job.key_inputs ?? {}), shown = inputs.slice(0, MOST_INPUTS).map(([path, value]) => inputWords(path, value)).join(" · ");
  const more = inputs.length > MOST_INPUTS ? ` and ${inputs.length - MOST_INPUTS} more` : "";
  const active = ["accepted", "running"].includes(job.status), says = [];
  if (job.status === "running") {
    says.push(el("div", { class: "line soft" }, el("progress", { max: 100, value: job.progress, "aria-label": "progress" }), el("span", { class: "percent" }, `${job.progress} %`),
      job.eta_s === null ? null : el("span", {}, `about ${duration(job.eta_s)} left`)));
  }
  if (job.reason) says.push(el("p", { class: "note" }, ...coded(`Waits: ${job.reason}.`)));
  else if (["running", "failed"].includes(job.status) && job.message) says.push(el("p", { class: "note" }, ...coded(job.message)));
  return el("tr", {}, el("td", {}, box),
    el("td", { class: "run" }, el("a", { "data-control": "open", href: `${root}/dashboard/jobs/${job.jobID}` }, job.name || job.processID), below, job.note ? el("p", { class: "note first-line", title: job.note }, job.note.split("\n")[0]) : null),
    el("td", { class: "inputs" }, inputs.length ? `${shown}${more}` : "–"),
    el("td", { class: "state" }, status(job), ...says), el("td", {}, outcomeBadge(job.outcome) ?? "–"), el("td", { class: "number" }, ran(job)),
    el("td", {}, job.submitter === null ? "–" : job.submitter === own ? "you" : el("code", {}, job.submitter)), el("td", {}, time(job.created)),
    el("td", {}, active && !job.dismissal_requested ? el("button", { type: "button", class: "danger", "data-control": "cancel", "aria-label": `cancel ${called(job)}`, onclick: () => acts.cancel(job) }, "Cancel") : null));
}
