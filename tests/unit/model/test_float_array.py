"""Arrays from what users write: numbers of Python, NumPy and its like, and nothing that is only converted to one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safestart.model.float_array import float_array

NUMBERS: list[Any] = [
    [30.0, 1],
    [np.float32(30), np.int8(1)],
    [np.array(30.0), np.array(1)],
    np.array([30, 1]),
    (30.0, np.array(1.0)),
]
OTHERS: list[Any] = [
    [True, 1.0],
    [np.bool_(True), 1.0],
    [np.array(True), 1.0],
    ["30", 1.0],
    [np.array("30"), 1.0],
    [None, 1.0],
    [[1.0], [1.0, 2.0]],
    np.array([True, False]),
    np.array(["30", "1"]),
    [1j, 1.0],
]


@pytest.mark.parametrize("given", NUMBERS, ids=repr)
def test_numbers(given: Any) -> None:
    found = float_array(given)
    assert found.dtype == np.float64
    assert found.tolist() == [30.0, 1.0]


@pytest.mark.parametrize("given", OTHERS, ids=repr)
def test_what_is_no_number(given: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        float_array(given)
