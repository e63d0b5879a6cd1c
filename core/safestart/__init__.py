"""safestart: may this chaser start its approach to that tumbling target?

Only the names below are public; docs/python.md describes them with units and shapes. Each is loaded at its first use.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0"

if TYPE_CHECKING:
    from safestart.errors import SafestartError as SafestartError
    from safestart.model.scenario import Chaser as Chaser
    from safestart.model.scenario import CorridorShape as Corridor
    from safestart.model.scenario import Rest as Rest
    from safestart.model.scenario import Scenario as Scenario
    from safestart.model.scenario import Target as Target
    from safestart.public.certificates import certify as certify
    from safestart.public.client import Client as Client
    from safestart.public.controllers import controller as controller
    from safestart.public.decisions import decide as decide
    from safestart.public.flights import fly as fly
    from safestart.public.proofs import verify as verify
    from safestart.public.regions import region as region
    from safestart.public.results import run as run

__all__ = [
    "Chaser",
    "Client",
    "Corridor",
    "Rest",
    "SafestartError",
    "Scenario",
    "Target",
    "certify",
    "controller",
    "decide",
    "fly",
    "region",
    "run",
    "verify",
]

_PLACES = {
    "Chaser": "model.scenario",
    "Client": "public.client",
    "Corridor": "model.scenario",
    "Rest": "model.scenario",
    "SafestartError": "errors",
    "Scenario": "model.scenario",
    "Target": "model.scenario",
    "certify": "public.certificates",
    "controller": "public.controllers",
    "decide": "public.decisions",
    "fly": "public.flights",
    "region": "public.regions",
    "run": "public.results",
    "verify": "public.proofs",
}
_CALLED = {"Corridor": "CorridorShape"}


if not TYPE_CHECKING:  # a type checker sees only the names above

    def __getattr__(name: str) -> Any:
        """A public name, loaded at its first use."""
        if name not in _PLACES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        found = getattr(import_module(f"{__name__}.{_PLACES[name]}"), _CALLED.get(name, name))
        globals()[name] = found
        return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
