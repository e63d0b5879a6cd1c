"""Run approach-trade: one approach planned, flown, proved and remedied; all of them with their picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from safestart.campaign.case import Case
from safestart.campaign.part import Part
from safestart.hopping.approach import Approach
from safestart.hopping.barrier import Noise
from safestart.hopping_flights.fly import OFF, World
from safestart.hopping_safety.away import least_away
from safestart.hopping_safety.tightening import flown, least_tightening
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.prove import greatest_scale
from safestart.processes.approach_trade.plots import picture
from safestart.processes.approach_trade.spec import ApproachTradeInputs
from safestart.processes.approach_trade.study import NUMBERS, plan_of, study_of, summary
from safestart.processes.base import ProcessOutput
from safestart.runtime.progress import Context


def shard(part: dict[str, Any], context: Context) -> Part:
    """One approach."""
    inputs = ApproachTradeInputs.model_validate(part["inputs"])
    return study_of(inputs).simulated(part, partial(priced, inputs), context, "approach")


def priced(inputs: ApproachTradeInputs, case: Case, context: Context) -> dict[str, Any]:
    """Time, fuel, risk, error level, and what it takes to meet the demand."""
    angle, hold = case.parameters["angle_deg"], case.parameters["hold_m"]
    hops = int(case.parameters["hops"])
    plan = plan_of(inputs, angle, hops, hold)
    out: dict[str, Any] = dict.fromkeys(NUMBERS)
    out |= {"angle_deg": angle, "hold_m": hold, "hops": float(hops), "kappa_breaches": None}
    out |= {"orbits": plan.orbits, "time_s": float(plan.times[-1])}
    out |= {"fuel_1norm_m_s": plan.fuel_1norm, "fuel_2norm_m_s": plan.fuel_2norm}
    level = error_level(inputs, plan)
    out["lambda"] = level
    if level < inputs.demand.error_level:
        out |= _away(inputs, plan)
    return out | _risk(inputs, world_of(inputs, angle, hops, hold), context)


def _risk(inputs: ApproachTradeInputs, world: World, context: Context) -> dict[str, Any]:
    """Flights without a barrier, with the numbers of the process hopping; then tightened ones where it takes them."""
    stages = 1 + 2 * len(inputs.kappas)
    done = 0

    def tick(run: int, label: str) -> None:
        nonlocal done
        done += run == 0
        context.step(done - 1 + run / inputs.runs, stages, label)

    def drawn(stream: int, run: int) -> np.random.Generator:
        return Case(run, inputs.seed).generator(stream)

    plain = flown(world, partial(drawn, 0), inputs.runs, tick=tick)
    assert plain is not None, "flights without a limit are flown to the end"
    out: dict[str, Any] = {"breaches": plain.breaches, "lost": plain.lost}
    if plain.shown <= inputs.demand.breach:
        return out
    found = least_tightening(
        world,
        inputs.kappas,
        partial(drawn, 0),
        partial(drawn, 1),
        inputs.runs,
        inputs.demand.breach,
        tick,
    )
    if found is None:
        return out
    kappa, flights = found
    return out | {
        "kappa": kappa,
        # A lost run counts as a breach here: the interval of a confirmed kappa has one count.
        "kappa_breaches": flights.breaches + flights.lost,
        "kappa_fuel_1norm_m_s": flights.fuel_1norm,
        "kappa_fuel_2norm_m_s": flights.fuel_2norm,
        "kappa_hold_m": flights.hold,
    }


def _away(inputs: ApproachTradeInputs, plan: Approach) -> dict[str, Any]:
    """The least drift away that is proved at the demanded level; nothing where there is none."""
    scaled = errors_of(inputs).scaled(inputs.demand.error_level)
    found = least_away(plan, inputs.keep_out_m, _horizon(inputs, plan), scaled)
    if found is None:
        return {}
    level = error_level(inputs, found.approach)
    # Single hops are proved; the whole plan may still fail before its first impulse.
    if level < inputs.demand.error_level * (1.0 - 2e-3):
        return {}
    return {
        "away_m": float(found.added.max()),
        "away_orbits": found.approach.orbits,
        "away_fuel_1norm_m_s": found.approach.fuel_1norm,
        "away_fuel_2norm_m_s": found.approach.fuel_2norm,
        "away_lambda": level,
    }


def error_level(inputs: ApproachTradeInputs, plan: Approach) -> float:
    """lambda of a plan's hops, at most 100 (where sigma is 0 everywhere and the hops keep out)."""
    states = plan.states()[0].tolist()
    flight = Plan.of(plan.mean_motion, states, plan.times[:-1].tolist(), plan.impulses[:-1])
    question = Question(flight, inputs.keep_out_m, _horizon(inputs, plan), errors_of(inputs))
    return greatest_scale(question)


def errors_of(inputs: ApproachTradeInputs) -> Errors:
    """A box of one standard deviation."""
    sigma = inputs.sigma
    at, fast = sigma.position_m, sigma.velocity_m_s
    return Errors((at, at, at), (fast, fast, fast), sigma.thrust_share, math.radians(sigma.thrust_deg))


def _horizon(inputs: ApproachTradeInputs, plan: Approach) -> float:
    return inputs.abort_orbits * math.tau / plan.mean_motion


def world_of(inputs: ApproachTradeInputs, angle_deg: float, hops: int, hold: float) -> World:
    """The approach in SI, without a barrier."""
    sigma = inputs.sigma
    noise = Noise(sigma.position_m, sigma.velocity_m_s, sigma.thrust_share, math.radians(sigma.thrust_deg))
    return replace(
        World(barrier=OFF, noise=noise, inclination=math.radians(inputs.inclination_deg)),
        semi_major_axis=inputs.semi_major_axis_m,
        eccentricity=inputs.eccentricity,
        angle_deg=angle_deg,
        start=inputs.start_m,
        hold=hold,
        hops=hops,
        keep_out=inputs.keep_out_m,
        abort_orbits=inputs.abort_orbits,
    )


def merge(inputs: ApproachTradeInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """All approaches, findings and picture."""
    document = summary(inputs, [part.document for part in parts])
    context.step(0, 1, "picture")
    return ProcessOutput(document, (picture(inputs, document),))
