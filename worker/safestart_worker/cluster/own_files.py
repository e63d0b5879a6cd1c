"""Dask without the files and variables of the user's, which it reads at its import: a broken file ends that import.

Task processes import Dask, too, before anything of ours runs in them. Dask looks for files in the home directory, and
no setting of its own says otherwise: during that import only, the home directory is a place where nothing can be.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module

_NOWHERE = {"HOME": os.devnull, "DASK_ROOT_CONFIG": os.devnull}
_inside = 0
_before: dict[str, str | None] = {}


def import_dask() -> None:
    """Import Dask with its own defaults alone; call it before the first import of Dask or ``distributed``."""
    forget_variables()
    with nowhere():
        import_module("dask.config")


def unreadable() -> bool:
    """Whether the files that Dask would read end its import."""
    import dask

    try:
        dask.config.collect(paths=["/etc/dask", os.path.expanduser("~/.config/dask")], env={})
    except Exception:  # whatever a parser may say about a foreign file
        return True
    return False


@contextmanager
def nowhere() -> Iterator[None]:
    """Dask finds no file in this process and those that it starts; several at once end with the last."""
    global _inside
    if not _inside:
        _before.update({name: os.environ.get(name) for name in _NOWHERE})
    _inside += 1
    os.environ.update(_NOWHERE)
    try:
        yield
    finally:
        _inside -= 1
        for name, value in _before.items() if not _inside else ():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def forget_variables() -> None:
    """Remove Dask's variables, which the task processes would read when they start."""
    for name in [name for name in os.environ if name.startswith("DASK_")]:
        del os.environ[name]
