"""Parts of kernels: with the Numba that is pinned they are linked late, with any other one as Numba does it."""

import math

import numba
import pytest
from numba import njit

from safestart.runtime.kernels import parts as kernel_parts
from safestart.runtime.kernels.parts import KNOWN, part


def _grown(x: float, times: int) -> float:
    total = 0.0
    for k in range(times):
        total += math.sqrt(x + k)
    return total


def _caller(options):
    grown = part(_grown, **options)

    @njit
    def twice(x: float) -> float:
        return grown(x, 3) + grown(x, 0)

    return twice, grown


def test_the_pinned_numba_is_the_one_that_parts_are_made_for() -> None:
    # A new one needs a look at its inner classes: kernel_pipeline.py, then KNOWN.
    assert tuple(numba.version_info[:2]) == KNOWN


@pytest.mark.parametrize(("version", "late"), [(KNOWN, True), ((KNOWN[0], KNOWN[1] + 1), False)])
def test_a_part_gives_the_same_bits_with_any_numba(
    version: tuple[int, int], late: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernel_parts, "version_info", (*version, 0))
    twice, grown = _caller({"nogil": True})
    assert twice(2.5) == _grown(2.5, 3)
    (library,) = {found.library for found in grown.overloads.values()}
    assert (type(library).__name__ == "_PartLibrary") is late
