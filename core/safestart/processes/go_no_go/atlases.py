"""Atlases for go-no-go: from memory, from the cache by content key, or built."""

from __future__ import annotations

from collections import OrderedDict

from safestart.atlas.atlas import Atlas
from safestart.atlas.file import key_of, pack, unpack
from safestart.atlas.survey import TOLERANCE
from safestart.errors import InvalidInput
from safestart.exact.question import Question
from safestart.model.scenario import MAX_RANGE
from safestart.runtime.cache import Shelf
from safestart.runtime.children.forks import ForkableLock
from safestart.runtime.progress import Context

CUTS_M = (50.0, 150.0, 500.0, 1500.0, 5000.0, MAX_RANGE)
"""Possible far ends of an atlas: few, so that questions about different starts share one atlas."""
_IN_MEMORY = 64

_kept: OrderedDict[str, Atlas] = OrderedDict()
_lock = ForkableLock()


def atlas_for(question: Question, farthest: float, context: Context) -> Atlas:
    """The atlas that reaches ``farthest`` metres along y.

    It is looked up in the cache of ``context``, which can also cancel a construction (``Cancelled``).
    """
    cut = next(
        (c for c in CUTS_M if c >= farthest and c > question.scenario.corridor.hold_radius), CUTS_M[-1]
    )
    key = key_of(question, cut, TOLERANCE)
    with _lock:
        if key in _kept:
            _kept.move_to_end(key)
            return _kept[key]
    atlas = _from(context.shelf, key, question, cut)
    if atlas is None:
        from safestart.atlas.survey import build

        atlas = build(question, cut, context=context)
        context.shelf.keep(key, pack(atlas))
    with _lock:
        _kept[key] = atlas
        while len(_kept) > _IN_MEMORY:
            _kept.popitem(last=False)
    return atlas


def _from(shelf: Shelf, key: str, question: Question, cut: float) -> Atlas | None:
    data = shelf.find(key)
    if data is None:
        return None
    try:
        atlas = unpack(data)
    except InvalidInput:
        # Compute again when the cached file is unreadable or answers another question than its key.
        return None
    return atlas if (atlas.question, atlas.y_max) == (question, cut) else None
