"""``safestart go-no-go``: one start, one verdict."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from safestart.cli.console import Json, out, print_json
from safestart.errors import invalid
from safestart.processes.execute import execute
from safestart.processes.go_no_go.run import single
from safestart.scenario import Rest


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("go-no-go")
    def go_no_go(
        omega_t_deg_s: Annotated[float, typer.Option(help="Tumble rate of the target, deg/s.")],
        a_max_m_s2: Annotated[float, typer.Option(help="Maximum thrust acceleration, m/s^2.")],
        x_m: Annotated[float, typer.Option(help="Start, body-frame x, m.")],
        y_m: Annotated[float, typer.Option(help="Start, body-frame y (along the corridor), m.")],
        z_m: Annotated[float | None, typer.Option(help="Start, body-frame z, m; absent: planar.")] = None,
        rest: Annotated[Rest, typer.Option(help="Frame in which the start is at rest.")] = Rest.LVLH,
        mean_motion_rad_s: Annotated[float, typer.Option(help="Mean motion of the orbit, rad/s.")] = 1.1e-3,
        method: Annotated[str, typer.Option(help="closed_form, exact (proved) or auto.")] = "closed_form",
        horizon_s: Annotated[float, typer.Option(help="How long to stay in the corridor (exact), s.")] = 60.0,
        proof: Annotated[
            Path | None, typer.Option(help="Where to write the proof (exact), for `safestart verify`.")
        ] = None,
        as_json: Json = False,
    ) -> None:
        """May a chaser at rest at this point start its approach? By the closed form at once, or proved (exact)."""
        state = {"x_m": x_m, "y_m": y_m} | ({} if z_m is None else {"z_m": z_m})
        inputs = {
            "omega_t_deg_s": omega_t_deg_s,
            "a_max_m_s2": a_max_m_s2,
            "mean_motion_rad_s": mean_motion_rad_s,
            "states": [state],
            "rest": rest.value,
            "method": method,
            "horizon_s": horizon_s,
            "proofs": proof is not None,
        }
        document = execute("go-no-go", inputs).document
        answer = document["outputs"]
        if proof is not None:
            _write(proof, answer["proof"] and answer["proof"][0])
        if as_json:
            print_json(single(answer))
            return
        go = answer["verdict"][0] == "GO"
        out.print(
            f"[bold {'green' if go else 'red'}]{answer['verdict'][0]}[/]: {answer['reason'][0]}",
        )
        r_sync = answer["r_sync_m"]
        shown = f"{r_sync:.2f} m" if r_sync is not None else f"none ({answer['r_sync_reason']})"
        out.print(f"  synchronization range limit: {shown}")
        for face, margin in zip(answer["faces"], answer["face_margins_m"][0], strict=True):
            out.print(f"  closed-form margin {face:<11} {margin:9.2f} m")


def _write(path: Path, document: object) -> None:
    if document is None:
        raise invalid("--proof", "a proved verdict (method exact, GO or NO_GO)", "none")
    try:
        path.write_text(json.dumps(document, allow_nan=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise invalid("--proof", "a writable path", f"{path} ({error.strerror})") from None
