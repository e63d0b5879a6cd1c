"""Compiled kernels that call kernels of other files: a change in any of those must reach Numba's cache."""

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from safestart.runtime.stamp import source_stamp

FOLDERS = ("avoidance", "guidance", "levelset", "sets", "verification")


def modules() -> Iterator[ModuleType]:
    for folder in FOLDERS:
        package = importlib.import_module(f"safestart.{folder}")
        for entry in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
            yield importlib.import_module(entry.name)


def called(function: Any, found: set[str]) -> set[str]:
    """Names of the modules whose compiled functions ``function`` calls, at any depth; its own may be among them."""
    for name in function.__code__.co_names:
        callee = getattr(function.__globals__.get(name), "py_func", None)
        if callee is not None and callee is not function:
            called(callee, found).add(callee.__module__)
    return found


def test_cached_kernels_are_keyed_by_all_that_they_call() -> None:
    stamped = []
    for module in modules():
        for kernel in vars(module).values():
            function = getattr(kernel, "py_func", None)
            if function is None or function.__module__ != module.__name__ or kernel.stats.cache_path is None:
                continue
            needed = called(function, set()) - {module.__name__}
            if not needed:
                continue
            stamped.append(function.__name__)
            assert needed <= {source.__name__ for source in module.SOURCES}, function.__name__
            assert [cell.cell_contents for cell in function.__closure__] == [source_stamp(*module.SOURCES)]
    assert sorted(stamped) == ["fastest", "filter_step", "roll_out", "sweep"]
