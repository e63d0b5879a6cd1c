// A field by its JSON schema: its type behind references and alternatives, its bounds, its typed values.

const at = (whole, reference) => reference.slice(2).split("/").reduce((part, key) => part[key], whole);
const isNull = (schema) => schema.type === "null" || (schema.enum?.length === 1 && schema.enum[0] === null);

/** The schema behind references and alternatives; `optional` if null is one of them. */
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

/** A bound for people. The service writes "more than" as the next floating-point number: 5e-324 means more than 0. */
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

/** Numbers separated by commas; other parts stay text, so that the service refuses them by name. Undefined if empty. */
export const numbers = (text) => (text.trim() === "" ? undefined
  : text.split(",").map((part) => (part.trim() !== "" && Number.isFinite(Number(part)) ? Number(part) : part.trim())));

/** JSON, or the text itself if it is not JSON; undefined if empty. */
export function parsed(text) {
  if (text.trim() === "") return undefined;
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/**
 * An object of entries [name, value] without undefined ones; undefined if it is optional and nobody began it: all that is
 * left is as `schema` gives it.
 */
export function filled(entries, optional, { properties = {} } = {}) {
  const there = entries.filter(([, value]) => value !== undefined);
  const begun = there.some(([name, value]) => JSON.stringify(value) !== JSON.stringify(properties[name]?.default));
  return optional && !begun ? undefined : Object.fromEntries(there);
}
