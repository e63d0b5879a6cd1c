// The points of a picture's layers, from tables of outputs and the inputs beside them.

import { flat } from "./tables.js";
import { spoken } from "./words.js";

const DEFAULT = { c_x: 1.5, x0_m: 2.5, r_h_m: 0.5 };

/** Layers with rows: `{ ...layer, rows: [{ x, y, value }] }`, without the rows that lack a coordinate. */
export function layersOf(view, tables, inputs) {
  const beside = (name, k) => (name && inputs[name]?.[k] ? Object.fromEntries(Object.entries(flat(inputs[name][k])).map(([key, value]) => [`${name}.${key}`, value])) : {});
  const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
  return view.layers.map((layer) => {
    const whole = (tables[layer.table] ?? []).map((row, k) => ({ ...row, ...beside(layer.beside, k) }));
    return { ...layer, rows: whole.map((row) => ({ x: row[layer.x], y: row[layer.y], value: row[layer.value] })).filter(({ x, y }) => isNumber(x) && isNumber(y)) };
  }).filter(({ rows }) => rows.length);
}

/** The title of a layer: `{faces.0}` in it is the first of the outputs' faces. */
export const layerTitle = (title, outputs) => title.replace(/\{([\w.]+)\}/g, (_, path) => spoken(String(path.split(".").reduce((part, key) => part?.[key], outputs) ?? path)));

/**
 * The corridor of the inputs, if it is the usual one of three numbers; absent numbers have their usual values, and so has
 * an absent corridor where the process's described inputs allow that.
 */
export function shapeOf({ corridor }, described = {}) {
  if (corridor === undefined || corridor === null) return described.corridor?.minOccurs === 0 ? { ...DEFAULT } : null;
  const shape = { ...DEFAULT, ...corridor };
  // Another axis than the picture's y opens another way.
  const [x, y, z] = corridor.axis ?? [0, 1, 0];
  return "faces" in corridor || x !== 0 || z !== 0 || !(y > 0) || !Object.keys(DEFAULT).every((name) => typeof shape[name] === "number") ? null : shape;
}
