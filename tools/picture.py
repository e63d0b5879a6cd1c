"""The picture that opens the README: the benchmark's overlay map at 2 deg/s, 0.10 m/s^2."""

from __future__ import annotations

from pathlib import Path

from safestart.processes.execute import execute

TARGET = Path(__file__).resolve().parent.parent / "docs" / "safe-start.png"

if __name__ == "__main__":
    inputs = {"omega_t_deg_s": 2, "a_max_m_s2": 0.1, "grid": {"nx": 121, "ny": 121, "y_max_m": 150}}
    result = execute("benchmark", inputs)
    (picture,) = [a for a in result.artifacts if a.name == "overlay.png"]
    TARGET.write_bytes(picture.data)
    print(f"{TARGET.name}: {len(picture.data)} bytes")
