"""Presets of tracking-mpc: every one is a question that the process takes, about a target of its own."""

from safestart.processes.registry import process
from safestart.processes.tracking_mpc.targets import TARGETS


def test_presets_are_inputs_and_differ() -> None:
    spec = process("tracking-mpc")
    found = {name: spec.parse(inputs) for name, inputs in spec.extensions["safestart:examples"].items()}
    assert list(found) == list(TARGETS)
    bodies = {(str(one.inertia_kg_m2), str(one.body_rate_deg_s)) for one in found.values()}
    assert len(bodies) == len(TARGETS)
    assert found["Envisat"] == spec.parse(spec.example)
