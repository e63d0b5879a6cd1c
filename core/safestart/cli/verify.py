"""``safestart verify``: check a proof document in ball arithmetic."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, out, print_json

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
        from safestart.certificates.proof import check
        from safestart.certificates.statement import ProofRejected

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
        return json.loads(data)
    except (OSError, ValueError, RecursionError) as error:
        sys.stderr.write(f"safestart: {path}: unreadable: {error}\n")
        raise typer.Exit(2) from None


def _statement(document: Any) -> list[str]:
    question, start = document["question"], document["start"]
    rate = math.degrees(question["tumble_rate_rad_s"])
    horizon = question["dt_s"] * question["steps"]
    return [
        f"stay in the corridor at all times of [0, {horizon:g}] s, thrust held over {question['dt_s']:g} s",
        f"tumble {rate:.6g} deg/s, thrust at most {question['max_acceleration_m_s2']:g} m/s^2, "
        f"mean motion {question['mean_motion_rad_s']:g} rad/s",
        f"start (LVLH) {start['position_m']} m, {start['velocity_m_s']} m/s",
    ]
