"""All questions by name; ``process/example`` is the example that the process declares."""

from __future__ import annotations

from tests.acceptance.digested.calls import AT_ONCE, LONG_COMMANDS, QUICK_COMMANDS, SERVED
from tests.acceptance.digested.long import LONG
from tests.acceptance.digested.quick import QUICK, Inputs

QUICK_EXAMPLES = ("go-no-go", "certificate", "safe-region", "thrust-map", "flight", "coverage", "atlas")
"""Processes whose example takes a second or so."""


def quick_names() -> list[str]:
    """The questions that CI asks."""
    return [f"{process_id}/example" for process_id in QUICK_EXAMPLES] + list(QUICK) + list(QUICK_COMMANDS)


def names() -> list[str]:
    """Every question, quick ones first."""
    from safestart.processes.registry import PROCESS_IDS

    others = [f"{process_id}/example" for process_id in PROCESS_IDS if process_id not in QUICK_EXAMPLES]
    return quick_names() + others + list(LONG) + list(LONG_COMMANDS) + served_names()


def served_names() -> list[str]:
    """The questions that are asked over HTTP."""
    from safestart.processes.registry import PROCESS_IDS

    jobs = [f"{process_id}/example" for process_id in PROCESS_IDS] + list(SERVED)
    return list(AT_ONCE) + [f"service/{name}" for name in jobs]


def asked(name: str) -> tuple[str, tuple[Inputs, ...]]:
    """Process and inputs of a question, in sequence; ``example`` is the example that the process declares."""
    from safestart.processes.registry import process

    process_id, _, what = name.partition("/")
    inputs = dict(process(process_id).example) if what == "example" else (QUICK | LONG)[name]
    return process_id, inputs if isinstance(inputs, tuple) else (inputs,)
