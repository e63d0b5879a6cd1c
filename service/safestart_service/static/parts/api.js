// The public API from a page: JSON in, JSON out, and every refusal is a Problem.

export const root = document.documentElement.dataset.root ?? "";
const KEY = "safestart-key";

/** A refusal, from its problem document; status 0 when no answer came. */
export class Problem extends Error {
  constructor(status, document) {
    super(document.detail ?? document.title ?? "the service does not answer");
    this.status = status;
    this.document = document;
  }
}

export function useKey(key) {
  if (key) sessionStorage.setItem(KEY, key);
  else sessionStorage.removeItem(KEY);
}

export const hasKey = () => sessionStorage.getItem(KEY) !== null;

export async function call(path, options = {}) {
  const headers = new Headers(options.headers);
  const key = sessionStorage.getItem(KEY);
  if (key) headers.set("Authorization", `Bearer ${key}`);
  if (options.json !== undefined) headers.set("Content-Type", "application/json");
  const body = options.json === undefined ? undefined : JSON.stringify(options.json);
  const url = path.startsWith("http") || (root && path.startsWith(`${root}/`)) ? path : root + path;
  let response;
  try {
    // Without stored credentials, so that the page shows a refusal and no browser dialog asks for a password. Always asked
    // again: on the way back a browser takes what it has kept, although that may be old or was given to a forgotten key.
    response = await fetch(url, { ...options, headers, body, credentials: "omit", cache: "no-cache" });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem(0, { title: "No answer", detail: "the service does not answer; is it running?" });
  }
  if (response.ok) return response;
  let document = { title: response.statusText, detail: `the service answered ${response.status}` };
  try {
    document = await response.json();
  } catch {
    // A proxy's page instead of a problem document: only the status is known.
  }
  throw new Problem(response.status, document);
}

export const get = async (path, options) => (await call(path, options)).json();
export const post = async (path, json, options) => (await call(path, { ...options, method: "POST", json })).json();
export const remove = async (path) => (await call(path, { method: "DELETE" })).json();

/** Outputs of a light process, run at once. */
export const execute = (id, inputs, options) => post(`/processes/${id}/execution`, { inputs }, options);

/** Outputs of an instant answer, in which the standard wraps objects. */
export const plain = (outputs) => Object.fromEntries(Object.entries(outputs).map(([name, value]) => [name, value?.mediaType === "application/json" ? value.value : value]));

/** Events of a job, also across broken connections, until it has ended or `signal` aborts. */
export async function follow(job, onEvent, onBreak, signal) {
  let last = "";
  while (!signal.aborted) {
    try {
      const headers = last ? { "Last-Event-ID": last } : {};
      const response = await call(`/jobs/${job}/events`, { headers, signal });
      onBreak(null);
      if (response.status === 204) return;
      const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
      let text = "";
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        text += value;
        const blocks = text.split("\n\n");
        text = blocks.pop();
        for (const block of blocks) {
          const event = parse(block);
          if (event.id) last = event.id;
          if (event.data) await onEvent(event.event, JSON.parse(event.data));
        }
      }
      const now = await get(`/jobs/${job}`, { signal });
      if (!["accepted", "running"].includes(now.status)) return;
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof Problem && error.status >= 400 && error.status < 500 && error.status !== 429) throw error;
      onBreak(error);
    }
    await new Promise((resolve) => setTimeout(resolve, 1000));
  }
}

function parse(block) {
  const found = {};
  for (const line of block.split("\n")) {
    const at = line.indexOf(": ");
    if (at > 0) found[line.slice(0, at)] = line.slice(at + 2);
  }
  return found;
}
