// Solids in space as lines: turned by quaternions, half-spaces cut by a box, keep-outs.

/** Rows of the rotation from LVLH to the body: C = (s^2 - v.v) I + 2 v v^T - 2 s [v]x, scalar first. */
export function rowsOfQuaternion([s, x, y, z]) {
  const plain = s * s - x * x - y * y - z * z, v = [x, y, z];
  const cross = [[0, -z, y], [z, 0, -x], [-y, x, 0]];
  return v.map((a, i) => v.map((b, j) => (i === j ? plain : 0) + 2 * a * b - 2 * s * cross[i][j]));
}

export const rotated = (rows, p) => rows.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);
export const back = (rows, p) => [0, 1, 2].map((k) => rows[0][k] * p[0] + rows[1][k] * p[1] + rows[2][k] * p[2]);

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, k) => a.map((one) => k * one);
const sum = (a, b) => a.map((one, k) => one + b[k]);

/** The part of a line `at + t along` inside all half-spaces, as two points; null if there is none. */
function clipped(at, along, planes, slack) {
  let low = -Infinity, high = Infinity;
  for (const { normal, offset } of planes) {
    const rise = dot(normal, along), room = offset - dot(normal, at);
    if (Math.abs(rise) < 1e-12) {
      if (room < -slack) return null;
    } else if (rise > 0) high = Math.min(high, (room + slack) / rise);
    else low = Math.max(low, (room + slack) / rise);
  }
  return high - low > 4 * slack ? [sum(at, scaled(along, low)), sum(at, scaled(along, high))] : null;
}

/** Edges of the half-spaces `{ normal, offset }` (normal . p <= offset) in the box of +-size; the box's own edges are none. */
export function edges(faces, size) {
  const unit = faces.map(({ normal, offset }) => { const l = Math.hypot(...normal); return { normal: scaled(normal, 1 / l), offset: offset / l }; });
  const walls = [0, 1, 2].flatMap((k) => [1, -1].map((sign) => ({ normal: [0, 1, 2].map((j) => (j === k ? sign : 0)), offset: size })));
  const planes = [...unit, ...walls], out = [];
  unit.forEach((one, i) => {
    for (const two of planes.slice(i + 1)) {
      const along = cross(one.normal, two.normal), length = dot(along, along);
      if (length < 1e-10) continue;
      // The point of the line next to the origin.
      const at = scaled(sum(scaled(cross(two.normal, along), one.offset), scaled(cross(along, one.normal), two.offset)), 1 / length);
      const cut = clipped(at, scaled(along, 1 / Math.sqrt(length)), planes, 1e-7 * size);
      if (cut) out.push(cut);
    }
  });
  return out;
}

/** The paper's five faces along `axis`: `{ normal, offset }` in the body frame, as the core turns them from +y. */
export function fiveFaces({ axis, c_x: cx, c_z: cz, x0_m: x0, z0_m: z0, r_h_m: rh }) {
  const length = Math.hypot(...axis), [x, y, z] = scaled(axis, 1 / length), share = 1 / (1 + y);
  const turn = y > -1 + 1e-12 ? [[1 - share * x * x, x, -share * x * z], [-x, y, -z], [-share * x * z, z, 1 - share * z * z]] : [[1, 0, 0], [0, -1, 0], [0, 0, -1]];
  const rows = [[[0, -1, 0], -rh], [[1, -cx, 0], x0 - cx * rh], [[-1, -cx, 0], x0 - cx * rh], [[0, -cz, 1], z0 - cz * rh], [[0, -cz, -1], z0 - cz * rh]];
  return rows.map(([normal, offset]) => ({ normal: rotated(turn, normal), offset, frame: "body" }));
}

/** Lines of a keep-out: three circles of a sphere, the edges of a box. */
export function keepOutLines({ centre_m: centre, radius_m: radius, half_widths_m: half }) {
  const at = (p) => sum(centre, p);
  if (radius) {
    const ring = Array.from({ length: 49 }, (_, k) => [radius * Math.cos((k * Math.PI) / 24), radius * Math.sin((k * Math.PI) / 24)]);
    return [ring.map(([a, b]) => at([a, b, 0])), ring.map(([a, b]) => at([a, 0, b])), ring.map(([a, b]) => at([0, a, b]))];
  }
  const signs = [-1, 1], out = [];
  for (const k of [0, 1, 2]) {
    const [i, j] = [0, 1, 2].filter((one) => one !== k);
    for (const a of signs) {
      for (const b of signs) {
        out.push(signs.map((c) => { const p = [0, 0, 0]; [p[i], p[j], p[k]] = [a * half[i], b * half[j], c * half[k]]; return at(p); }));
      }
    }
  }
  return out;
}

/** Points of lines as one trace in space, with gaps. */
export function spaceLines(polylines) {
  const out = { x: [], y: [], z: [] };
  for (const line of polylines) {
    for (const [x, y, z] of line) { out.x.push(x); out.y.push(y); out.z.push(z); }
    for (const axis of [out.x, out.y, out.z]) axis.push(null);
  }
  return out;
}

/** A convex polygon's triangles as a mesh's i, j, k. */
export function fan(corners) {
  const inner = Array.from({ length: Math.max(0, corners.length - 2) }, (_, k) => k);
  return { i: inner.map(() => 0), j: inner.map((k) => k + 1), k: inner.map((k) => k + 2) };
}
