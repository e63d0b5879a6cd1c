// Submit: any process, by a form made from its schema; light ones answer here, others become jobs.

import { estimateWords } from "../logic/estimate.js";
import { Store } from "../logic/store.js";
import { call, execute, get, plain, root } from "../parts/api.js";
import { copies } from "../parts/copies.js";
import { field, mark } from "../parts/form.js";
import { explain } from "../parts/glossary.js";
import { labelFields } from "../parts/labels.js";
import { $, el, fail, loading } from "../parts/page.js";
import { description } from "../parts/process.js";
import { firstScreen, known, rest, verdictBadge } from "../parts/results.js";
import { shown } from "../parts/views.js";
import { estimated, waiting } from "../parts/waiting.js";

const address = new URLSearchParams(location.search);
const isLight = (one) => one.jobControlOptions.includes("sync-execute");
let entry = null, labels = null;

// `entered` is the content of the form, `sent` the inputs of the run; the answer is shown while both are equal.
const store = new Store({ process: null, from: address.get("from"), preset: "", entered: null, sent: null });

store.panel({
  poses: ({ process, from, preset }) => process && { process, from, preset },
  asks: async ({ process, from, preset }, signal) => {
    const [spec, job] = await Promise.all([description(process), from ? get(`/jobs/${from}`, { signal }) : null]);
    // A new form opens as the example, which is quick; one of a preset or a job holds what that asks, and nothing else.
    return { spec, given: presets(spec)[preset] ?? job?.inputs ?? spec.example, preset, named: job ? { name: job.name, tags: job.tags, note: job.note } : {} };
  },
  shows: showForm,
});

// How long a run of the form's content would take.
store.panel({
  quiet: 400,
  poses: ({ process, entered }) => (process && entered !== null ? { process, inputs: JSON.parse(entered) } : null),
  asks: ({ process, inputs }, signal) => estimated(process, inputs, { signal }),
  // What is wrong with the inputs is told when they are sent.
  shows: ({ state, answer }) => { if ($("estimate")) $("estimate").textContent = state === "there" ? estimateWords(answer) : ""; },
});

store.panel({
  poses: ({ process, entered, sent }) => (sent !== null && sent === entered ? { process, inputs: JSON.parse(sent) } : null),
  asks: async ({ process, inputs }, signal) => ({ spec: await description(process), inputs, outputs: plain(await execute(process, inputs, { signal })) }),
  shows: showAnswer,
});

const command = copies(() => entry && { id: store.inputs.process, inputs: entry.value() }, store);

function showForm({ state, answer, error }) {
  entry = null;
  if (state === "failed") {
    fail($("form"), error, () => store.hasten());
    return;
  }
  if (state !== "there") {
    $("what").textContent = "";
    loading($("form"));
    return;
  }
  const { spec, given, preset, named } = answer, schema = whole(spec), light = isLight(spec);
  $("what").textContent = spec.description;
  entry = field(schema, schema, "", "", given);
  labels = labelFields(named);
  $("form").replaceChildren(...choices(spec, preset), entry.node, el("details", { class: "rare", open: !light }, el("summary", {}, `Name, tags and note${light ? " of a queued run" : ""}`), ...labels.nodes), el("div", { class: "tools" },
    el("button", { type: "submit" }, light ? "Run now" : "Submit"),
    light ? el("button", { type: "button", class: "plain", onclick: queue }, "Queue it") : null), el("p", { class: "note", id: "estimate", role: "status" }), command);
  explain($("form"));
  store.set({ entered: entered() });
}

/** Questions that a process describes by name. */
const presets = (spec) => spec["safestart:examples"] ?? {};

/** A menu of them, where there are any. */
function choices(spec, chosen) {
  const names = Object.keys(presets(spec));
  if (!names.length) return [];
  const menu = el("select", { id: "preset", onchange: ({ target }) => store.set({ preset: target.value, entered: null, sent: null }) },
    el("option", { value: "" }, "none: as in the fields"), ...names.map((name) => el("option", { value: name, selected: name === chosen }, name)));
  return [el("div", { class: "inline" }, el("label", { for: "preset" }, "Preset"), menu)];
}

