"""Paper 004: how many orbits one hop takes, along lines of every angle through the target."""

import safestart as ss

for angle in (10, 40, 70):
    outputs = ss.run("hop-time", {"angle_deg": angle, "rho": 0.7}, progress=False).outputs
    print(angle, "deg:", {name: value for name, value in outputs.items() if isinstance(value, float | str)})
