"""What a model refuses is said in our words, of text that is no Unicode and of times too."""

from __future__ import annotations

import re
from typing import Any

import pytest

from safestart.errors import InvalidInput
from safestart.records.bundle_parts import event_facts
from safestart.records.labels import labels_of


@pytest.mark.parametrize("given", [{"name": "\udcff"}, {"note": "a\ud800"}, {"tags": ["\udcff"]}], ids=repr)
def test_labels(given: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput, match=r"required text in Unicode, received '.*\\ud"):
        labels_of(**given)


@pytest.mark.parametrize("at", ["now", "2026-01-01T00:00:00", [], "2026-02-30"], ids=repr)
def test_times(at: Any) -> None:
    with pytest.raises(InvalidInput, match=re.escape("required a time with its zone, received")):
        event_facts([{"at": at, "kind": "log", "data": {}}])
