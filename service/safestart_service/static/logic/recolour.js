// Pictures in other colours: they hold the colours that they were drawn in.

/** A copy of a value in which each text that is a key of `pairs` is its value; arrays of numbers stay the same ones. */
export function recoloured(value, pairs) {
  if (typeof value === "string") return pairs.get(value) ?? value;
  if (Array.isArray(value)) return typeof value[0] === "number" ? value : value.map((item) => recoloured(item, pairs));
  if (value === null || typeof value !== "object" || ArrayBuffer.isView(value)) return value;
  return Object.fromEntries(Object.entries(value).map(([name, item]) => [name, recoloured(item, pairs)]));
}
