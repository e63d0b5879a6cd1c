// Jobs: filtered, sorted, a page at a time, kept up to date while something waits or runs.

import { counted, fromAddress, pagesOf, PER_PAGE, request, toAddress } from "../logic/paging.js";
import { Store } from "../logic/store.js";
import { onMove, writeAddress } from "../parts/address.js";
import { get, root } from "../parts/api.js";
import { bulk, FOR } from "../parts/bulk.js";
import { called, jobTable } from "../parts/joblist.js";
import { $, el, fail, loading } from "../parts/page.js";

const FIELDS = ["search", "process", "status", "verdict"], chosen = new Map();
let timer = 0, own = null, sure = false;

const store = new Store(fromAddress(""));
const table = jobTable({
  sort: (next) => change({ sort: next(store.inputs.sort), page: 1 }),
  choose(job, yes) {
    if (yes) chosen.set(job.jobID, job);
    else chosen.delete(job.jobID);
    choice();
  },
  all(yes) {
    for (const job of list.answer?.jobs ?? []) this.choose(job, yes);
    if (list.state === "there") show(list);
  },
  cancel: (job) => act("cancel", [job]),
  find: (tag) => change({ search: `#${tag}`, page: 1 }),
});
const list = store.panel({
  quiet: 150,
  poses: (inputs) => inputs,
  asks: (inputs, signal) => get(request(inputs), { signal }),
  shows: show,
});

function show({ state, answer, old, error }) {
  clearTimeout(timer);
  $("list").classList.toggle("old", old !== null);
  if (state === "failed") {
    $("pages").hidden = true;
    fail($("list"), error, () => store.hasten());
    if (error.status === 0) timer = setTimeout(() => store.hasten(), 3000);
    return;
  }
  if (state !== "there") {
    if (old === null) loading($("list"));
    return;
  }
  const { jobs, total } = answer, { page, sort } = store.inputs, pages = pagesOf(total);
  if (page > pages) {
    change({ page: pages });
    return;
  }
  // Chosen ones are known as they are now, to offer only what can be done to them.
  for (const job of jobs) if (chosen.has(job.jobID)) chosen.set(job.jobID, job);
  choice();
  const filtered = FIELDS.some((name) => store.inputs[name]);
  $("total").textContent = `${counted(total)} ${total === 1 ? "job" : "jobs"}${filtered ? " found" : ""}`;
  $("pages").hidden = pages === 1;
  $("place").textContent = `${counted((page - 1) * PER_PAGE + 1)}–${counted(Math.min(page * PER_PAGE, total))} of ${counted(total)}`;
  for (const id of ["first", "newer"]) $(id).disabled = page === 1;
  for (const id of ["older", "last"]) $(id).disabled = page === pages;
  if (jobs.length) {
    if (!table.node.isConnected) $("list").replaceChildren(table.node);
    table.fill(jobs, { sort, chosen, own });
  } else {
    $("list").replaceChildren(el("p", { class: "empty" }, filtered ? "No job is like that. " : "No jobs here yet. ",
      filtered ? el("button", { type: "button", class: "plain", onclick: () => change({ search: "", process: "", status: "", verdict: "", page: 1 }) }, "Show all") : el("a", { href: `${root}/dashboard/submit` }, "Submit one")));
  }
  const busy = jobs.some((job) => ["accepted", "running"].includes(job.status));
  timer = setTimeout(() => list.refresh(), busy ? 1500 : 8000);
}

/** Change what the list shows; the address and the fields say it too. */
function change(inputs) {
  store.set(inputs);
  writeAddress(`${location.pathname}${toAddress(store.inputs)}`);
  for (const name of FIELDS) if ($(name).value !== store.inputs[name]) $(name).value = store.inputs[name];
}

// ---- the chosen jobs

/** What can be done to the chosen jobs, and to how many of them. */
function choice() {
  const jobs = [...chosen.values()], number = (kind) => jobs.filter(FOR[kind]).length;
  sure = false;
  $("chosen").textContent = jobs.length ? `${counted(jobs.length)} chosen` : "none chosen";
  $("none").disabled = !jobs.length;
  $("compare").disabled = jobs.filter(({ status }) => status === "successful").length < 2;
  for (const [kind, word] of [["again", "Run again"], ["cancel", "Cancel"]]) {
    $(kind).disabled = number(kind) === 0;
    $(kind).textContent = number(kind) > 0 && number(kind) < jobs.length ? `${word} ${number(kind)} of them` : word;
  }
}

async function act(kind, jobs) {
  const buttons = [...$("bulk").querySelectorAll("button")];
  for (const button of buttons) button.disabled = true;
  const { text, refusal } = await bulk(kind, jobs, (done, of) => { if (of > 1) $("said").textContent = `${done} of ${of} …`; });
  const told = jobs.length === 1 ? `${called(jobs[0])}: ${text}` : text;
  if (refusal) fail($("said"), refusal);
  else $("said").replaceChildren();
  if (refusal || jobs.length > 1) $("said").append(el("p", { class: "note" }, told));
  choice();
  list.refresh();
}

for (const id of ["process", "status", "verdict"]) $(id).addEventListener("change", () => change({ [id]: $(id).value, page: 1 }));
$("search").addEventListener("input", () => change({ search: $("search").value, page: 1 }));
$("filter").addEventListener("submit", (event) => { event.preventDefault(); store.hasten(); });
for (const [id, next] of [["first", () => 1], ["newer", (page) => page - 1], ["older", (page) => page + 1], ["last", () => pagesOf(list.answer.total)]]) {
  $(id).addEventListener("click", () => { if (list.answer) change({ page: next(store.inputs.page) }); });
}
$("compare").addEventListener("click", () => {
  const ids = [...chosen.values()].filter(({ status }) => status === "successful").map(({ jobID }) => jobID);
  location.assign(`${root}/dashboard/compare?jobs=${ids.join(",")}`);
});
$("again").addEventListener("click", () => act("again", [...chosen.values()].filter(FOR.again)));
$("cancel").addEventListener("click", () => {
  const jobs = [...chosen.values()].filter(FOR.cancel);
  // Several at once are asked for twice: what has run is lost.
  if (jobs.length > 1 && !sure) {
    sure = true;
    $("cancel").textContent = `Really cancel ${jobs.length} jobs`;
  } else act("cancel", jobs);
});
$("none").addEventListener("click", () => {
  chosen.clear();
  if (list.state === "there") show(list);
  else choice();
});

loading($("list"));
try {
  const [{ processes }, caller] = await Promise.all([get("/processes"), get("/caller")]);
  own = caller.key_id;
  $("process").append(...processes.map((one) => el("option", { value: one.id }, one.title)));
  change(fromAddress(location.search));
  onMove((search) => change(fromAddress(search)));
} catch (error) {
  fail($("list"), error, () => location.reload());
}
