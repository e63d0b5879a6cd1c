"""``safestart go-no-go``: one start, one verdict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, out, print_json
from safestart.cli.files import write_json
from safestart.errors import invalid
from safestart.model.scenario import Rest
from safestart.processes.execute import execute
from safestart.processes.go_no_go.run import single

# Options of the command that are no inputs of the process; every other one has the input's name.
_NO_INPUTS = ("x_m", "y_m", "z_m", "proof", "as_json")


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
        question: Annotated[
            str, typer.Option(help="stay, or synchronize: at rest in the hold ball (exact).")
        ] = "stay",
        horizon_s: Annotated[float, typer.Option(help="How long to stay in the corridor (exact), s.")] = 60.0,
        within_s: Annotated[float, typer.Option(help="Latest end of synchronize, s.")] = 200.0,
        hold_x_m: Annotated[float, typer.Option(help="Hold point, body-frame x, m.")] = 0.0,
        hold_y_m: Annotated[float | None, typer.Option(help="Hold point, y, m; absent: r_h.")] = None,
        hold_z_m: Annotated[float, typer.Option(help="Hold point, body-frame z, m.")] = 0.0,
        ball_radius_m: Annotated[float, typer.Option(help="Ball around the hold point, m.")] = 0.5,
        rest_speed_m_s: Annotated[float, typer.Option(help="Speed that counts as at rest, m/s.")] = 0.05,
        speed_limit_m_s: Annotated[
            float | None, typer.Option(help="Largest LVLH speed (exact), m/s.")
        ] = None,
        keep_out_m: Annotated[float, typer.Option(help="Keep-out radius (exact), m; at most r_h.")] = 0.0,
        omega_t_half_width_deg_s: Annotated[
            float, typer.Option(help="Tumble rate within +- this (exact), deg/s.")
        ] = 0.0,
        a_max_half_width_m_s2: Annotated[
            float, typer.Option(help="Thrust limit within +- this (exact), m/s^2.")
        ] = 0.0,
        mean_motion_half_width_rad_s: Annotated[
            float, typer.Option(help="Mean motion within +- this (exact), rad/s.")
        ] = 0.0,
        position_half_width_m: Annotated[
            float, typer.Option(help="Start position within +- this (exact), m.")
        ] = 0.0,
        velocity_half_width_m_s: Annotated[
            float, typer.Option(help="Start velocity within +- this (exact), m/s.")
        ] = 0.0,
        witness: Annotated[
            str, typer.Option(help="What GO shows with half-widths: common or per_corner.")
        ] = "common",
        disturbance_m_s2: Annotated[
            float, typer.Option(help="Unknown acceleration to withstand (stay, exact), m/s^2.")
        ] = 0.0,
        start_error_m: Annotated[float, typer.Option(help="Error of the start (exact), m.")] = 0.0,
        start_error_m_s: Annotated[float, typer.Option(help="Error of its velocity (exact), m/s.")] = 0.0,
        proof: Annotated[
            Path | None, typer.Option(help="Where to write the proof (exact), for `safestart verify`.")
        ] = None,
        as_json: Json = False,
    ) -> None:
        """May a chaser at rest at this point start its approach? By the closed form at once, or proved (exact)."""
        inputs = {name: value for name, value in locals().items() if name not in _NO_INPUTS}
        state = {"x_m": x_m, "y_m": y_m} | ({} if z_m is None else {"z_m": z_m})
        inputs |= {"states": [state], "rest": rest.value, "proofs": proof is not None}
        document = execute("go-no-go", inputs).document
        answer = document["outputs"]
        if proof is not None:
            _write(proof, answer["proof"] and answer["proof"][0])
        print_json(single(answer)) if as_json else _show(answer)


def _show(answer: dict[str, Any]) -> None:
    """Print the verdict on the one start, why, and what the closed form says of it."""
    verdict = answer["verdict"][0]
    out.print(f"[bold {'green' if verdict == 'GO' else 'red'}]{verdict}[/]: {answer['reason'][0]}")
    for member in (answer["examples"] or [[]])[0]:
        out.print(f"  {_told(member)}", soft_wrap=True)
    r_sync = answer["r_sync_m"]
    shown = f"{r_sync:.2f} m" if r_sync is not None else f"none ({answer['r_sync_reason']})"
    out.print(f"  synchronization range limit: {shown}")
    for face, margin in zip(answer["faces"], answer["face_margins_m"][0], strict=True):
        out.print(f"  closed-form margin {face:<11} {margin:9.2f} m")


def _told(member: dict[str, Any]) -> str:
    """One member of the sets in a line."""
    margin = member["margin_m"]
    return (
        f"{member['verdict']} for {member['omega_t_deg_s']:.6g} deg/s, {member['a_max_m_s2']:g} m/s^2, "
        f"{member['mean_motion_rad_s']:g} rad/s, start (LVLH) {member['position_m']} m, {member['velocity_m_s']} m/s: "
        f"margin {'-' if margin is None else format(margin, '.3g')} m"
    )


def _write(path: Path, document: object) -> None:
    if document is None:
        raise invalid("--proof", "a proved verdict (method exact, GO or NO_GO)", "none")
    write_json("--proof", path, document)
