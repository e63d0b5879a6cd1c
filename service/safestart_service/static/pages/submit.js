// Submit: any process by a form made from its schema; light ones answer here, the others become jobs.

import { call, get, root } from "../parts/api.js";
import { field, mark } from "../parts/form.js";
import { $, el, fail, loading } from "../parts/page.js";

const asked = new URLSearchParams(location.search);
let entry = null, spec = null;

async function list() {
  try {
    const { processes } = await get("/processes");
    const order = [...processes].sort((a, b) => Number(isLight(a)) - Number(isLight(b)));
    $("process").replaceChildren(...order.map((one) => el("option", { value: one.id }, one.title)));
    $("process").value = order.some((one) => one.id === asked.get("process")) ? asked.get("process") : "benchmark";
    await choose();
  } catch (error) {
    fail($("state"), error, list);
  }
}

const isLight = (one) => one.jobControlOptions.includes("sync-execute");

async function choose() {
  const id = $("process").value;
  history.replaceState(null, "", `?process=${id}${asked.has("from") ? `&from=${asked.get("from")}` : ""}`);
  loading($("form"));
  $("state").replaceChildren();
  try {
    spec = await get(`/processes/${id}`);
    const given = asked.has("from") ? (await get(`/jobs/${asked.get("from")}`)).inputs : undefined;
    asked.delete("from");
    $("what").textContent = spec.description;
    const schema = whole(spec);
    entry = field(schema, schema, "", "", given);
    $("form").replaceChildren(entry.node, el("div", { class: "tools" },
      el("button", { type: "submit" }, isLight(spec) ? "Run now" : "Submit"),
      isLight(spec) ? el("button", { type: "button", class: "plain", onclick: () => send(true) }, "Queue it") : null));
  } catch (error) {
    fail($("form"), error, choose);
  }
}

/** One schema of all inputs, from the description's separate ones. */
function whole({ inputs, example }) {
  const properties = {}, defs = {}, required = [];
  for (const [name, { schema, minOccurs, title, description }] of Object.entries(inputs)) {
    const { $defs, ...rest } = schema;
    Object.assign(defs, $defs);
    properties[name] = { title, description, ...rest };
    if (minOccurs !== 0) required.push(name);
  }
  return { properties, required, $defs: defs, examples: example ? [example] : [] };
}

async function send(queue) {
  const state = $("state");
  try {
    const headers = queue ? { Prefer: "respond-async" } : {};
    loading(state, "Sending");
    const response = await call(`/processes/${spec.id}/execution`, { method: "POST", json: { inputs: entry.value() }, headers });
    const answer = await response.json();
    if (response.status === 201) location.assign(`${root}/dashboard/jobs/${answer.jobID}`);
    else state.replaceChildren(el("h2", {}, "Answer"), el("pre", { tabindex: "0" }, shown(answer)));
  } catch (error) {
    fail(state, error);
    mark($("form"), error.document?.field);
  }
}

function shown(answer) {
  const text = JSON.stringify(answer, null, 1).replace(/\[\s+([-\d.e+,\s]+?)\s+\]/g, (_, numbers) => `[${numbers.replace(/\s+/g, " ")}]`);
  return text.length < 20000 ? text : `${text.slice(0, 20000)}\n… ${text.length} characters in all`;
}

$("process").addEventListener("change", choose);
$("form").addEventListener("submit", (event) => { event.preventDefault(); send(false); });
await list();
