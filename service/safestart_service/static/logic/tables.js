// Outputs as tables, as in the service's CSV: declared ones, lists of objects, and lists within their rows.

/** A list of at most this many entries is a vector, with one column per entry. */
const MOST_ENTRIES = 8;

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const areObjects = (value) => Array.isArray(value) && value.length > 0 && value.every(isObject);

/** The scalars of a row: inner objects as `name.member`, vectors as `name.0`, lists of short words as one text. */
export function flat(row) {
  const found = {};
  for (const [name, value] of Object.entries(row)) {
    if (isObject(value)) for (const [key, item] of Object.entries(flat(value))) found[`${name}.${key}`] = item;
    else if (!Array.isArray(value)) found[name] = value;
    else if (value.every((item) => typeof item === "string")) found[name] = value.join(" ");
    else if (value.length <= MOST_ENTRIES && !value.some((item) => item !== null && typeof item === "object")) value.forEach((item, place) => { found[`${name}.${place}`] = item; });
  }
  return found;
}

/** Rows of a declared table; none if columns are missing or differ in length. */
function declared(outputs, { columns, axes }) {
  const there = columns.filter((name) => outputs[name] !== null && outputs[name] !== undefined);
  if (!there.length || axes.some((name) => !(name in outputs))) return [];
  const whole = (lists) => lists.every((list) => list.length === lists[0].length);
  if (!axes.length) {
    if (!whole(there.map((name) => outputs[name]))) return [];
    return outputs[there[0]].map((_, k) => flat(Object.fromEntries(there.map((name) => [name, outputs[name][k]]))));
  }
  const [first, second] = axes;
  if (!there.every((name) => whole([outputs[first], outputs[name]]) && outputs[name].every((line) => whole([outputs[second], line])))) return [];
  return outputs[first].flatMap((one, i) => outputs[second].map((two, k) => ({
    [first]: one, [second]: two, ...Object.fromEntries(there.map((name) => [name, outputs[name][i][k]])),
  })));
}

/** The tables among outputs by name; "" is the single row of the outputs' own scalars. */
export function tablesOf(outputs, known = []) {
  const found = { "": [flat(outputs)] };
  for (const table of known) {
    const rows = declared(outputs, table);
    if (rows.length) found[table.name] = rows;
  }
  const within = ([name, value]) => (isObject(value) ? Object.entries(value).map(([key, items]) => [`${name}.${key}`, items]) : [[name, value]]);
  for (const [name, value] of Object.entries(outputs).flatMap(within)) {
    if (!areObjects(value)) continue;
    found[name] = value.map(flat);
    value.forEach((row, k) => {
      for (const [key, items] of Object.entries(row)) {
        if (areObjects(items)) (found[`${name}.${key}`] ??= []).push(...items.map((item) => ({ ...found[name][k], ...flat({ [key]: item }) })));
      }
    });
  }
  return found;
}

/** Lists side by side, scalars left out, as rows of cells under their names; vectors take a column per entry. */
export function rowsOf(lists) {
  const whole = Object.fromEntries(Object.entries(lists).filter(([, value]) => Array.isArray(value) && value.length === lists.time_s.length));
  const rows = lists.time_s.map((_, k) => flat(Object.fromEntries(Object.entries(whole).map(([name, value]) => [name, value[k]]))));
  const names = Object.keys(rows[0]);
  return [names, ...rows.map((row) => names.map((name) => row[name]))];
}

/** Names of all columns, in the order of their first appearance, without those that are empty in every row. */
export const columnsOf = (rows) => [...new Set(rows.flatMap(Object.keys))].filter((name) => rows.some((row) => row[name] !== null && row[name] !== undefined && row[name] !== ""));

/** Values at a path, with `*` for every entry: `{ value, names }`; `named` are the members that name entries, "" for their keys. */
export function each(outputs, path, named = []) {
  let found = [{ value: outputs, names: [] }], stars = 0;
  for (const part of path.split(".")) {
    if (part !== "*") found = found.map(({ value, names }) => ({ value: value?.[part], names }));
    else {
      const name = named[stars++] ?? "";
      found = found.flatMap(({ value, names }) => Object.entries(value ?? {}).map(([key, item]) => ({ value: item, names: [...names, name ? item[name] : key] })));
    }
  }
  return found.filter(({ value }) => value !== null && value !== undefined);
}
