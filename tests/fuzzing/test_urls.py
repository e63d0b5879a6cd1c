"""A hundred paths and query strings at random; by the hundred thousand: ``python -m tests.fuzzing.timed urls``."""

from __future__ import annotations

import random

from tests.fuzzing.urls import url


def test_no_url_ends_in_an_unexpected_error() -> None:
    draw = random.Random(0)
    statuses = {url(draw)() for _ in range(100)}
    assert {200, 404, 422} <= statuses
