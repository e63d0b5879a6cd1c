// Geometry shared by the pictures.

/** Corners of the corridor cut at yMax, closed. */
export function corridor({ c_x, x0_m, r_h_m }, yMax) {
  const half = x0_m + c_x * (yMax - r_h_m);
  return { x: [-half, -x0_m, x0_m, half, -half], y: [yMax, r_h_m, r_h_m, yMax, yMax], half };
}

/** The part of a circle about the target that lies in the corridor. */
export function arc(radius, { c_x, x0_m, r_h_m }, yMax) {
  const x = [], y = [];
  for (let k = 0; k <= 180; k++) {
    const angle = (Math.PI * k) / 180;
    const [px, py] = [radius * Math.cos(angle), radius * Math.sin(angle)];
    const inside = py >= r_h_m && py <= yMax && Math.abs(px) <= x0_m + c_x * (py - r_h_m);
    x.push(inside ? px : null);
    y.push(inside ? py : null);
  }
  return { x, y };
}

/** Points turned about the origin by an angle (rad), counter-clockwise. */
export function turned(xs, ys, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return { x: xs.map((x, k) => c * x - s * ys[k]), y: xs.map((x, k) => s * x + c * ys[k]) };
}

/** A polygon's corners as a closed line. */
export function closed(polygon) {
  const ring = [...polygon, polygon[0]];
  return { x: ring.map((p) => p[0]), y: ring.map((p) => p[1]) };
}

/** Whether a point lies within a polygon (even-odd rule). */
export function within([x, y], polygon) {
  let inside = false;
  polygon.forEach(([ax, ay], k) => {
    const [bx, by] = polygon[(k + 1) % polygon.length];
    if ((ay > y) !== (by > y) && x < ax + ((bx - ax) * (y - ay)) / (by - ay)) inside = !inside;
  });
  return inside;
}

/** The value of a map over x and y at its node nearest to a point; null beyond the map. */
export function nearest([x, y], { x_m: xs, y_m: ys, margin_m: values }) {
  const [dx, dy] = [xs[1] - xs[0], ys[1] - ys[0]];
  const [ix, iy] = [Math.round((x - xs[0]) / dx), Math.round((y - ys[0]) / dy)];
  return values[iy]?.[ix] ?? null;
}
