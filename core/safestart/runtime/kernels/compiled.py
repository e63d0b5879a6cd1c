"""Compiled kernels and their cache on disk, which never runs stale code or a broken file.

Numba freezes every global that a kernel reads, its constants and the kernels it calls. But its cache key covers
only the bytecode of the one function and the time of its file, so a constant or callee changed in another file
would still run as the old machine code. The cache key of a :func:`compiled` function covers all of it: the source
text of every function that it calls, at any depth, their options and default arguments, the value of every constant,
and the fields of its record arguments.

Inside a kernel arrays are copied by loops: ``a[:] = b`` of two arrays compiles the text of an error about their shapes,
two seconds of it.

An unreadable cache file is compiled again, an unwritable one is skipped, and one log line says so.
"""

from __future__ import annotations

import hashlib
import logging
import pickle
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import njit, types
from numba.core.caching import FunctionCache

from safestart.runtime.kernels.parts import part

log = logging.getLogger("safestart.kernels")

_OURS = "safestart"
_ADDRESS = re.compile("0x[0-9a-f]+")
_FORM = 2
"""Of the kept files. Those of another one are not looked for."""
_CONSTANTS = (bool, int, float, complex, str, bytes, type(None), np.generic, tuple, frozenset)


def compiled(**options: Any) -> Callable[[Any], Any]:
    """Decorator: ``numba.njit(nogil=True, **options)`` with a cache keyed by everything the code depends on.

    ``options`` are Numba's, without ``cache``. Without a writable cache folder the kernel is compiled for this
    process alone.
    """

    def decorate(function: Any) -> Any:
        # Nothing takes a kernel's address for C, so no wrapper is compiled for that.
        named: dict[str, Any] = {"nogil": True, "no_cfunc_wrapper": True, **options}
        kernel = njit(**named)(function)
        inner = part(function, **named)
        kernel.get_call_template, kernel.get_overload = inner.get_call_template, inner.get_overload
        try:
            kernel._cache = KernelCache(function)
            kernel._cache.options = _options(kernel)
        except (RuntimeError, OSError) as error:  # Numba found no folder that it may write to
            _say("no place to keep compiled kernels", error)
        return kernel

    return decorate


class KernelCache(FunctionCache):
    """Numba's cache of one function, with a key that covers its dependencies and a digest of every file's content."""

    options = ""
    """Those of the compilation."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled code of a signature, or None when no trusted code exists."""
        try:
            return super().load_overload(sig, target_context)
        except Exception as error:  # a damaged file can make pickle raise anything
            _say("a kept kernel cannot be read and is compiled again", error)
            with suppress(Exception):
                self.flush()  # an index that cannot be read could not be written either
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store the compiled code of a signature, if possible."""
        try:
            super().save_overload(sig, data)
        except Exception as error:  # a full or read-only disk, a damaged index
            _say("a compiled kernel cannot be kept", error)

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        if not self._enabled:
            return None
        kept = self._cache_file.load(self._index_key(sig, target_context.codegen()))
        if kept is None:
            return None
        digest, content = kept
        if self._digest(sig, content) != digest:
            raise ValueError("its content does not have its digest")
        return self._impl.rebuild(target_context, pickle.loads(content))  # noqa: S301  (as Numba reads its own)

    def _save_overload(self, sig: Any, data: Any) -> None:
        if not self._enabled or not self._impl.check_cachable(data):
            return
        self._impl.locator.ensure_cache_path()
        content = pickle.dumps(self._impl.reduce(data), protocol=-1)
        kept = (self._digest(sig, content), content)
        self._cache_file.save(self._index_key(sig, data.codegen), kept)

    def _digest(self, sig: Any, content: bytes) -> str:
        """Of the code and whose it is: files of other kernels, put in its place, are not it."""
        function = self._py_func
        named = f"{function.__module__} {function.__qualname__} {_ADDRESS.sub('', str(sig))}"
        whose = f"{named} {self.options} {dependencies(function)} "
        return hashlib.sha256(whose.encode() + content).hexdigest()

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        records = tuple(_record for argument in sig for _record in _records(argument))
        return (*super()._index_key(sig, codegen), self.options, dependencies(self._py_func), records, _FORM)


@cache
def dependencies(function: FunctionType) -> str:
    """SHA-256 over all that ``function`` freezes when it is compiled: texts of what it calls, values of constants."""
    digest = hashlib.sha256()
    for line in sorted(set(_frozen(function, set()))):
        digest.update(line.encode() + b"\n")
    return digest.hexdigest()


def _frozen(function: Any, seen: set[Any]) -> Iterator[str]:
    if function in seen:
        return
    seen.add(function)
    yield f"text of {function.__module__}: {_text_digest(function.__module__)}"
    yield f"defaults of {function.__qualname__}: {function.__defaults__!r} {function.__kwdefaults__!r}"
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    names = _names(function.__code__)
    read = {name: cell.cell_contents for name, cell in cells} | _named(names, function.__globals__)
    for value in list(read.values()):
        if isinstance(value, ModuleType) and value.__name__.startswith(_OURS):
            yield f"text of {value.__name__}: {_text_digest(value.__name__)}"
            read |= {f"{value.__name__}.{name}": one for name, one in _named(names, vars(value)).items()}
    for name, value in read.items():
        inner = getattr(value, "py_func", value)
        if isinstance(inner, FunctionType):
            if inner is not value:
                yield f"options of {name}: {_options(value)}"
            if inner.__module__.startswith(_OURS) or inner is not value:
                yield from _frozen(inner, seen)
        elif isinstance(value, type):
            if value.__module__.startswith(_OURS):
                yield f"text of {value.__module__}: {_text_digest(value.__module__)}"
        elif isinstance(value, np.ndarray):
            content = hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
            yield f"value of {name}: {value.dtype} {value.shape} {content}"
        elif isinstance(value, _CONSTANTS):
            yield f"value of {name}: {value!r}"


def _options(kernel: Any) -> str:
    """A kernel's options as a text that is the same in every process."""
    options = kernel.targetoptions.items()
    return repr(sorted((name, sorted(one) if isinstance(one, set) else one) for name, one in options))


def _named(names: set[str], space: dict[str, Any]) -> dict[str, Any]:
    return {name: space[name] for name in names if name in space}


def _names(code: CodeType) -> set[str]:
    inner = (_names(constant) for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*inner)


@cache
def _text_digest(module: str) -> str:
    file = getattr(sys.modules[module], "__file__", None)
    return hashlib.sha256(Path(file).read_bytes() if file else b"").hexdigest()


def _records(argument: Any) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Name and fields of every record among the argument types; Numba's own key has only the field types."""
    if isinstance(argument, types.NamedTuple | types.NamedUniTuple):
        yield argument.instance_class.__qualname__, tuple(argument.fields)
    if isinstance(argument, types.BaseTuple):
        for member in getattr(argument, "types", ()) or (getattr(argument, "dtype", None),):
            yield from _records(member)


_said: set[str] = set()


def _say(what: str, error: Exception) -> None:
    """One line of log for all kernels of this process: a place that fails one of them fails them all."""
    if what not in _said:
        _said.add(what)
        log.warning("%s: %s: %s", what, type(error).__name__, error)
