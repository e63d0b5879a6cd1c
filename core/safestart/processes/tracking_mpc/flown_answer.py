"""The tracking MPC's flight from one start as an answer on the wire; shared by the two go-no-go questions."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.control.tracking_mpc.tuning import Tuning
from safestart.engines.tracking_options import TrackingSettings
from safestart.exact.answer import GUARD, Answer, Verdict
from safestart.processes.wire import DT_S, finite
from safestart.tracking.take import Taken

MOST_STARTS = 50


def tuning_of(settings: TrackingSettings | None, acceleration: float) -> Tuning:
    """The controller for thrust in a ball of ``acceleration`` m/s^2, held over 2 s."""
    chosen = settings or TrackingSettings.model_validate({})
    return Tuning(
        DT_S * acceleration,
        chosen.n_c,
        chosen.n_lqr,
        chosen.rho,
        chosen.tau,
        chosen.theta_limit,
        "ball",
    )


def verdict_of(flight: Taken, exact: Answer, *, stays: bool = True) -> tuple[Verdict, str | None]:
    """The verdict, and what decided it.

    GO: the flight arrives, its plans are certified, its distance is proved, and it ``stays`` where that is asked.
    NO_GO: no thrust held over the steps stays.
    """
    if flight.arrived is not None and flight.certified and flight.margin > GUARD and stays:
        return Verdict.GO, "tracking"
    if exact.verdict is Verdict.NO_GO:
        return Verdict.NO_GO, "exact"
    return Verdict.UNDECIDED, None


def sentence(flight: Taken, exact: Answer, told: str, within: float, *, stays: bool = True) -> str:
    """The verdict in words, with the exact answer beside it, which is ``told`` in words."""
    verdict, beside = verdict_of(flight, exact, stays=stays)[0], f"exact: {told}"
    if verdict is Verdict.GO and flight.arrived is not None:
        return (
            f"the tracking MPC arrives: at rest at the port after {flight.arrived * DT_S:g} s, at least "
            f"{flight.margin:.3g} m from every face for {len(flight.thrust) * DT_S:g} s, no plan is ever lost; {beside}"
        )
    if verdict is Verdict.NO_GO:
        return told
    if flight.theta is None:
        lacks = f"the tracking MPC has no plan (least violation {flight.violation:.3g} m)"
    elif flight.lost:
        lacks = f"the tracking MPC loses its plan after {len(flight.thrust) * DT_S:g} s"
    elif flight.arrived is None:
        lacks = f"the tracking MPC keeps its plan, but is not at rest at the port within {within:g} s"
    elif not flight.certified:
        lacks = "the tracking MPC arrives, but not every plan is certified for later steps"
    elif not stays:
        lacks = "the tracking MPC arrives, but nothing proves that the chaser can stay there"
    else:
        lacks = f"the tracking MPC arrives, but comes to {flight.margin:.3g} m of a face between its nodes"
    return f"undecided: {lacks}; {beside}"


def flown_answer(flight: Taken, exact: Answer) -> dict[str, Any]:
    """``TrackingAnswer``."""
    flown = flight.arrived is not None
    return {
        "feasible": flight.theta is not None,
        "arrives_s": flight.arrived * DT_S if flight.arrived is not None else None,
        "certified": flight.certified,
        "margin_m": finite(flight.margin) if flown else None,
        "theta_m": None if flight.theta is None else flight.theta.tolist(),
        "least_violation_m": finite(flight.violation) if flight.violation > 0.0 else None,
        "delta_v_m_s": DT_S * float(np.linalg.norm(flight.thrust, axis=1).sum()) if flown else None,
        "exact_verdict": exact.verdict.value,
        "exact_margin_m": finite(exact.proved_m),
    }
