"""The picture of a missed-burn proof: every kind of failure has its mark, every zone its outline."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Polygon

from safestart.missed_burn.prove import prove
from safestart.missed_burn.zone import Zone
from safestart.processes.passive_abort import plots
from safestart.processes.passive_abort.question import plain_question
from safestart.processes.passive_abort.spec import SPEC, PassiveAbortInputs
from safestart.processes.plotting import figure
from safestart.proofs.abort.statement import KINDS

EXAMPLE = {**SPEC.example, "keep_out_m": 5.0, "abort_orbits": 0.5}
LASTING = [{**burn, "duration_s": 60.0} for burn in SPEC.example["burns"]]
BOX = {"kind": "box", "half_m": [5.0, 20.0, 3.0], "attitude_wxyz": [0.9, 0.0, 0.0, 0.4]}
BALL = {"kind": "ellipsoid", "half_m": [8.0, 12.0, 8.0], "centre_m": [-20.0, 30.0, 0.0]}


def test_every_kind_has_its_mark() -> None:
    """A burn that ends early had none: no picture came of burns that last."""
    assert set(plots._MARKS) == set(KINDS)


def test_burns_that_last_and_zones_are_drawn() -> None:
    failures = {"late_s": 20, "partial": True, "stuck_s": 2, "misdirected_deg": 1}
    inputs = SPEC.parse({**EXAMPLE, "burns": LASTING, "zones": [BOX, BALL], "failures": failures})
    assert isinstance(inputs, PassiveAbortInputs)
    proof = prove(plain_question(inputs), sharp=False)
    assert plots.picture(proof).media_type == "image/png"
    axes = figure(6.0, 5.0).subplots()
    plots.draw_drifts(axes, proof, range(len(proof.findings)))
    # Each zone and what is kept around it, and all of them are in the picture.
    outlines = [patch.get_xy() for patch in axes.patches if isinstance(patch, Polygon)]
    assert len(outlines) == 4
    (high, low), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    for outline in outlines:
        assert low <= outline[:, 0].min() <= outline[:, 0].max() <= high
        assert bottom <= outline[:, 1].min() <= outline[:, 1].max() <= top


@pytest.mark.parametrize("kind", ["box", "ellipsoid"])
def test_an_outline_is_as_far_from_its_zone_as_is_kept(kind: str) -> None:
    """A zone whose third axis is the orbit's normal: its outline lies in the orbit plane."""
    turn = np.array([np.cos(0.4), np.sin(0.4), 0.0]), np.array([-np.sin(0.4), np.cos(0.4), 0.0])
    axes = tuple(tuple(v.tolist()) for v in (5.0 * turn[0], 20.0 * turn[1], np.array([0.0, 0.0, 3.0])))
    zone = Zone(kind, (3.0, -4.0, 0.0), axes)  # type: ignore[arg-type]
    for x, y in plots._outline(zone, 7.0):
        assert zone.distance(np.array([x, y, 0.0])) == pytest.approx(7.0, abs=1e-9)
