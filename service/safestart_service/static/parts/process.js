// Process descriptions from the API, cached for the page; titles and colours of names in results.

import { get } from "./api.js";

const known = new Map();

/** The description of a process. */
export function description(id) {
  if (!known.has(id)) {
    const asked = get(`/processes/${id}`);
    asked.catch(() => known.delete(id));
    known.set(id, asked);
  }
  return known.get(id);
}

/** Views of one kind. */
export const viewsOf = (spec, kind) => spec["safestart:views"].filter((view) => view.kind === kind);

/** Titles and colours by name; `title(name)` is the name itself if it has no title. */
export function names(spec) {
  const engines = new Map((spec["safestart:engines"] ?? []).map((engine) => [engine.name, engine]));
  return { title: (name) => engines.get(name)?.title ?? name, colour: (name) => engines.get(name)?.colour };
}
