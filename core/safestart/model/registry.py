"""Things on offer by their names: what is registered twice is refused, so that nothing replaces another silently."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import TypeVar

from safestart.errors import invalid

_NAME = re.compile(r"[!-~]+")
Thing = TypeVar("Thing")


def by_name(what: str, things: Iterable[Thing], name_of: Callable[[Thing], str]) -> dict[str, Thing]:
    """The things in their order; raises ``InvalidInput`` naming ``what`` for a name that comes twice or has blanks."""
    out: dict[str, Thing] = {}
    for thing in things:
        name = name_of(thing)
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise invalid(what, "names without blanks", name)
        if name in out:
            raise invalid(what, "names that come once each", name)
        out[name] = thing
    return out
