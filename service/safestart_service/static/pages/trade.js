// Trade study: certified share over (tumble rate, thrust), and the thrust that a stand-off asks for.

import { execute, root } from "../parts/api.js";
import { COLOURS, draw, saveButtons } from "../parts/chart.js";
import { csv, figure } from "../logic/words.js";
import { $, el, fail, loading, save, table } from "../parts/page.js";

const THRUSTS = Array.from({ length: 25 }, (_, k) => Number((10 ** (-2.3 + k / 12)).toPrecision(3)));
const asked = new URLSearchParams(location.search);
for (const name of ["low", "high", "stand_off_m", "y_max_m", "rest"]) if (asked.has(name)) $(name).value = asked.get(name);

async function show() {
  const [low, high] = [Number($("low").value), Number($("high").value)].sort((a, b) => a - b);
  const rates = Array.from({ length: 20 }, (_, k) => Number((low + ((high - low) * k) / 19).toPrecision(4)));
  const inputs = {
    omega_t_deg_s: rates, a_max_m_s2: THRUSTS, stand_off_m: Number($("stand_off_m").value), y_max_m: Number($("y_max_m").value), rest: $("rest").value,
  };
  history.replaceState(null, "", `?${new URLSearchParams({ low, high, stand_off_m: inputs.stand_off_m, y_max_m: inputs.y_max_m, rest: inputs.rest })}`);
  loading($("state"), "Certifying 500 corridors");
  try {
    const found = await execute("thrust-map", inputs);
    $("state").replaceChildren();
    await picture(found, inputs);
    figures(found, inputs);
  } catch (error) {
    fail($("state"), error, show);
  }
}

async function picture(found, inputs) {
  const share = found.a_max_m_s2.map((_, k) => found.safe_percent.map((row) => row[k]));
  await draw($("map"), [
    {
      type: "heatmap", x: found.omega_t_deg_s, y: found.a_max_m_s2, z: share, zmin: 0, zmax: 100, colorscale: "Cividis",
      colorbar: { title: { text: "certified [%]" } }, hovertemplate: "%{x} deg/s, %{y} m/s²<br>%{z:.1f} % certified<extra></extra>",
    },
    {
      name: `needed for a start at ${figure(inputs.stand_off_m)} m`, x: found.omega_t_deg_s, y: found.required_a_max_m_s2, mode: "lines+markers",
      line: { color: COLOURS.hamilton_jacobi, width: 3 }, hovertemplate: "%{x} deg/s needs %{y:.4f} m/s²<extra></extra>",
    },
  ], {
    xaxis: { title: { text: "tumble rate [deg/s]" } }, showlegend: true,
    yaxis: { title: { text: "thrust acceleration [m/s²]" }, type: "log", range: [Math.log10(THRUSTS[0]), Math.log10(THRUSTS[THRUSTS.length - 1])] },
  });
  const place = $("map");
  place.removeAllListeners?.("plotly_click");
  place.on("plotly_click", ({ points: [point] }) => {
    location.assign(`${root}/dashboard?${link(point.x, point.y, inputs)}`);
  });
}

const link = (rate, thrust, inputs) => new URLSearchParams({
  omega_t_deg_s: rate, a_max_m_s2: thrust, rest: inputs.rest, y_max_m: inputs.y_max_m, x_m: 0, y_m: inputs.stand_off_m,
});

function figures(found, inputs) {
  const rows = found.omega_t_deg_s.map((rate, k) => ({ rate, needed: found.required_a_max_m_s2[k] }));
  $("said").textContent = `Smallest thrust acceleration that certifies a start on the axis, ${figure(inputs.stand_off_m)} m from the target.`;
  const explore = (row) => (row.needed === null ? "–" : el("a", { href: `${root}/dashboard?${link(row.rate, Number((row.needed * 1.02).toPrecision(3)), inputs)}` }, "explore"));
  $("table").replaceChildren(
    table(rows, [["tumble rate [deg/s]", (r) => r.rate], ["required thrust [m/s²]", (r) => r.needed], ["", explore]], "Required thrust"),
    el("div", { class: "tools" }, el("button", {
      type: "button", class: "plain", onclick: () => save("required-thrust.csv", csv([["omega_t_deg_s", "required_a_max_m_s2"], ...rows.map((r) => [r.rate, r.needed])])),
    }, "CSV"), saveButtons($("map"), "trade-study", el)));
}

$("controls").addEventListener("submit", (event) => { event.preventDefault(); show(); });
await show();
