"""Reading a proof document strictly: the parts that must be there, every number the double it is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import fmpq

from safestart.errors import SafestartError

LARGEST = 1e7


class ProofRejected(SafestartError):
    """The document proves nothing; the message names the inequality that fails, with its numbers."""

    status = 422
    slug = "proof-rejected"
    title = "Proof rejected"


def part(document: Any, key: str, kind: type) -> Any:
    """The value under ``key``, of the type asked for."""
    value = document.get(key) if isinstance(document, Mapping) else None
    if not isinstance(value, kind) or isinstance(value, bool):
        raise ProofRejected(f"{key}: required a {kind.__name__}, received {type(value).__name__}")
    return value


def exact(value: Any, name: str, low: float, high: float = LARGEST) -> fmpq:
    """A number in [low, high] as the rational it is."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ProofRejected(f"{name}: required a number in [{low:g}, {high:g}], received {str(value)[:60]}")
    return fmpq(*value.as_integer_ratio())


def number(document: Any, key: str, low: float, high: float = LARGEST) -> fmpq:
    """The number under ``key``, in [low, high]."""
    if not isinstance(document, Mapping):
        raise ProofRejected(f"{key}: required an object that holds it, received {str(document)[:60]}")
    return exact(document.get(key), key, low, high)


def vector(value: Any, name: str, size: int) -> list[fmpq]:
    """A list of ``size`` numbers."""
    if not isinstance(value, list) or len(value) != size:
        raise ProofRejected(f"{name}: required a list of {size} numbers, received {str(value)[:60]}")
    return [exact(entry, name, -LARGEST) for entry in value]
