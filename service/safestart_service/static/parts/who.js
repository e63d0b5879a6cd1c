// The header's right end: who asks, with which role, and the key to change or forget.

import { get, hasKey, useKey } from "./api.js";
import { $, el, keyForm } from "./page.js";

const MAY = { read: "may read", submit: "may submit", admin: "may administer" };

const button = (text, onclick) => el("button", { type: "button", class: "plain", onclick }, text);

function change() {
  const old = [...$("who").childNodes], form = keyForm("header-key", "New key");
  form.append(button("Keep the old one", () => $("who").replaceChildren(...old)));
  $("who").replaceChildren(form);
  form.querySelector("input").focus();
}

function forget() {
  useKey(null);
  location.reload();
}

async function show() {
  try {
    const { key_id: id, name, role } = await get("/caller");
    if (id === null) $("who").replaceChildren(el("span", { class: "who" }, `no key needed · ${MAY[role]}`));
    else {
      $("who").replaceChildren(el("span", { class: "who" }, el("b", {}, name), ` · ${MAY[role]}`), button("Change key", change), button("Forget key", forget));
    }
  } catch (error) {
    // Without an accepted key the page itself asks for one.
    if (error.status === 401 && hasKey()) $("who").replaceChildren(el("span", { class: "who" }, "key not accepted"), button("Forget key", forget));
  }
}

show();
