"""Results from elsewhere: whether they have the shape that tables, files and pages of a process need.

A bundle can hold outputs that no process makes: anyone can write one and seal it. Results of an older or newer version
of ours have fields more or fewer, further words, other bounds; what they do not have is a list for a number.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from safestart.errors import InvalidInput, UnfitResult
from safestart.processes.tables.typed import known_process, typed_tables
from safestart.records.provenance import source

T = TypeVar("T")
# What code raises that meets another value than it was written for.
_MISFITS = (TypeError, ValueError, LookupError, AttributeError, ArithmeticError, NotImplementedError)


def require_shape(result: Mapping[str, Any], field: str) -> None:
    """Raise ``InvalidInput`` at ``field`` for outputs that the result's process cannot make.

    Those of this very source must fit the process's description; those of another version of ours have its kinds of
    values. Of a process that is not known here nothing is asked but tables that can be read.
    """
    spec = known_process(result)
    ours = result.get("provenance", {}).get("source_sha256") == source()
    try:
        if spec is not None:
            spec.check(result["outputs"], another_version=not ours)
        fit_for(result, lambda: typed_tables(result))
    except UnfitResult as error:
        raise InvalidInput(
            f"{field}.{error.detail}",
            field=f"{field}.{error.field or 'outputs'}",
            required=error.required,
            received=error.received,
        ) from None


def fit_for(result: Mapping[str, Any], make: Callable[[], T]) -> T:
    """What ``make`` makes of a result; raises ``UnfitResult`` where it fails as the result does not fit its process.

    A failure with a result that fits is a mistake of ours and stays what it is.
    """
    try:
        return make()
    except _MISFITS as error:
        spec = known_process(result)
        if spec is not None:
            spec.check(result["outputs"])
            raise
        required = "outputs that make tables and arrays"
        raise UnfitResult(
            f"outputs: required {required}, received others ({type(error).__name__})",
            field="outputs",
            required=required,
        ) from error
