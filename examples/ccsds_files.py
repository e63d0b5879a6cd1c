"""CCSDS files in and out: ephemerides and an attitude to the times at which an approach may start, with proofs."""

import json
from pathlib import Path

import safestart as ss

# If you have no files at hand, a flight gives them: OEM of both craft, AEM of the target.
start = {"omega_t_deg_s": 1, "a_max_m_s2": 0.1, "start": {"x_m": 2, "y_m": 40}, "horizon_s": 120}
ss.run("flight", start, progress=False).save("flight")
files = {
    name: Path("flight", file).read_text()
    for name, file in (("chaser", "chaser.oem"), ("target", "target.oem"), ("attitude", "target.aem"))
}
timeline = ss.run("commit-timeline", {**files, "a_max_m_s2": 0.1, "horizon_s": 40}, progress=False)
for one in timeline.outputs["intervals"]:
    print(one["begin"], one["end"], one["verdict"], one["reason"])
(proofs,) = (json.loads(one.data) for one in timeline.artifacts if one.name == "proofs.json")
first = timeline.outputs["intervals"][0]
assert ss.verify(proofs[first["begin_proof"]]).verdict == first["verdict"]
