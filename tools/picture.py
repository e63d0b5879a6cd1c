"""The pictures of the README: overlay map and atlas at 2 deg/s, the sets of the inclusion chain at 3 deg/s."""

from __future__ import annotations

from pathlib import Path

from safestart.processes.execute import execute

DOCS = Path(__file__).resolve().parent.parent / "docs"


def draw(process_id: str, inputs: dict[str, object], artifact: str, target: str) -> None:
    """Run a process and keep one of its pictures."""
    (picture,) = [a for a in execute(process_id, inputs).artifacts if a.name == artifact]
    (DOCS / target).write_bytes(picture.data)
    print(f"{target}: {len(picture.data)} bytes")


if __name__ == "__main__":
    grid = {"nx": 121, "ny": 121, "y_max_m": 150}
    draw("benchmark", {"omega_t_deg_s": 2, "a_max_m_s2": 0.1, "grid": grid}, "overlay.png", "safe-start.png")
    draw("atlas", {"omega_t_deg_s": 2, "a_max_m_s2": 0.05, "grid": grid}, "atlas.png", "atlas.png")
    draw("inclusion-chain", {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}, "sets.png", "chain.png")
