"""``safestart verify``: check a proof document in ball arithmetic."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from safestart.cli.console import Json, out, print_json
from safestart.cli.files import given_bytes
from safestart.errors import InvalidInput
from safestart.runtime.logs import legible
from safestart.runtime.plain_json import loads

_MOST_BYTES = 16 * 1024 * 1024


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("verify")
    def verify(
        proof: Annotated[Path, typer.Argument(help="Proof document, JSON; - for standard input.")],
        as_json: Json = False,
    ) -> None:
        """Check a proof: GO, NO_GO, or a plan with burns that fail. Exit code 0: valid, 1: rejected, 2: unreadable."""
        # Imported here, so that other commands do not load ball arithmetic.
        from safestart.proofs.checker import check
        from safestart.proofs.strict import ProofRejected
        from safestart.proofs.wording import question_shown

        document = _load(proof)
        try:
            verified = check(document)
        except ProofRejected as error:
            if as_json:
                print_json({"valid": False, "reason": error.detail})
            else:
                out.print("[bold red]rejected[/]: " + escape(error.detail), soft_wrap=True)
            raise typer.Exit(1) from None
        if as_json:
            print_json(
                {
                    "valid": True,
                    "verdict": verified.verdict,
                    "margin_m": verified.margin_m,
                    "statement": verified.statement,
                    **question_shown(document),
                }
            )
            return
        colour = "red" if verified.verdict == "NO_GO" else "green"
        bound = "at most" if verified.verdict == "NO_GO" else "at least"
        what = "distance to the target" if verified.verdict == "PROVED" else "margin"
        claim = "proved" if verified.verdict != "PROVED" else "and checked"
        out.print(f"[bold {colour}]{verified.verdict}[/] {claim}: {what} {bound} {verified.margin_m!r} m")
        for line in verified.statement:
            out.print(f"  {line}", soft_wrap=True, markup=False)


def _load(path: Path) -> Any:
    try:
        return loads(given_bytes("proof", str(path), _MOST_BYTES))
    except (InvalidInput, OSError, ValueError, RecursionError) as error:
        sys.stderr.write(legible(f"safestart: {path}: unreadable: {error}") + "\n")
        raise typer.Exit(2) from None
