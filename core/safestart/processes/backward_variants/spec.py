"""backward-variants: nominal, robust and stochastic backward reachable sets of a linear system (paper 000, sec. 3)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from safestart.model.scenario import MAX_MEAN_MOTION
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.views import Column, Rows
from safestart.processes.wire import Pair, Seed

Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Width = Annotated[float, Field(ge=0, le=1e9)]
Vector = Annotated[list[Number], Field(min_length=2, max_length=8)]
Widths = Annotated[list[Width], Field(max_length=8)]
MOST_WORK = 40_000


class MatricesInput(WireModel):
    """x(k+1) = A x(k) + B u(k); the state has 2 to 8 components, in any units."""

    kind: Literal["matrices"] = "matrices"
    a: list[Vector] = Field(
        [[1.0, 1.0], [0.0, 1.0]], min_length=2, max_length=8, description="A by rows; invertible."
    )
    b: list[Annotated[list[Number], Field(min_length=1, max_length=8)]] = Field(
        [[0.0], [1.0]], min_length=2, max_length=8, description="B by rows."
    )


class PlanarCwhInput(WireModel):
    """CWH in the plane, state (x, y, vx, vy) in m and m/s, thrust (ax, ay) in m/s^2, held over each step."""

    kind: Literal["planar_cwh"]
    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s.")
    dt_s: float = Field(2.0, gt=0, le=600, description="Length of a step, s.")


System = Annotated[MatricesInput | PlanarCwhInput, Field(discriminator="kind")]


class BackwardVariantsInputs(WireModel):
    """The system, the box to reach, limits, disturbance and noise; units are those of the state and of the inputs."""

    system: System = Field(default_factory=MatricesInput)
    input_half_widths: Annotated[Widths, Field(min_length=1)] = Field(
        [1.0], description="|u_i| at most this."
    )
    steps: int = Field(5, ge=1, le=60, description="Horizon N, steps.")
    target: Vector = Field([0.0, 0.0], description="Centre of the box to reach at step N.")
    target_half_widths: Widths = Field(
        [1.0, 1.0], description="Its half-widths. A point (zeros) cannot be reached against any disturbance."
    )
    state_limits: list[Width | None] | None = Field(
        None, max_length=8, description="|x_i| at most this at steps 0 .. N-1; null: no limit."
    )
    disturbance_half_widths: Widths = Field(
        [], description="Robust: disturbance added to each component of the state a step; empty: none."
    )
    input_disturbance_half_widths: Widths = Field(
        [], description="Robust: disturbance added to each input; empty: none."
    )
    noise_sigma: Widths = Field(
        [],
        description="Stochastic: deviation of the Gaussian noise added to each component a step; empty: none.",
    )
    input_noise_sigma: Widths = Field(
        [], description="Stochastic: deviation of the noise added to each input; empty: none."
    )
    risk: float = Field(
        0.05, gt=0, le=0.5, description="Stochastic: 1 - the probability of success required."
    )
    plane: tuple[int, int] = Field((0, 1), description="The two components to draw, counted from 0.")
    section: list[Number | None] | None = Field(
        None,
        max_length=8,
        description="Values that hold the other components of the start (a section); null: free (the projection).",
    )
    directions: int = Field(
        24, ge=8, le=96, multiple_of=4, description="Directions of an outline; planar systems need none."
    )
    cloud_draws: int = Field(4000, ge=0, le=200_000, description="Draws of the empirical set; 0: none.")
    flight_draws: int = Field(20_000, ge=0, le=200_000, description="Noisy flights per flown start; 0: none.")
    confidence: float = Field(0.999, gt=0.5, lt=1, description="Of each bound on a success rate.")
    compare_uncoupled: bool = Field(
        True,
        description="planar_cwh: also the double integrator (mean motion 0), and the ratio of the extents.",
    )
    seed: Seed = 0

    @property
    def size(self) -> tuple[int, int]:
        """Components of the state and of the input."""
        return (
            (4, 2) if isinstance(self.system, PlanarCwhInput) else (len(self.system.a), len(self.system.b[0]))
        )

    @model_validator(mode="after")
    def _shapes(self) -> BackwardVariantsInputs:
        n, m = self.size
        if isinstance(self.system, MatricesInput):
            if any(len(row) != n for row in self.system.a):
                raise ValueError("system.a: a square matrix")
            if len(self.system.b) != n or any(len(row) != m for row in self.system.b):
                raise ValueError(f"system.b: {n} rows of one length")
        for name, size, optional in (
            ("input_half_widths", m, False),
            ("target", n, False),
            ("target_half_widths", n, False),
            ("state_limits", n, True),
            ("disturbance_half_widths", n, True),
            ("input_disturbance_half_widths", m, True),
            ("noise_sigma", n, True),
            ("input_noise_sigma", m, True),
            ("section", n, True),
        ):
            value = getattr(self, name)
            if len(value or []) != size and not (optional and not value):
                raise ValueError(f"{name}: {size} values")
        first, second = self.plane
        if first == second or not (0 <= first < n and 0 <= second < n):
            raise ValueError(f"plane: two different components of 0 to {n - 1}")
        if self.section and (self.section[first] is not None or self.section[second] is not None):
            raise ValueError("section: null for the two components of the plane")
        if n > 2 and self.steps**2 * (n + m) ** 2 > MOST_WORK:
            raise ValueError(f"steps: steps^2 (n + m)^2 at most {MOST_WORK} for more than two components")
        return self


class VariantOutput(WireModel):
    """One set; figures are null unless ``code`` is ok."""

    name: str
    side: Literal["exact", "inner", "outer"] = Field(
        description="The set itself, an inner bound (each start in it is sound) or an outer one."
    )
    code: Literal["ok", "empty", "numerical_failure"]
    area: float | None = Field(description="Area of the outline in the plane.")
    low: Pair | None = Field(description="Least values of the two components.")
    high: Pair | None
    beyond_nominal: float | None = Field(
        description="How far it reaches beyond the nominal set, at most over the directions; not positive: inside."
    )


class CloudOutput(WireModel):
    """The empirical set: starts that one drawn noise history carries into the target."""

    starts: int
    outside_nominal: int | None = Field(description="Of them, outside the nominal outline: luck, no control.")
    low: Pair
    high: Pair


class FlownVariantOutput(WireModel):
    """Noisy flights from the boundary of ``chance_open_loop``; the start that succeeded least."""

    starts: int
    draws: int
    required: float
    least_successes: int
    probability_low: float
    probability_high: float


class SystemOutput(WireModel):
    """All sets of one system."""

    name: str
    variants: list[VariantOutput]
    cloud: CloudOutput | None
    flown: FlownVariantOutput | None


class RatioOutput(WireModel):
    """Extents with orbital coupling over those without, along the two components."""

    variant: str
    first: float | None
    second: float | None


class BackwardVariantsOutputs(WireModel):
    """One entry per system; outlines and clouds are in the NPZ artifact."""

    systems: list[SystemOutput]
    coupling_ratios: list[RatioOutput]
    notes: list[str]


SPEC = ProcessSpec(
    id="backward-variants",
    title="Nominal, robust and stochastic backward reachable sets",
    description=(
        "From which states a linear system with box inputs reaches a box in N steps: nominal; robust against a box of "
        "disturbances, with inputs fixed in advance and with inputs that know the state; chance-constrained under "
        "Gaussian noise, from inside and outside; and the empirical set of Iskender et al., section 3. Planar systems "
        "exactly as polygons, others by linear programs. CWH comes with the double integrator and the extents' ratio."
    ),
    inputs=BackwardVariantsInputs,
    outputs=BackwardVariantsOutputs,
    run="safestart.processes.backward_variants.run:run",
    replay_tolerance=1e-6,
    views=(
        Rows(
            "Sets",
            "systems.variants",
            (
                Column("system", "name"),
                Column("set", "variants.name"),
                Column("bound", "variants.side"),
                Column("code", "variants.code"),
                Column("area", "variants.area"),
                Column("from", "variants.low"),
                Column("to", "variants.high"),
                Column("beyond the nominal set", "variants.beyond_nominal"),
            ),
        ),
        Rows(
            "Extents with orbital coupling, over those without",
            "coupling_ratios",
            (Column("set", "variant"), Column("first component", "first"), Column("second", "second")),
        ),
        Rows(
            "Empirical sets and flights",
            "systems",
            (
                Column("system", "name"),
                Column("empirical starts", "cloud.starts"),
                Column("outside the nominal set", "cloud.outside_nominal"),
                Column("success required", "flown.required"),
                Column("least success flown, at least", "flown.probability_low"),
                Column("at most", "flown.probability_high"),
            ),
        ),
    ),
    keywords=("backward reachable set", "robust", "chance constraint", "double integrator"),
    example={
        "system": {"kind": "matrices", "a": [[1, 1], [0, 1]], "b": [[0], [1]]},
        "input_half_widths": [1],
        "steps": 5,
        "target": [0, 0],
        "target_half_widths": [1, 1],
        "state_limits": [5, 5],
        "disturbance_half_widths": [0.05, 0.05],
        "noise_sigma": [0.05, 0.05],
    },
)
