"""The process elliptic-start: its answers are the certificate's, its refusals name the field."""

from __future__ import annotations

from typing import Any

import pytest

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process

ASKED: dict[str, Any] = process("elliptic-start").example


def test_a_start_is_certified_up_to_its_eccentricity() -> None:
    slow = ASKED | {"spin_deg_s": 0.2, "points_m": [[0, 4000, 0], [0, -5, 0]]}
    outputs = execute("elliptic-start", slow).document["outputs"]
    first, outside = outputs["starts"]
    assert outside["verdict"] == "UNDECIDED"
    assert outside["binding"] == "hold_plane"
    assert outside["certified_up_to_eccentricity"] is None
    last = first["certified_up_to_eccentricity"]
    assert last is not None
    assert (first["verdict"] == "GO") == (last >= 0.7)
    for e, verdict in ((min(last, 0.73) - 1e-4, "GO"), (last + 1e-4, "UNDECIDED")):
        if e < outputs["ground_eccentricity"]:
            orbit = ASKED["orbit"] | {"eccentricity": e}
            again = execute("elliptic-start", slow | {"orbit": orbit}).document["outputs"]["starts"][0]
            assert again["verdict"] == verdict


def test_bad_input_is_named() -> None:
    for wrong, field in (
        ({"spin_deg_s": 0}, "spin_deg_s"),
        ({"spin_deg_s": 1e-3}, "spin"),
        ({"orbit": {"semi_major_axis_m": 7_000_000, "eccentricity": 0.5}}, "eccentricity"),
        ({"points_m": [[0, 1]]}, "points_m"),
    ):
        with pytest.raises(InvalidInput, match=field):
            execute("elliptic-start", ASKED | wrong)
