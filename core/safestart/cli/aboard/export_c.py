"""``safestart export-c``: verdicts aboard, as C99 tables and code without allocation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safestart.cli.console import Json, err, out, print_json, reporting
from safestart.cli.files import folder, readable, writable
from safestart.errors import invalid
from safestart.model.plain_numbers import require_plain
from safestart.model.scenario import MAX_MEAN_MOTION, Chaser, CorridorShape, Scenario, number


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("export-c")
    def export_c(
        output: Annotated[
            Path, typer.Option(help="Folder for the files; made where it is missing, its parent is not.")
        ],
        omega_t_deg_s: Annotated[
            str, typer.Option(help="Tumble rates of the target, deg/s, with commas.")
        ] = "",
        a_max_m_s2: Annotated[str, typer.Option(help="Thrusts of the chaser, m/s^2, with commas.")] = "",
        mean_motion_rad_s: Annotated[float, typer.Option(help="Mean motion of the orbit, rad/s.")] = 1.1e-3,
        c_x: Annotated[float, typer.Option(help="Slope of the corridor's +-x sides.")] = 1.5,
        c_z: Annotated[float, typer.Option(help="Slope of its +-z sides.")] = 1.5,
        x0_m: Annotated[float, typer.Option(help="Half-width of the port in x, m.")] = 2.5,
        z0_m: Annotated[float, typer.Option(help="Half-width of the port in z, m.")] = 2.5,
        r_h_m: Annotated[float, typer.Option(help="Hold stand-off radius, m.")] = 0.5,
        horizon_s: Annotated[float, typer.Option(help="How long the atlas's starts stay, s.")] = 60.0,
        y_max_m: Annotated[float, typer.Option(help="Where the atlas ends, m.")] = 150.0,
        precision: Annotated[str, typer.Option(help="float64 or float32.")] = "float64",
        check: Annotated[
            bool, typer.Option("--check", help="Write nothing: check the folder's digests and every proof.")
        ] = False,
        as_json: Json = False,
    ) -> None:
        """Write certificate, atlas and thrust check of every pair of rate and thrust as C99, with their proofs."""
        # Imported here, so that other commands do not load solvers.
        from safestart.flight_table import export as table
        from safestart.processes.wire import DT_S
        from safestart.public.starts import seconds

        if check:
            with readable("--output", output):
                proved = table.verify(output)
            if as_json:
                print_json({"valid": True, "proofs": proved})
            else:
                out.print(f"{output}: every digest is its file's, {proved} proofs hold", soft_wrap=True)
            return
        shape = CorridorShape(c_x, c_z, x0_m, z0_m, r_h_m)
        number("--mean-motion-rad-s", mean_motion_rad_s, 0.0, MAX_MEAN_MOTION)
        scenarios = [
            Scenario(Scenario.of(rate, thrust, mean_motion_rad_s).target, Chaser(thrust), shape)
            for rate in _numbers("--omega-t-deg-s", omega_t_deg_s)
            for thrust in _numbers("--a-max-m-s2", a_max_m_s2)
        ]
        steps = round(seconds("--horizon-s", horizon_s) / DT_S)
        if precision not in ("float64", "float32"):
            raise invalid("--precision", "float64 or float32", precision)
        with folder("--output", output):
            with reporting("export-c") as context:
                made = table.export(table.points_of(scenarios, steps, DT_S, y_max_m, context), precision)
            with writable("--output", output):
                made.write(output)
        if as_json:
            print_json(made.manifest)
            return
        for name in made.files:
            err.print(f"wrote {output / name}", soft_wrap=True, markup=False)
        at_most = ", ".join(f"{name} {count}" for name, count in made.manifest["operations"].items())
        size = made.manifest["table_bytes"]
        out.print(
            f"{len(scenarios)} operating points, {size} bytes of tables, {made.manifest['proofs']} proofs checked"
        )
        out.print(f"at most: {at_most}", soft_wrap=True)
        out.print("build: cc -std=c99 -O2 safestart_*.c -lm -o selftest && ./selftest", soft_wrap=True)


def _numbers(option: str, text: str) -> list[float]:
    parts = text.split(",")
    for part in parts:
        require_plain(option, part)
    try:
        found = [float(part) for part in parts]
    except ValueError:
        raise invalid(option, "numbers with commas between them", text) from None
    if len(set(found)) != len(found):
        raise invalid(option, "each number at most once", text)
    return found
