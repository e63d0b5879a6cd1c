"""Engines by name, loaded when they are first used."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from safestart.engines.base import Engine
from safestart.engines.registry import engine_spec
from safestart.errors import invalid
from safestart.model.wire_model import WireModel


def engine(name: str, options: WireModel | None = None) -> Engine:
    """Load the engine called ``name``, with its ``options`` or with their defaults.

    Raises ``InvalidInput`` for an unknown name, and for another engine's options.
    """
    spec = engine_spec(name)
    module, kind = spec.engine.split(":")
    make: Callable[..., Engine] = getattr(import_module(module), kind)
    if options is None:
        return make()
    if spec.options is None or not isinstance(options, spec.options):
        wanted = "no options" if spec.options is None else spec.options.__name__
        raise invalid(f"options of {name}", wanted, type(options).__name__)
    return make(options)
