// Fields of a page as texts: which of them are numbers, and the address that holds them.

/** Texts that an HTML number field accepts; any other text would be in the address but not in the field. */
export const NUMBER = /^-?(\d+(\.\d+)?|\.\d+)(e[+-]?\d+)?$/i;

/** Values of texts by the fields, and what is wrong by field; `words` are the choices of a select. */
export function valuesOf(fields, texts) {
  const values = {}, wrong = {};
  for (const [name, { words }] of Object.entries(fields)) {
    const text = texts[name].trim(), number = NUMBER.test(text) && Number.isFinite(Number(text));
    values[name] = words ? text : number ? Number(text) : null;
    if (words && !words.includes(text)) wrong[name] = `one of ${words.join(", ")} is required, not ${text || "nothing"}`;
    else if (!words && !number) wrong[name] = `a number is required, not ${text || "nothing"}`;
  }
  return { values, wrong };
}

/** Texts for the fields from an address; `unknown` are its names without a field. */
export function textsFrom(fields, search) {
  const texts = Object.fromEntries(Object.entries(fields).map(([name, { first }]) => [name, first])), unknown = [];
  for (const [name, text] of new URLSearchParams(search)) {
    if (name in fields) texts[name] = text;
    else unknown.push(name);
  }
  return { texts, unknown };
}

/** The address that gives these texts; it leaves initial texts out. */
export function addressOf(fields, texts) {
  const told = new URLSearchParams(Object.entries(texts).filter(([name, text]) => name in fields && text !== fields[name].first));
  return told.size ? `?${told}` : "";
}
