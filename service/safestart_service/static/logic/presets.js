// Operating points that people know by name: texts for Explore's fields, and where they come from.

const TABLE = "Iskender, Ling, Lim, Lansard: Reachability-based safe-start regions, Table 2";

export const PRESETS = [
  { title: "slow tumble, 1 deg/s", from: TABLE, texts: { omega_t_deg_s: "1", a_max_m_s2: "0.1" } },
  { title: "medium tumble, 3 deg/s", from: TABLE, texts: { omega_t_deg_s: "3", a_max_m_s2: "0.1" } },
  { title: "fast tumble, 5 deg/s", from: TABLE, texts: { omega_t_deg_s: "5", a_max_m_s2: "0.1" } },
  { title: "GO by the paper's conditions, impossible to fly", from: "docs/theory/closed-form.md", texts: { omega_t_deg_s: "2", a_max_m_s2: "0.05", x_m: "9.364", y_m: "81.044" } },
  { title: "Envisat, 2.67 deg/s at 765 km", from: "Rate of Envisat's spin, mean motion of its orbit", texts: { omega_t_deg_s: "2.67", a_max_m_s2: "0.1", mean_motion_rad_s: "0.00105" } },
];
