"""``safestart bench``: figures by name."""

from __future__ import annotations

import pytest

from safestart.cli.bench import add


def test_two_benchmarks_may_not_use_one_name() -> None:
    times = {"verify_s": 0.001}
    with pytest.raises(ValueError, match=r"in_space: .* received \['verify_s'\]"):
        add(times, {"verify_s": 0.77, "other_s": 1.0}, "in_space")
    assert times == {"verify_s": 0.001}
    add(times, {"other_s": 1.0}, "in_space")
    assert times == {"verify_s": 0.001, "other_s": 1.0}
