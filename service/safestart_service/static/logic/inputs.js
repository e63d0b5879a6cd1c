// The inputs of a run in words: the ones that make it this run, the rest by their names.

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const isPlain = (value) => !isObject(value) && !(Array.isArray(value) && value.some((item) => item !== null && typeof item === "object"));
const LONGEST = 60;

/** Leaves of inputs as [path, text]: inner members as `outer.inner`, lists as one text, shortened. */
export function leaves(inputs, path = "") {
  return Object.entries(inputs).flatMap(([name, value]) => {
    const here = path ? `${path}.${name}` : name;
    if (value === null || value === undefined) return [];
    if (isObject(value)) return leaves(value, here);
    if (Array.isArray(value) && value.length === 1 && isObject(value[0])) return leaves(value[0], here);
    const text = Array.isArray(value) ? (isPlain(value) ? value.join(", ") : value.map((item) => JSON.stringify(item)).join(", ")) : String(value);
    return text === "" ? [] : [[here, text.length > LONGEST ? `${text.slice(0, LONGEST - 2)} …` : text]];
  });
}

/** The inputs that make a run this run: required ones, those of the example, and those that are not as by default. */
export function keyInputs({ inputs: described, example = {} }, inputs) {
  const same = (one, two) => JSON.stringify(one) === JSON.stringify(two);
  const key = Object.entries(inputs).filter(([name, value]) => {
    const known = described[name];
    return !known || known.minOccurs > 0 || name in example || (isPlain(value) && !same(value, known.schema.default ?? null));
  });
  return leaves(Object.fromEntries(key));
}
