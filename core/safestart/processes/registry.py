"""The processes by id; one line each. Specs are light: importing them loads no engine."""

from __future__ import annotations

from functools import cache

from safestart.errors import NotFound
from safestart.processes.base import ProcessSpec
from safestart.runtime.named import misregistered, module_of

_SPECS = {
    "go-no-go": "safestart.processes.go_no_go.spec",
    "certificate": "safestart.processes.certificate.spec",
    "start-in-space": "safestart.processes.start_in_space.spec",
    "elliptic-start": "safestart.processes.elliptic_start.spec",
    "safe-region": "safestart.processes.safe_region.spec",
    "thrust-map": "safestart.processes.thrust_map.spec",
    "flight": "safestart.processes.flight.spec",
    "flight-in-space": "safestart.processes.flight_in_space.spec",
    "atlas": "safestart.processes.atlas.spec",
    "atlas-in-space": "safestart.processes.atlas_in_space.spec",
    "region-in-space": "safestart.processes.region_in_space.spec",
    "coverage": "safestart.processes.coverage.spec",
    "benchmark": "safestart.processes.benchmark.spec",
    "plane-benchmark": "safestart.processes.plane_benchmark.spec",
    "passive-safety": "safestart.processes.passive_safety.spec",
    "safe-abort-map": "safestart.processes.safe_abort_map.spec",
    "collision-avoidance": "safestart.processes.collision_avoidance.spec",
    "inclusion-chain": "safestart.processes.inclusion_chain.spec",
    "sweep": "safestart.processes.sweep.spec",
    "sweep-in-space": "safestart.processes.sweep_in_space.spec",
    "trade-study": "safestart.processes.trade_study.spec",
    "tracking-mpc": "safestart.processes.tracking_mpc.spec",
    "commit-timeline": "safestart.processes.commit_timeline.spec",
    "hop-time": "safestart.processes.hop_time.spec",
    "hop-angles": "safestart.processes.hop_angles.spec",
    "hop-plan": "safestart.processes.hop_plan.spec",
    "hopping": "safestart.processes.hopping.spec",
    "approach-trade": "safestart.processes.approach_trade.spec",
    "passive-abort": "safestart.processes.passive_abort.spec",
    "backward-variants": "safestart.processes.backward_variants.spec",
    "hold-region": "safestart.processes.hold_region.spec",
}

PROCESS_IDS = tuple(_SPECS)


@cache
def process(process_id: str) -> ProcessSpec:
    """Return the spec of a process; raises ``NotFound`` that names the known ones."""
    if process_id not in _SPECS:
        raise NotFound(
            f"no process {process_id!r}; there are: {', '.join(PROCESS_IDS)}",
            field="processID",
            required=f"one of {', '.join(PROCESS_IDS)}",
            received=process_id,
        )
    entry = f"process {process_id}"
    spec = getattr(module_of(_SPECS[process_id], entry), "SPEC", None)
    if not isinstance(spec, ProcessSpec):
        raise misregistered(entry, f"a ProcessSpec named SPEC in {_SPECS[process_id]}", spec)
    if spec.id != process_id:
        raise misregistered(entry, f"its id in {_SPECS[process_id]}", spec.id)
    return spec
