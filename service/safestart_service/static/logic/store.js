// The state of a page: its inputs in one place, and panels that show the answer to the question these inputs pose.

/** For how long an answer that has become old may stay in sight, greyed, until the next one is there (ms). */
export const OLD_MS = 1000;

/** A question as text: the same for the same question, whatever the order of its keys. */
export const digest = (question) => JSON.stringify(question, (_, value) => (value && typeof value === "object" && !Array.isArray(value)
  ? Object.fromEntries(Object.entries(value).sort(([one], [two]) => (one < two ? -1 : 1))) : value));

/**
 * One panel. `poses(inputs)` gives its question, null when the inputs pose none; `asks(question, signal)` gets the
 * answer; `shows(panel)` draws what the panel holds after each change: `state` is "none", "asking", "there" or
 * "failed"; `answer` is there only while "there", `old` (the answer before) only while "asking", `error` only while
 * "failed". Before anything is asked the inputs must have rested for `quiet` ms.
 */
class Panel {
  #parts;
  #turn = null;
  #begins = 0;
  #waits = false;
  #fades = 0;
  state = "none";
  question = null;
  digest; // undefined until the first question: to pose none is news, too
  answer = null;
  old = null;
  error = null;

  constructor(parts) {
    this.#parts = { quiet: 0, ...parts };
  }

  /** Take the inputs as they are now; true when they pose another question, and what was shown is no answer to it. */
  pose(inputs) {
    const question = this.#parts.poses(inputs);
    const next = question === null ? null : digest(question);
    if (next === this.digest) return false;
    this.#ask(question, next);
    return true;
  }

  /** Ask the same again, and show the answer until the next one is there: for what changes with time. */
  refresh() {
    if (this.state !== "there") return;
    this.#turn?.abort();
    this.#turn = new AbortController();
    this.#fetch(this.#turn);
  }

  /** Ask the same again, where it failed. */
  retry() {
    if (this.state !== "failed") return;
    this.#ask(this.question, this.digest);
    this.show();
  }

  /** Ask at once what still waits for the inputs to rest. */
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
    // The answer to a question that is no longer posed comes too late, whatever became of its request.
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

/** The inputs of a page and its panels. There is one way to change an input, and that is `set`. */
export class Store {
  #panels = [];

  constructor(inputs) {
    this.inputs = Object.freeze({ ...inputs });
  }

  /** Add a panel; it is posed its first question by the next `set`. */
  panel(parts) {
    const panel = new Panel(parts);
    this.#panels.push(panel);
    return panel;
  }

  /** Change inputs. Before this returns, every answer to another question is marked old or withdrawn. */
  set(change = {}) {
    this.inputs = Object.freeze({ ...this.inputs, ...change });
    const changed = this.#panels.filter((panel) => panel.pose(this.inputs));
    for (const panel of changed) panel.show();
  }

  /** Ask at once, and again what failed. */
  hasten() {
    for (const panel of this.#panels) {
      panel.retry();
      panel.hasten();
    }
  }
}

/** `work` with arguments, and `use` of its answer, unless a newer one has been used already. */
export function newest(work, use) {
  let asked = 0, used = 0;
  return async (...given) => {
    const mine = ++asked, answer = await work(...given);
    if (mine < used) return;
    used = mine;
    use(answer);
  };
}
