"""Run backward-variants: the sets of each system, their ratios, the empirical set, flights from the boundary."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Floats
from safestart.processes.backward_variants.plots import picture
from safestart.processes.backward_variants.spec import BackwardVariantsInputs, MatricesInput, PlanarCwhInput
from safestart.processes.base import ProcessOutput
from safestart.processes.plotting import npz
from safestart.runtime.progress import Context
from safestart.sets.backward import chance, program
from safestart.sets.backward.cloud import empirical, succeeded
from safestart.sets.backward.polygon import area, faces
from safestart.sets.backward.question import Question
from safestart.sets.backward.variants import NAMES, Plane, Variant, variants

_FLOWN = 8
# Rounding and the solver's tolerance (1e-7 a row), against which points of a cloud count as inside.
_TOLERANCE = 1e-6


def run(inputs: BackwardVariantsInputs, context: Context) -> ProcessOutput:
    """Sets, tables, pictures. A set that a solver could not find keeps its row with its code."""
    plane = _plane(inputs)
    systems, shown = [], []
    asked = _systems(inputs)
    total = len(asked) * len(NAMES) + 1
    arrays: dict[str, Floats] = {}
    for index, (name, a, b) in enumerate(asked):
        question = _question(inputs, a, b)
        found: dict[str, Variant] = {}
        for one in variants(question, inputs.risk, plane):
            found[one.name] = one
            context.step(index * len(NAMES) + len(found), total, one.name)
            if one.outline is not None:
                arrays[f"{name}_{one.name}"] = one.outline
        cloud = _cloud(inputs, question)
        if cloud is not None:
            arrays[f"{name}_cloud"] = cloud
        systems.append(
            {
                "name": name,
                "variants": [_row(found[each], found["nominal"]) for each in NAMES if each in found],
                "cloud": _cloud_row(cloud, found["nominal"], plane if len(a) > 2 else None),
                "flown": _flown(inputs, question, plane),
            }
        )
        shown.append((name, found, cloud))
    document = {"systems": systems, "coupling_ratios": _ratios(shown), "notes": _notes(inputs)}
    artifacts = (npz("outlines.npz", arrays), picture(inputs, shown))
    context.step(total, total)
    return ProcessOutput(document, artifacts)


def _plane(inputs: BackwardVariantsInputs) -> Plane:
    section = inputs.section or []
    fixed = {k: value for k, value in enumerate(section) if value is not None}
    return Plane(inputs.plane, inputs.directions, fixed)


def _systems(inputs: BackwardVariantsInputs) -> list[tuple[str, Floats, Floats]]:
    system = inputs.system
    if isinstance(system, MatricesInput):
        return [("system", np.array(system.a), np.array(system.b))]
    assert isinstance(system, PlanarCwhInput)
    named = [("cwh", system.mean_motion_rad_s)]
    if inputs.compare_uncoupled:
        named.append(("double_integrator", 0.0))
    return [(name, planar_transition(n, system.dt_s), planar_input(n, system.dt_s)) for name, n in named]


def _question(inputs: BackwardVariantsInputs, a: Floats, b: Floats) -> Question:
    n, m = b.shape

    def added(state: list[float], through: list[float]) -> Floats:
        both = np.concatenate([np.diag(state or [0.0] * n), b @ np.diag(through or [0.0] * m)], axis=1)
        return both[:, both.any(axis=0)]

    limits = [np.inf if value is None else value for value in inputs.state_limits or [None] * n]
    return Question(
        a,
        b,
        np.array(inputs.input_half_widths),
        np.array(inputs.target),
        np.array(inputs.target_half_widths),
        inputs.steps,
        np.array(limits),
        added(inputs.disturbance_half_widths, inputs.input_disturbance_half_widths),
        added(inputs.noise_sigma, inputs.input_noise_sigma),
    )


def _row(one: Variant, nominal: Variant) -> dict[str, Any]:
    beyond = None
    if one.reach is not None and nominal.reach is not None:
        beyond = float((one.reach - nominal.reach).max())
    low, high = (None, None) if one.outline is None else (one.outline.min(axis=0), one.outline.max(axis=0))
    return {
        "name": one.name,
        "side": one.side,
        "code": one.code,
        "area": None if one.outline is None else area(one.outline),
        "low": None if low is None else low.tolist(),
        "high": None if high is None else high.tolist(),
        "beyond_nominal": beyond,
    }


def _cloud(inputs: BackwardVariantsInputs, question: Question) -> Floats | None:
    """Points (P, 2) in the plane; a section has none, as a draw hits it with probability 0."""
    if not inputs.cloud_draws or any(value is not None for value in inputs.section or []):
        return None
    states = empirical(question, inputs.cloud_draws, inputs.plane, inputs.seed)
    return states[:, list(inputs.plane)] if len(states) else None


def _cloud_row(cloud: Floats | None, nominal: Variant, plane: Plane | None) -> dict[str, Any] | None:
    """``plane``: count only points beyond the reach in one of its directions, which is certain."""
    if cloud is None:
        return None
    outside = None
    if nominal.outline is not None and nominal.reach is not None:
        normals, offsets = faces(nominal.outline) if plane is None else (plane.units(), nominal.reach)
        room = offsets - cloud @ normals.T
        outside = int((room.min(axis=1) < -_TOLERANCE).sum())
    return {
        "starts": len(cloud),
        "outside_nominal": outside,
        "low": cloud.min(axis=0).tolist(),
        "high": cloud.max(axis=0).tolist(),
    }


def _flown(inputs: BackwardVariantsInputs, question: Question, plane: Plane) -> dict[str, Any] | None:
    """Fly starts on the boundary of the chance-constrained set with their own inputs."""
    one = program.open_loop(question, chance.joint(question, inputs.risk))
    if one is None or not inputs.flight_draws:
        return None
    counts: list[int] = []
    for unit in Plane(plane.axes, _FLOWN, {}).units():
        direction = np.zeros(one.size)
        direction[list(plane.axes)] = unit
        try:
            found = one.furthest(direction, plane.fixed)
        except ArithmeticError:
            return None
        if found is None:
            return None
        plan = found[1].reshape(question.steps, -1)
        counts.append(succeeded(question, found[0], plan, inputs.flight_draws, inputs.seed + len(counts)))
    low, high = chance.bounds(min(counts), inputs.flight_draws, inputs.confidence)
    return {
        "starts": len(counts),
        "draws": inputs.flight_draws,
        "required": 1.0 - inputs.risk,
        "least_successes": min(counts),
        "probability_low": low,
        "probability_high": high,
    }


def _ratios(shown: list[tuple[str, dict[str, Variant], Floats | None]]) -> list[dict[str, Any]]:
    if len(shown) < 2:
        return []
    out: list[dict[str, Any]] = []
    for name in (each for each in NAMES if each in shown[0][1]):
        lines = [found[name].outline for _, found, _ in shown]
        if lines[0] is None or lines[1] is None:
            out.append({"variant": name, "first": None, "second": None})
            continue
        ours, other = np.ptp(lines[0], axis=0), np.ptp(lines[1], axis=0)
        ratio = [float(a / b) if b > 0.0 else None for a, b in zip(ours, other, strict=True)]
        out.append({"variant": name, "first": ratio[0], "second": ratio[1]})
    return out


def _notes(inputs: BackwardVariantsInputs) -> list[str]:
    notes = [
        "The empirical set holds starts that one drawn noise history carries into the target. It reaches beyond the "
        "nominal set by luck and says nothing of the probability; the chance-constrained sets do.",
        "A flown success rate is of inputs fixed in advance. Each bound on it is wrong with probability "
        f"{1.0 - inputs.confidence:g} at most.",
    ]
    if inputs.size[0] > 2:
        notes.append(
            "robust_feedback holds the starts for which a policy affine in the past disturbances works; "
            "robust_feedback_outer bounds what any policy can do."
        )
    return notes
