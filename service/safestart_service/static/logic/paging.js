// A list that is filtered, sorted and shown a page at a time: its state in the address, and the request for a page.

export const PER_PAGE = 25;
/** Filters and their names in the request. */
const FILTERS = { process: "processID", status: "status", verdict: "verdict" };
export const USUAL = { search: "", process: "", status: "", verdict: "", sort: "-created", page: 1 };

/** The state that an address gives; what it does not say, or says wrongly, is as usual. */
export function fromAddress(search) {
  const told = Object.fromEntries([...new URLSearchParams(search)].filter(([name]) => name in USUAL)), page = Number(told.page ?? 1);
  return { ...USUAL, ...told, page: Number.isInteger(page) && page > 0 && page <= 400000 ? page : 1 };
}

/** The address of a state; it leaves out what is as usual. */
export function toAddress(state) {
  const told = new URLSearchParams(Object.entries(state).filter(([name, value]) => name in USUAL && String(value) !== String(USUAL[name])));
  return told.size ? `?${told}` : "";
}

/** The request for a page of the list: words with # before them are whole tags. */
export function request({ search, sort, page, ...filters }) {
  const words = search.split(/\s+/).filter(Boolean), asked = new URLSearchParams({ limit: PER_PAGE });
  const plain = words.filter((word) => !/^#./.test(word));
  if (plain.length) asked.append("search", plain.join(" "));
  for (const word of words) if (/^#./.test(word)) asked.append("tag", word.slice(1));
  for (const [name, wire] of Object.entries(FILTERS)) if (filters[name]) asked.append(wire, filters[name]);
  if (sort !== USUAL.sort) asked.append("sort", sort);
  if (page > 1) asked.append("offset", (page - 1) * PER_PAGE);
  return `/jobs?${asked}`;
}

/** The number of pages; an empty list has one. */
export const pagesOf = (total) => Math.max(1, Math.ceil(total / PER_PAGE));

/** A number with thin gaps between its thousands. */
export const counted = (number) => String(number).replace(/\B(?=(\d{3})+$)/g, " ");

/** The order after a click on a column's head: its own usual direction first, then the other one. */
export function sorted(sort, column, falling) {
  const usual = falling ? `-${column}` : column;
  return sort === usual ? (falling ? column : `-${column}`) : usual;
}
