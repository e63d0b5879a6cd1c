"""Read a proof document strictly: required parts, known fields, numbers as exact doubles."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from flint import fmpq

from safestart.errors import SafestartError

LARGEST = 1e7


class ProofRejected(SafestartError):
    """The document proves nothing; the message names the failed inequality, with its numbers."""

    status = 422
    slug = "proof-rejected"
    title = "Proof rejected"


def shown(value: Any, most: int = 60) -> str:
    """A received value for a message: short, and without characters that could forge lines of output."""
    return ascii(value)[:most]


def fields(document: Any, name: str, needed: Collection[str], optional: Collection[str] = ()) -> None:
    """Check that the object ``name`` has every needed field and only needed or optional ones.

    Readers would believe an unknown field although the checker never checks it.
    """
    if not isinstance(document, Mapping):
        raise ProofRejected(f"{name}: required an object, received {type(document).__name__}")
    missing = [key for key in needed if key not in document]
    unknown = [key for key in document if key not in needed and key not in optional]
    if missing or unknown:
        found = [f"{key} missing" for key in missing] + [f"{shown(key, 40)} unknown" for key in unknown[:9]]
        raise ProofRejected(f"{name}: required the fields {', '.join(needed)}: {', '.join(found)}")


def part(document: Any, key: str, kind: type) -> Any:
    """The value under ``key``, of the required type."""
    value = document.get(key) if isinstance(document, Mapping) else None
    if not isinstance(value, kind) or isinstance(value, bool):
        raise ProofRejected(f"{key}: required a {kind.__name__}, received {type(value).__name__}")
    return value


def exact(value: Any, name: str, low: float, high: float = LARGEST) -> fmpq:
    """A number in [low, high], as an exact rational."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ProofRejected(f"{name}: required a number in [{low:g}, {high:g}], received {shown(value)}")
    return fmpq(*value.as_integer_ratio())


def number(document: Any, key: str, low: float, high: float = LARGEST) -> fmpq:
    """The number under ``key``, in [low, high]."""
    if not isinstance(document, Mapping):
        raise ProofRejected(f"{key}: required an object that holds it, received {shown(document)}")
    return exact(document.get(key), key, low, high)


def vector(value: Any, name: str, size: int) -> list[fmpq]:
    """A list of ``size`` numbers."""
    if not isinstance(value, list) or len(value) != size:
        raise ProofRejected(f"{name}: required a list of {size} numbers, received {shown(value)}")
    return [exact(entry, name, -LARGEST) for entry in value]
