// What a JSON schema says of a field: its own type behind references and alternatives, its bounds, the values typed into it.

const at = (whole, reference) => reference.slice(2).split("/").reduce((part, key) => part[key], whole);
const isNull = (schema) => schema.type === "null" || (schema.enum?.length === 1 && schema.enum[0] === null);

/** The schema behind references and alternatives; `optional` where null is one of them. */
export function resolve(schema, whole) {
  let found = schema;
  for (let k = 0; k < 9; k++) {
    if (found.$ref) found = { ...at(whole, found.$ref), ...found, $ref: undefined };
    else if (found.allOf?.length === 1) found = { ...found.allOf[0], ...found, allOf: undefined };
    else if (found.anyOf) {
      const some = found.anyOf.filter((one) => !isNull(one));
      if (some.length !== 1) return found;
      found = { ...some[0], ...found, anyOf: undefined, optional: some.length < found.anyOf.length };
    } else break;
  }
  return found;
}

/** A bound as people write it. The service writes "more than" as the next number a computer has: 5e-324 is more than 0. */
function bound(value, sign, strict) {
  if (Math.abs(value) < 1e-300) return value === 0 ? `${sign} 0` : `${strict} 0`;
  const plain = Number(value.toPrecision(12));
  return Math.abs(plain - value) > 1e-15 * Math.abs(value) || plain === value ? `${sign} ${value}` : `${strict} ${plain}`;
}

/** Bounds of a number or list in words, "" without. */
export function bounds({ minimum, maximum, exclusiveMinimum, maxItems, multipleOf }) {
  const said = [];
  if (typeof exclusiveMinimum === "number") said.push(`> ${exclusiveMinimum}`);
  if (minimum !== undefined) said.push(bound(minimum, "≥", ">"));
  if (maximum !== undefined) said.push(bound(maximum, "≤", "<"));
  if (multipleOf !== undefined) said.push(`a multiple of ${multipleOf}`);
  if (maxItems !== undefined) said.push(`at most ${maxItems}`);
  return said.length ? `(${said.join(", ")})` : "";
}

/** Numbers separated by commas; what is none stays text, so that the service refuses it by name. Undefined for nothing. */
export const numbers = (text) => (text.trim() === "" ? undefined
  : text.split(",").map((part) => (part.trim() !== "" && Number.isFinite(Number(part)) ? Number(part) : part.trim())));

/** JSON, or the text itself where it is none; undefined for nothing. */
export function parsed(text) {
  if (text.trim() === "") return undefined;
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** An object of entries [name, value] without the undefined ones; undefined where nothing is left and nothing need be. */
export function filled(entries, optional) {
  const there = entries.filter(([, value]) => value !== undefined);
  return optional && !there.length ? undefined : Object.fromEntries(there);
}
