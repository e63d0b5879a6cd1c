// Put into a page before its own scripts: while `faults.on`, its requests are late, fail, or are answered although
// they were given up. The same seed gives the same faults in the order of the requests.
window.faults = { on: false, seed: 1, delay: 0, failing: 0, deaf: 0, waiting: 0, abandoned: 0 };
{
  const { faults } = window, real = window.fetch.bind(window);
  const random = () => {
    faults.seed = (Math.imul(faults.seed, 1664525) + 1013904223) >>> 0;
    return faults.seed / 2 ** 32;
  };
  const late = () => new Promise((resolve) => setTimeout(resolve, faults.delay * random()));
  window.fetch = async (where, options = {}) => {
    const { signal, ...rest } = options;
    signal?.addEventListener("abort", () => { faults.abandoned += 1; });
    if (!faults.on) return real(where, options);
    const deaf = random() < faults.deaf, fails = random() < faults.failing;
    faults.waiting += 1;
    try {
      await late();
      if (!deaf) signal?.throwIfAborted();
      if (fails && random() < 0.5) throw new TypeError("Failed to fetch");
      if (fails) return Response.json({ title: "Overloaded", detail: "made by the test" }, { status: 503 });
      const answer = await real(where, deaf ? rest : options);
      await late();
      return answer;
    } finally {
      faults.waiting -= 1;
    }
  };
}
