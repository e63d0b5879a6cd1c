// A question as a command: for a shell with curl, for our command line, for Python.

const quoted = (text) => `'${text.replaceAll("'", "'\\''")}'`;

/** A value as Python writes it. */
function python(value) {
  if (value === null || value === undefined) return "None";
  if (typeof value === "boolean") return value ? "True" : "False";
  if (Array.isArray(value)) return `[${value.map(python).join(", ")}]`;
  if (typeof value === "object") return `{${Object.entries(value).map(([name, inner]) => `${JSON.stringify(name)}: ${python(inner)}`).join(", ")}}`;
  return JSON.stringify(value);
}

/** The command in each language: `address` is the service's, `inputs` are those of the process. */
export const COPIES = {
  curl: ({ address, id, inputs }) => `curl -s ${address}/processes/${id}/execution -H 'Content-Type: application/json' -d ${quoted(JSON.stringify({ inputs }))}`,
  CLI: ({ id, inputs }) => `echo ${quoted(JSON.stringify(inputs))} | safestart run ${id} --input - --json`,
  Python: ({ id, inputs }) => `import safestart as ss\n\nresult = ss.run(${JSON.stringify(id)}, ${python(inputs)})`,
};
