// The trade study's question: 20 tumble rates between two, 25 thrusts, one stand-off.

const THRUSTS = Array.from({ length: 25 }, (_, k) => Number((10 ** (-2.3 + k / 12)).toPrecision(3)));

/** Inputs of the map from the texts of the fields; null if one of them is not a number. */
export function readTrade({ low, high, stand_off_m, y_max_m, rest }) {
  const texts = [low, high, stand_off_m, y_max_m].map((text) => text.trim()), numbers = texts.map(Number);
  if (texts.includes("") || !numbers.every(Number.isFinite)) return null;
  const [first, last] = numbers.slice(0, 2).sort((a, b) => a - b);
  return {
    omega_t_deg_s: Array.from({ length: 20 }, (_, k) => Number((first + ((last - first) * k) / 19).toPrecision(4))), a_max_m_s2: THRUSTS,
    stand_off_m: numbers[2], y_max_m: numbers[3], rest,
  };
}

export const tradeAddress = (texts) => `?${new URLSearchParams(texts)}`;

/** The question in words. */
export const closedWords = ({ stand_off_m, y_max_m, rest }) => `Certified for ever · stand-off ${stand_off_m} m · corridor cut at ${y_max_m} m · at rest in ${rest === "lvlh" ? "LVLH" : "the body frame"}`;

/** The address of Explore for one point of the map. */
export const tradeExplore = (rate, thrust, inputs) => `?${new URLSearchParams({
  omega_t_deg_s: String(rate), a_max_m_s2: String(thrust), rest: inputs.rest, y_max_m: String(inputs.y_max_m), x_m: "0", y_m: String(inputs.stand_off_m),
})}`;
