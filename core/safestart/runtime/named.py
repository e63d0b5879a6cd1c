"""What a registry names as ``module:name``, imported at its first use."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

from safestart.errors import Misregistered

_FORM = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")


def load(target: str, what: str = "registered name") -> Any:
    """The function or class that ``target``, ``module:name``, names; ``what`` says whose entry named it.

    Raises ``Misregistered`` for a name of another form, and where the module or the name in it is missing.
    """
    if not isinstance(target, str) or not _FORM.fullmatch(target):
        raise misregistered(what, "module:name", target)
    module, _, name = target.partition(":")
    found = getattr(module_of(module, what), name, None)
    if not callable(found):
        raise misregistered(what, f"a function or class of {module}", target)
    return found


def module_of(name: str, what: str) -> Any:
    """The module called ``name``; raises ``Misregistered`` where there is none."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        # A package that this module itself needs and does not find is another matter.
        if error.name is None or not f"{name}.".startswith(f"{error.name}."):
            raise
        raise misregistered(what, "the name of a module", name) from None


def misregistered(what: str, required: str, received: object) -> Misregistered:
    """The error of an entry: what it belongs to, what was required, what came."""
    return Misregistered(
        f"{what}: required {required}, received {received!r}",
        field=what,
        required=required,
        received=received,
    )
