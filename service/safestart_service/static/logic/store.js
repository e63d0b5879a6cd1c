// The state of a page: its inputs in one place, and panels that show the answers to the inputs' questions.

/** Longest time (ms) for which an old answer stays visible, greyed, while the next one is awaited. */
export const OLD_MS = 1000;

/** A question as text, independent of the order of its keys. */
export const digest = (question) => JSON.stringify(question, (_, value) => (value && typeof value === "object" && !Array.isArray(value)
  ? Object.fromEntries(Object.entries(value).sort(([one], [two]) => (one < two ? -1 : 1))) : value));

/**
 * One panel. `poses(inputs)` gives its question, or null without one; `asks(question, signal)` fetches the answer;
 * `shows(panel)` draws the panel after each change. `state` is "none", "asking", "there" or "failed"; `answer` exists
 * only while "there", `old` (the previous answer) only while "asking", `error` only while "failed". A request waits
 * until the inputs have not changed for `quiet` ms.
 */
class Panel {
  #parts;
  #turn = null;
  #begins = 0;
  #waits = false;
  #fades = 0;
  state = "none";
  question = null;
  digest; // undefined until the first question, so that even "no question" counts as a change
  answer = null;
  old = null;
  error = null;

  constructor(parts) {
    this.#parts = { quiet: 0, ...parts };
  }

  /** Take the current inputs; true if the question has changed, so that the shown answer is old. */
  pose(inputs) {
    const question = this.#parts.poses(inputs);
    const next = question === null ? null : digest(question);
    if (next === this.digest) return false;
    this.#ask(question, next);
    return true;
  }

  /** Ask the same again and show the answer until the next one arrives, for answers that change with time. */
  refresh() {
    if (this.state !== "there") return;
    this.#turn?.abort();
    this.#turn = new AbortController();
    this.#fetch(this.#turn);
  }

  /** Ask the same again after a failure. */
  retry() {
    if (this.state !== "failed") return;
    this.#ask(this.question, this.digest);
    this.show();
  }

  /** Send a waiting request at once. */
  hasten() {
    if (!this.#waits) return;
    clearTimeout(this.#begins);
    this.#fetch(this.#turn);
  }

  show() {
    this.#parts.shows(this);
  }

  #ask(question, next) {
    this.#turn?.abort();
    clearTimeout(this.#begins);
    this.#waits = false;
    const old = this.answer;
    Object.assign(this, { question, digest: next, answer: null, error: null });
    if (question === null) return this.#rest("none", {});
    const turn = new AbortController();
    this.#turn = turn;
    this.state = "asking";
    this.#waits = true;
    this.#begins = setTimeout(() => this.#fetch(turn), this.#parts.quiet);
    if (old === null) return undefined;
    this.old = old;
    this.#fades = setTimeout(() => { this.old = null; this.show(); }, OLD_MS);
    return undefined;
  }

  async #fetch(turn) {
    let found;
    this.#waits = false;
    try {
      found = ["there", { answer: await this.#parts.asks(this.question, turn.signal) }];
    } catch (error) {
      found = ["failed", { error }];
    }
    // The answer to an abandoned question comes too late, even if its request succeeded.
    if (turn !== this.#turn) return;
    this.#rest(...found);
    this.show();
  }

  #rest(state, { answer = null, error = null }) {
    clearTimeout(this.#fades);
    this.#turn = null;
    Object.assign(this, { state, answer, error, old: null });
  }
}

/** The inputs of a page and its panels. Only `set` changes an input. */
export class Store {
  #panels = [];

  constructor(inputs) {
    this.inputs = Object.freeze({ ...inputs });
  }

  /** Add a panel; the next `set` gives it its first question. */
  panel(parts) {
    const panel = new Panel(parts);
    this.#panels.push(panel);
    return panel;
  }

  /** Change inputs. Before this returns, every answer to another question is marked as old or removed. */
  set(change = {}) {
    this.inputs = Object.freeze({ ...this.inputs, ...change });
    const changed = this.#panels.filter((panel) => panel.pose(this.inputs));
    for (const panel of changed) panel.show();
  }

  /** Send waiting requests at once, and failed ones again. */
  hasten() {
    for (const panel of this.#panels) {
      panel.retry();
      panel.hasten();
    }
  }
}

/** Call `work`, then `use` its answer, unless a newer answer has been used already. */
export function newest(work, use) {
  let asked = 0, used = 0;
  return async (...given) => {
    const mine = ++asked, answer = await work(...given);
    if (mine < used) return;
    used = mine;
    use(answer);
  };
}
