// Name, tags and note of a job: their fields, and how they are told.

import { call, root } from "./api.js";
import { el } from "./page.js";

/** Tags out of a text: separated by commas, each once. */
export const tagsOf = (text) => [...new Set(text.split(",").map((tag) => tag.trim()).filter(Boolean))];

/** Three fields: `{ nodes, value() }`. */
export function labelFields({ name = "", tags = [], note = "" } = {}) {
  const title = el("input", { type: "text", id: "label-name", maxlength: 100, "data-path": "name" });
  const words = el("input", { type: "text", id: "label-tags", "data-path": "tags", "aria-describedby": "label-tags-said" });
  const text = el("textarea", { rows: 2, id: "label-note", maxlength: 2000, "data-path": "note" });
  title.value = name;
  words.value = tags.join(", ");
  text.value = note;
  const dial = (control, label, said) => el("div", { class: "dial" }, el("label", { for: control.id }, label), control, said ? el("p", { class: "note", id: `${control.id}-said` }, said) : null);
  return {
    nodes: [dial(title, "Name"), dial(words, "Tags", "Words to find it by, separated by commas."), dial(text, "Note")],
    value: () => ({ name: title.value, tags: tagsOf(words.value), note: text.value }),
  };
}

/** Name, tags and note of a job as it stands, and a button that opens their fields; `done(job)` gets the changed job. */
export function labelled(job, failed, done) {
  const tags = job.tags.map((tag) => el("a", { class: "tag", href: `${root}/dashboard/jobs?${new URLSearchParams({ search: `#${tag}` })}` }, tag));
  const place = el("section", { class: "labels on-paper", "aria-label": "Name, tags and note" });
  const open = el("button", { type: "button", class: "plain on-screen", id: "label" }, job.name || job.tags.length || job.note ? "Change name, tags, note" : "Name it, tag it, write a note");
  const note = job.note ? el("p", { class: "note written" }, job.note) : null;
  open.addEventListener("click", () => {
    const { nodes, value } = labelFields(job), form = el("form", { class: "card form", autocomplete: "off" }, ...nodes,
      el("div", { class: "tools" }, el("button", { type: "submit" }, "Save"), el("button", { type: "button", class: "plain", onclick: () => place.replaceWith(labelled(job, failed, done)) }, "Leave as it is")));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        done(await (await call(`/jobs/${job.jobID}`, { method: "PATCH", json: value() })).json());
      } catch (error) {
        const said = el("div");
        form.append(said);
        failed(said, error);
      }
    });
    place.replaceChildren(form);
    form.querySelector("input").focus();
  });
  place.append(...[el("div", { class: "line" }, ...tags, open), note].filter(Boolean));
  return place;
}
