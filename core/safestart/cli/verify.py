"""``safestart verify``: check a proof document in ball arithmetic."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, out, print_json
from safestart.model.unique_names import loads

_MOST_BYTES = 16 * 1024 * 1024


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("verify")
    def verify(
        proof: Annotated[Path, typer.Argument(help="Proof document, JSON; - for standard input.")],
        as_json: Json = False,
    ) -> None:
        """Check a GO or NO_GO proof. Exit code 0: valid, 1: rejected, 2: unreadable."""
        # Ball arithmetic is loaded here and not with every command.
        from safestart.proofs.checker import check
        from safestart.proofs.statement import ProofRejected

        document = _load(proof)
        try:
            verified = check(document)
        except ProofRejected as error:
            if as_json:
                print_json({"valid": False, "reason": error.detail})
            else:
                out.print(f"[bold red]rejected[/]: {error.detail}", soft_wrap=True)
            raise typer.Exit(1) from None
        if as_json:
            print_json(
                {
                    "valid": True,
                    "verdict": verified.verdict,
                    "margin_m": verified.margin_m,
                    "question": document["question"],
                    "start": document["start"],
                }
            )
            return
        colour = "green" if verified.verdict == "GO" else "red"
        bound = "at least" if verified.verdict == "GO" else "at most"
        out.print(f"[bold {colour}]{verified.verdict}[/] proved: margin {bound} {verified.margin_m:.9g} m")
        for line in _statement(document):
            out.print(f"  {line}", soft_wrap=True)


def _load(path: Path) -> Any:
    try:
        if str(path) == "-":
            data = sys.stdin.buffer.read(_MOST_BYTES + 1)
        else:
            with path.open("rb") as file:
                data = file.read(_MOST_BYTES + 1)
        if len(data) > _MOST_BYTES:
            raise ValueError(f"required at most {_MOST_BYTES} bytes")
        return loads(data)
    except (OSError, ValueError, RecursionError) as error:
        sys.stderr.write(f"safestart: {path}: unreadable: {error}\n")
        raise typer.Exit(2) from None


def _statement(document: Any) -> list[str]:
    question, start = document["question"], document["start"]
    horizon = question["dt_s"] * question["steps"]
    rate = _range(question["tumble_rate_rad_s"], math.degrees(1.0))
    thrust, motion = _range(question["max_acceleration_m_s2"]), _range(question["mean_motion_rad_s"])
    around = [
        f" +- {start[key]} {unit}" if key in start else f" {unit}"
        for key, unit in (("position_half_width_m", "m"), ("velocity_half_width_m_s", "m/s"))
    ]
    span = "all times until the end" if "goal" in question else f"all times of [0, {horizon:g}] s"
    return [
        f"stay in the corridor at {span}, thrust held over {question['dt_s']:g} s",
        *_limits(question, horizon),
        f"tumble {rate} deg/s, thrust at most {thrust} m/s^2, mean motion {motion} rad/s",
        f"start (LVLH) {start['position_m']}{around[0]}, {start['velocity_m_s']}{around[1]}",
        *_witness(document),
    ]


def _limits(question: Any, horizon: float) -> list[str]:
    """What is asked for beyond the corridor."""
    goal, speed, keep_out = (question.get(key) for key in ("goal", "speed_limit", "keep_out_m"))
    out = []
    if goal is not None:
        out.append(
            f"at the end, at some time up to {horizon:g} s (step {question['earliest_step']} at the earliest): within "
            f"{goal['radius_m']:g} m of {goal['hold_m']} m and at most {goal['rest_m_s']:g} m/s in the body frame"
        )
    if speed is not None:
        out.append(
            f"at most {speed['most_m_s']:g} m/s in LVLH at all times; 1 m/s counts as {speed['scale_s']:g} m"
        )
    if keep_out:
        out.append(f"keep-out radius {keep_out:g} m: implied by the hold plane")
    return out


def _range(value: Any, factor: float = 1.0) -> str:
    """A number, or an interval as its middle and half-width."""
    if not isinstance(value, list):
        return f"{factor * value:.6g}"
    low, high = value
    return f"{factor * (low + high) / 2:.6g} +- {factor * (high - low) / 2:.3g}"


def _witness(document: Any) -> list[str]:
    """What the proof for a family says of the histories."""
    if "pieces" in document:
        return ["for no member of these intervals does any history stay"]
    if document.get("witness") == "per_corner":
        return [
            "each corner of the start box has a history that stays for all members, each start between a mixture"
        ]
    return ["one history stays for all members"] if "histories" in document else []
