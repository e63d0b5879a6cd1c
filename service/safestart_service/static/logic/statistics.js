// Shares with their intervals, and the comparison of two masks.

/** Wilson interval of a share, 95 %; null without trials. */
export function wilson(hits, of) {
  if (!of) return null;
  const z = 1.959964, p = hits / of, d = 1 + (z * z) / of;
  const middle = (p + (z * z) / (2 * of)) / d, half = (z / d) * Math.sqrt((p * (1 - p)) / of + (z * z) / (4 * of * of));
  return [Math.max(0, middle - half), Math.min(1, middle + half)];
}

/** Cells of a map by kind: 0 outside, 1 in neither mask, 2 in both, 3 only in the first, 4 only in the second; and their counts. */
export function agreement(inside, first, second) {
  const counts = [0, 0, 0, 0, 0];
  const z = inside.map((row, iy) => row.map((within, ix) => {
    const [a, b] = [first[iy][ix], second[iy][ix]];
    const kind = !within ? 0 : a && b ? 2 : a ? 3 : b ? 4 : 1;
    counts[kind] += 1;
    return kind;
  }));
  return { z, counts };
}
