"""The engines, one entry each, the only place with facts about an engine. Importing this module loads none of them.

The colours are Okabe and Ito's, with one of Tol's, distinct for every kind of colour vision.
"""

from __future__ import annotations

from safestart.engines.backward_options import BackwardInput
from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.engines.spec import EngineSpec
from safestart.errors import invalid
from safestart.model.registry import by_name

_SPECS = (
    EngineSpec(
        name="certified",
        title="certified (sound)",
        colour="#009E73",
        engine="safestart.engines.analytical:Certified",
        summary="certificate in closed form: explicit manoeuvres with a proof, for ever",
        line=None,
        not_in_space="its manoeuvres are for a spin about the orbit normal, the five faces and starts at rest",
    ),
    EngineSpec(
        name="analytical",
        title="paper's conditions (not sound)",
        colour="#E69F00",
        engine="safestart.engines.analytical:Analytical",
        summary="the closed form of Iskender et al., not sound: directional erosion and synchronization range",
        not_in_space="the paper's conditions are planar",
    ),
    EngineSpec(
        name="exact",
        title="exact",
        colour="#000000",
        engine="safestart.engines.exact:Exact",
        summary="exact reachable set by support functions: disk input, tube or fixed time, no grid",
        screen_colour="#3B6FD4",
        in_space="safestart.engines.space.reach:Exact",
    ),
    EngineSpec(
        name="backward",
        title="backward (box input)",
        colour="#0072B2",
        engine="safestart.engines.backward:Backward",
        summary="backward reachable set, nominal or robust: box input, zero-order hold, exact zonotope test",
        options=BackwardInput,
        line="--",
        in_space="safestart.engines.space.reach:Backward",
    ),
    EngineSpec(
        name="forward",
        title="forward (outer)",
        colour="#56B4E9",
        engine="safestart.engines.forward:Forward",
        summary="forward reachable set: 48 template supports, outer approximation of the box input's set",
        line=":",
        in_space="safestart.engines.space.forward:Forward",
    ),
    EngineSpec(
        name="hamilton_jacobi",
        title="Hamilton-Jacobi",
        colour="#D55E00",
        engine="safestart.engines.hamilton_jacobi:HamiltonJacobi",
        summary="Hamilton-Jacobi level sets on a grid (own solver, or hj-reachability)",
        options=HamiltonJacobiInput,
        share=40.0,
        not_in_space="its grid has two positions and two velocities: planar",
    ),
    EngineSpec(
        name="monte_carlo",
        title="Monte Carlo (flown)",
        colour="#CC79A7",
        engine="safestart.engines.monte_carlo:MonteCarlo",
        summary="closed-loop flights of the three-regime controller and its safety filter against exact CWH truth",
        line="-.",
        share=6.0,
        in_space="safestart.engines.space.monte_carlo:MonteCarlo",
    ),
    EngineSpec(
        name="tracking",
        title="tracking MPC (flown)",
        colour="#882255",
        engine="safestart.engines.tracking:Tracking",
        summary="the tracking MPC of Rebollo et al., thrust held in a ball, flown to the port: a plan at every step, "
        "inside at every node",
        line=":",
        share=6.0,
        default=False,
        not_in_space="it starts from the planar grid; method tracking of start-in-space flies single starts",
    ),
)

ENGINES: dict[str, EngineSpec] = by_name("engines", _SPECS, lambda spec: spec.name)
"""By name, in the order in which a benchmark runs them."""


def engine_spec(name: str) -> EngineSpec:
    """The spec of the engine called ``name``; raises ``InvalidInput`` with the known names otherwise."""
    if name not in ENGINES:
        raise invalid("engine", f"one of {', '.join(ENGINES)}", name)
    return ENGINES[name]


def why_not_in_space(name: str, thrust: str) -> str:
    """Why the engine ``name`` cannot answer on a plane of starts in space with ``thrust``s of this kind, or empty."""
    spec = engine_spec(name)
    if not spec.in_space:
        return spec.not_in_space
    if name == "backward" and thrust == "thrusters":
        return "its inputs are bounded axis by axis: a ball or a box of thrusts"
    return ""
