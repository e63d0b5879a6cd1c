// The address says what the fields hold: a reload, a bookmark and the way back lead to the same question.

/** Browsers drop changes of the address that follow each other faster (Chromium 200 in 10 s), or refuse them. */
const LEAST_MS = 150;
let waits = 0, next = null;

/** Write the address, at once or as soon as the browser takes it. */
export function writeAddress(address) {
  next = address;
  if (waits === 0) write();
}

function write() {
  waits = 0;
  if (next === null) return;
  history.replaceState(null, "", next);
  next = null;
  waits = setTimeout(write, LEAST_MS);
}

/** Call `use` with the address's query when the user goes to another entry of this page, as after a link into it. */
export function onMove(use) {
  addEventListener("popstate", () => {
    clearTimeout(waits);
    [waits, next] = [0, null];
    use(location.search);
  });
}
