// Points in space seen from afar, as a picture's x and y.

/** A function from a point to its place in the picture: turned about the vertical (third axis) by `around`, seen from `above`, both in degrees. */
export function camera(around, above) {
  const [ca, sa] = [Math.cos((around * Math.PI) / 180), Math.sin((around * Math.PI) / 180)];
  const [ce, se] = [Math.cos((above * Math.PI) / 180), Math.sin((above * Math.PI) / 180)];
  return ([x, y, z]) => [-sa * x + ca * y, -se * (ca * x + sa * y) + ce * z];
}

/** A rotation's rows times a point. */
export const rotated = (rows, point) => rows.map((row) => row[0] * point[0] + row[1] * point[1] + row[2] * point[2]);

/** The inverse rotation: its columns times a point. */
export const back = (rows, point) => [0, 1, 2].map((k) => rows[0][k] * point[0] + rows[1][k] * point[1] + rows[2][k] * point[2]);

/** Lines of points as one trace: places with gaps between the lines. */
export function lines(polylines, project) {
  const x = [], y = [];
  for (const line of polylines) {
    for (const point of line) {
      const [px, py] = project(point);
      x.push(px);
      y.push(py);
    }
    x.push(null);
    y.push(null);
  }
  return { x, y };
}
