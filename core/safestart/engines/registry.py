"""The engines by name; one line each. Engines are imported when first used."""

from __future__ import annotations

from importlib import import_module

from safestart.engines.base import Engine
from safestart.errors import invalid

_ENGINES = {
    "analytical": "safestart.engines.analytical:Analytical",
    "exact": "safestart.engines.exact:Exact",
    "backward": "safestart.engines.backward:Backward",
    "forward": "safestart.engines.forward:Forward",
    "hamilton_jacobi": "safestart.engines.hamilton_jacobi:HamiltonJacobi",
    "monte_carlo": "safestart.engines.monte_carlo:MonteCarlo",
}

ENGINE_NAMES = tuple(_ENGINES)


def engine(name: str) -> Engine:
    """Return the engine called ``name``; raises ``InvalidInput`` with the known names otherwise."""
    if name not in _ENGINES:
        raise invalid("engine", f"one of {', '.join(ENGINE_NAMES)}", name)
    module, kind = _ENGINES[name].split(":")
    instance: Engine = getattr(import_module(module), kind)()
    return instance