/** One schema of all inputs, from the description's separate schemas. */
function whole({ inputs, example }) {
  const properties = {}, defs = {}, required = [];
  // Required fields come first.
  const order = Object.entries(inputs).sort(([, one], [, two]) => two.minOccurs - one.minOccurs);
  for (const [name, { schema, minOccurs, title, description: said }] of order) {
    const { $defs, ...own } = schema;
    Object.assign(defs, $defs);
    properties[name] = { title, description: said, ...own };
    if (minOccurs !== 0) required.push(name);
  }
  return { properties, required, $defs: defs, examples: example ? [example] : [] };
}

function showAnswer({ state, answer, error, question }) {
  const place = $("state");
  if (state === "failed") {
    fail(place, error, () => store.hasten());
    mark($("form"), error.document?.field, error.message);
  } else if (state === "asking") waiting(place, "Running", { id: question.process, inputs: question.inputs });
  else if (state === "none") place.replaceChildren();
  else {
    const result = known(answer.spec, answer.outputs, question.inputs), { head, pictures, parts, draws } = shown(result), [first, ...more] = pictures;
    place.replaceChildren(el("h2", { class: "answered" }, "Answer ", verdictBadge(result) ?? ""), firstScreen(result, head, first), ...more, ...parts, ...rest(result),
      el("details", {}, el("summary", {}, "The answer as JSON"), el("pre", { tabindex: "0" }, text(answer.outputs))));
    for (const drawn of draws) drawn();
    place.scrollIntoView({ block: "start" });
  }
}

function text(answer) {
  const all = JSON.stringify(answer, null, 1).replace(/\[\s+([-\d.e+,\s]+?)\s+\]/g, (_, numbers) => `[${numbers.replace(/\s+/g, " ")}]`);
  return all.length < 20000 ? all : `${all.slice(0, 20000)}\n… ${all.length} characters in all`;
}

const entered = () => (entry ? JSON.stringify(entry.value()) : null);

/** Make a job from the form. */
async function queue() {
  const buttons = $("form").querySelectorAll("button"), { process } = store.inputs;
  store.set({ sent: null });
  for (const button of buttons) button.disabled = true;
  loading($("state"), "Sending");
  try {
    const headers = { Prefer: "respond-async" };
    const { jobID } = await (await call(`/processes/${process}/execution`, { method: "POST", json: { inputs: entry.value(), ...labels.value() }, headers })).json();
    location.assign(`${root}/dashboard/jobs/${jobID}`);
  } catch (error) {
    for (const button of buttons) button.disabled = false;
    fail($("state"), error);
    mark($("form"), error.document?.field, error.message);
  }
}

$("process").addEventListener("change", ({ target }) => {
  history.replaceState(null, "", `?process=${target.value}`);
  $("state").replaceChildren();
  store.set({ process: target.value, from: null, preset: "", entered: null, sent: null });
});
for (const kind of ["input", "change"]) $("form").addEventListener(kind, () => store.set({ entered: entered() }));
$("form").addEventListener("submit", (event) => {
  event.preventDefault();
  if (!entry) return;
  if (!event.submitter || event.submitter.textContent === "Submit") {
    queue();
    return;
  }
  const now = entered();
  store.set({ entered: now, sent: now });
  store.hasten();
});

async function list() {
  try {
    const { processes } = await get("/processes");
    const order = [...processes].sort((a, b) => Number(isLight(a)) - Number(isLight(b)));
    $("process").replaceChildren(...order.map((one) => el("option", { value: one.id }, one.title)));
    const wanted = address.get("process");
    $("process").value = order.some((one) => one.id === wanted) ? wanted : order[0].id;
    store.set({ process: $("process").value });
  } catch (error) {
    fail($("state"), error, list);
  }
}
await list();
