"""Engines by name, loaded when they are first used."""

from __future__ import annotations

from collections.abc import Callable

from safestart.engines.base import Engine
from safestart.engines.registry import engine_spec
from safestart.errors import invalid
from safestart.model.wire_model import WireModel
from safestart.runtime.named import load


def engine(name: str, options: WireModel | None = None) -> Engine:
    """Load the engine called ``name``, with its ``options`` or with their defaults.

    Raises ``InvalidInput`` for an unknown name, and for another engine's options.
    """
    spec = engine_spec(name)
    make: Callable[..., Engine] = load(spec.engine, f"engine of {name}")
    if options is None:
        return make()
    if spec.options is None or not isinstance(options, spec.options):
        wanted = "no options" if spec.options is None else spec.options.__name__
        raise invalid(f"options of {name}", wanted, type(options).__name__)
    return make(options)
