"""`decide`: the exact answer on one start, with its proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body
from safestart.dynamics.cwh import Cwh
from safestart.errors import invalid
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide as decide_start
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Floats, Rest, Scenario
from safestart.optim.prediction import prediction_of
from safestart.processes.go_no_go.question import sentence, with_arrival
from safestart.processes.go_no_go.question_fields import AfterArrival
from safestart.processes.wire import DT_S
from safestart.public.controllers import Pilot
from safestart.public.shown import COLOURS, Shown
from safestart.public.starts import point_of, rest_of, seconds
from safestart.simulation.starts import steps_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from safestart.proofs.single import Verified

Asked = Literal["stay", "synchronize"]
_PARTS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Decision(Shown):
    """The verdict on one start at rest, and its proof.

    ``start_m`` (d,), body frame, metres. ``verdict``: ``GO``, ``NO_GO`` or ``UNDECIDED``. ``margin_m``: for GO some
    thrust history keeps at least this distance from every face, for NO_GO every one is at some time at least this far
    outside (negative); NaN otherwise. ``reason`` is one sentence. ``proof`` is the document for `verify`; None when the
    verdict is UNDECIDED.
    """

    scenario: Scenario
    start_m: Floats
    rest: Rest
    verdict: str
    margin_m: float
    reason: str
    proof: dict[str, Any] | None

    @property
    def go(self) -> bool:
        """Whether the verdict is GO."""
        return self.verdict == "GO"

    @property
    def thrust_m_s2(self) -> Floats:
        """The thrust history of a GO, (N, d), LVLH, m/s², each row held for 2 s; (0, d) without a GO."""
        held = (self.proof or {}).get("thrust_m_s2", [])
        return np.array(held, dtype=np.float64).reshape(-1, len(self.start_m))

    def verify(self) -> Verified:
        """Check the proof in ball arithmetic; raises as `safestart.verify`, and ``InvalidInput`` without a proof."""
        from safestart.public.proofs import verify

        if self.proof is None:
            raise invalid("proof", "a decided verdict", self.verdict)
        return verify(self.proof)

    def pilot(self, *, duration_s: float = 600.0) -> Pilot:
        """The controller of a GO with ``after_arrival="hold"``: its thrust history, then the LQR that holds it there.

        For `fly` or any simulator, with a command every 2 s for ``duration_s`` seconds. Raises ``InvalidInput`` for
        another decision, or a duration out of range.
        """
        from safestart.control.hold.arrive_and_hold import ArriveAndHold
        from safestart.control.hold.hold_lqr import hold_of

        found = (self.proof or {}).get("hold_after")
        if found is None:
            raise invalid("pilot", "a GO of synchronize with after_arrival hold", self.verdict)
        gain, cost, point = (np.array(found[key]) for key in ("gain", "cost", "point_m"))
        target, most = self.scenario.target, self.scenario.chaser.max_acceleration
        hold = hold_of(gain, cost, point, target.tumble_rate, target.mean_motion, DT_S, most)
        return Pilot("hold", ArriveAndHold(self.thrust_m_s2, hold), DT_S, steps_of(duration_s, DT_S))

    def facts(self) -> Mapping[str, object]:
        """Verdict, margin and reason."""
        margin = "none" if np.isnan(self.margin_m) else f"{self.margin_m:.6g} m"
        return {"verdict": self.verdict, "margin": margin, "reason": self.reason}

    def columns(self) -> Mapping[str, Any]:
        """The flight of the proof, one row every half second; the start alone without one."""
        times, body = self._flight()
        return {"time_s": times, **dict(zip(("x_m", "y_m", "z_m"), body.T, strict=False))}

    def draw(self, axes: Axes) -> None:
        """The start in the corridor, and the flight of a GO in the body frame."""
        from safestart.processes.plotting import draw_corridor

        _, body = self._flight()
        draw_corridor(axes, self.scenario.corridor, 1.2 * max(float(body[:, 1].max()), 10.0))
        colour = COLOURS[self.verdict]
        axes.plot(body[:, 0], body[:, 1], color=colour, linewidth=1.2, zorder=3)
        axes.plot(*body[0, :2], marker="o", color=colour, zorder=4)
        axes.set_title(f"{self.verdict}: {self.reason}", fontsize=8, wrap=True)

    def _flight(self) -> tuple[Floats, Floats]:
        """Times (T,) in seconds and body-frame positions (T, d) of the proof's thrust."""
        thrust, d = self.thrust_m_s2, len(self.start_m)
        if not len(thrust):
            return np.zeros(1), self.start_m[None]
        rate = self.scenario.target.tumble_rate
        motion = Cwh(self.scenario.target.mean_motion)
        flown = prediction_of(motion, DT_S, len(thrust), d, _PARTS).flight(
            state_at_rest(self.scenario, self.start_m, self.rest), thrust
        )
        states = np.concatenate([flown[:, :-1].reshape(-1, 2 * d), flown[-1, -1:]])
        times: Floats = DT_S / _PARTS * np.arange(len(states), dtype=np.float64)
        return times, lvlh_to_body(states[:, :d], states[:, d:], rate, times)[0]


def decide(
    scenario: Scenario,
    start: ArrayLike,
    rest: Rest | str = Rest.LVLH,
    *,
    question: Asked = "stay",
    horizon_s: float = 60.0,
    within_s: float = 200.0,
    after_arrival: AfterArrival = "stay",
) -> Decision:
    """Can any thrust history keep the chaser in the rotating corridor? (docs/theory/exact.md)

    ``start`` (2,) or (3,): body-frame position in metres, at rest in LVLH or in the body frame (``rest``). ``stay``: in
    the corridor at all times of ``horizon_s`` seconds; ``synchronize``: in addition, at rest in the body frame in the
    ball around the hold point at some time within ``within_s`` seconds; its GO needs a proof of what comes
    ``after_arrival``: ``stay``, that the chaser can stay for ever; ``hold``, that an LQR keeps it there (planar);
    ``any``: nothing is asked. Thrust is held over intervals of 2 s. Raises ``InvalidInput`` for other inputs; a failure
    of the solver is UNDECIDED.
    """
    point, rest = point_of(start), rest_of(rest)
    goal, span = asked_of(question, horizon_s, within_s)
    asked = Question(scenario, DT_S, round(span / DT_S), len(point), goal)
    state = state_at_rest(scenario, point, rest)
    if after_arrival not in get_args(AfterArrival):
        raise invalid("after_arrival", "stay, hold or any", after_arrival)
    (answer,) = with_arrival(after_arrival, asked, [state], [decide_start(asked, state)])
    return Decision(
        scenario,
        point,
        rest,
        answer.verdict.value,
        answer.proved_m,
        sentence(asked, answer),
        None if answer.verdict is Verdict.UNDECIDED else proof_of(asked, state, answer),
    )


def asked_of(question: str, horizon_s: float, within_s: float) -> tuple[Goal | None, float]:
    """The goal of a question and its span in seconds; raises ``InvalidInput`` for another question."""
    if question == "stay":
        return None, seconds("horizon_s", horizon_s)
    if question == "synchronize":
        return Goal(), seconds("within_s", within_s)
    raise invalid("question", "stay or synchronize", question)


def state_at_rest(scenario: Scenario, point: Floats, rest: Rest) -> Floats:
    """LVLH state (2 d,) of a start at rest."""
    spin = scenario.target.tumble_rate if rest is Rest.BODY else 0.0
    return np.concatenate(body_to_lvlh(point, np.zeros(len(point)), spin, 0.0))
