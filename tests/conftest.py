"""Property tests are the same on every machine, and what takes long comes first.

Property tests have no time limit for an example, and always the same examples; others are drawn with
``pytest --hypothesis-profile=default``.

Hundreds of tests start processes of ours. They keep their compiled modules even where the environment says not to:
without them each of those processes compiles the text of all modules again, two thirds of its start. Workers load no
kernels that no job of the test needs: that takes each of them ten seconds and more.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
os.environ.setdefault("SAFESTART_WARM_UP", "needed")

settings.register_profile(
    "steady", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("steady")

HERE = Path(__file__).parent
FIRST = ("acceptance", "chaos", "browser", "fuzzing", "contract", "reference")
"""Folders from whole platforms down to single functions; the others follow them."""


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that may take minutes begin first: with ``-n`` no core has nothing left to do while one of them runs."""
    ranks = {folder: rank for rank, folder in enumerate(FIRST)}
    items.sort(key=lambda item: ranks.get(_folder(item), len(FIRST)))


def _folder(item: pytest.Item) -> str:
    return item.path.relative_to(HERE).parts[0] if item.path.is_relative_to(HERE) else ""
