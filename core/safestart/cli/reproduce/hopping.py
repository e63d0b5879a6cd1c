"""``safestart reproduce hopping``: what paper 004 prints about hopping approaches, ours beside it."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, Justify, out, print_json, reporting, table_of

NOTES = (
    "Hop times: the paper solves its equation (25) with CasADi and sees no solution from 110 deg on; in closed form "
    "the branch goes on to its fold. The limit of the R-bar is printed loosely.",
    "Fuel: ten times holds in the 1-norm, not in the 2-norm.",
    "0.6 orbits: the paper's single run has no noise; neither has ours. Its figure gives no distances.",
    "Monte Carlo: 50 runs as in Figs. 5, 7 and 10, starts off by 10 %, J2, navigation 0.5 m and 1 mm/s, thrust 1 % and "
    "0.5 deg. The paper does not say its noise, nor how near its aborts would come.",
)

_COLUMNS: tuple[tuple[str, Justify], ...] = (("what", "left"), ("ours", "right"), ("paper", "right"))
_RUNS = typer.Option(help="Approaches of each Monte Carlo.", min=1, max=10_000)
Runs = Annotated[int, _RUNS]


def register(group: typer.Typer) -> None:
    """Add the command to the group ``reproduce``."""

    @group.command("hopping")
    def hopping(runs: Runs = 50, as_json: Json = False) -> None:
        """Paper 004: hop times (Fig. 8a), claims about the V- and R-bar, 0.6 orbits with a barrier, Monte Carlo."""
        document = hopping_document(runs)
        if as_json:
            print_json(document)
            return
        table = table_of("Hopping approaches (paper 004), 2 km to 100 m, 8100 km", _COLUMNS)
        for row in document["rows"]:
            table.add_row(row["what"], row["ours"], row["paper"])
        out.print(table)
        for line in NOTES:
            out.print(f"- {line}")


def hopping_document(runs: int = 50) -> dict[str, Any]:
    """``rows`` of what, ours, paper (texts), ``fig_8a`` as numbers, and ``notes``."""
    import numpy as np

    from safestart.hopping.approach import approach, mean_motion_of
    from safestart.hopping.hop_time import fold_deg, hop_phases

    n = mean_motion_of(8.1e6)
    angles = [0.0, 20.0, 40.0, 60.0, 80.0, 90.0, 100.0, 110.0, 120.0, 130.0, 140.0, 147.0]
    orbits = (hop_phases(np.array(angles), np.full(len(angles), 0.7)) / math.tau).tolist()
    v_bar, r_bar = approach(n, 0.0, 2000.0, 100.0, 5), approach(n, 90.0, 2000.0, 100.0, 5)
    limit = float(hop_phases(np.array([90.0]), np.array([0.0]))[0]) / math.tau
    rows = [
        _row("V-bar hop, orbits", f"{orbits[0]:.4f}", "0.5"),
        _row("R-bar hop as rho falls to 0, orbits", f"{limit:.4f}", "0.21"),
        _row("R-bar faster than the V-bar", f"{v_bar.orbits / r_bar.orbits:.2f} x", "5 x"),
        _row("R-bar fuel over V-bar, 1-norm", f"{r_bar.fuel_1norm / v_bar.fuel_1norm:.2f} x", "10 x"),
        _row("the same, 2-norm", f"{r_bar.fuel_2norm / v_bar.fuel_2norm:.2f} x", "-"),
        _row("fold for rho 0.7, deg", f"{fold_deg(0.7):.2f}", "no solution from 110"),
    ]
    rows += [
        _row(f"Fig. 8a, {angle:g} deg, orbits", f"{value:.4f}", "no solution" if angle > 110.0 else "plotted")
        for angle, value in zip(angles, orbits, strict=True)
    ]
    with reporting("hopping") as context:
        rows += [
            _row(f"0.6 orbits, {name}: closest after each hop, m", said, paper)
            for name, said, paper in _late()
        ]
        for number, angle in enumerate((0.0, 90.0, 40.0)):
            context.step(number, 3.0, f"{angle:g} deg")
            rows.append(_monte_carlo(angle, runs))
    return {"rows": rows, "fig_8a": {"angle_deg": angles, "orbits": orbits}, "notes": list(NOTES)}


def _row(what: str, ours: str, paper: str) -> dict[str, str]:
    return {"what": what, "ours": ours, "paper": paper}


def _late() -> list[tuple[str, str, str]]:
    """Section 5.4: V-bar hops of 0.6 orbits, without and with the barrier at 50 m."""
    from safestart.campaign.case import Case
    from safestart.hopping_flights.fly import NOMINAL, OFF, World, fly

    found = []
    for barrier, paper in ((OFF, "enters"), (NOMINAL, "keeps out")):
        world = World(hops=3, phase=0.6 * math.tau, barrier=barrier, dispersed=False)
        closest = fly(world, Case(0).generator()).closest[:-1]
        found.append((f"barrier {barrier}", ", ".join(f"{c:.0f}" for c in closest), paper))
    return found


def _monte_carlo(angle: float, runs: int) -> dict[str, str]:
    """Figs. 5, 7, 10: runs with noise; hold, fuel and how many have an abort below 50 m."""
    import numpy as np

    from safestart.campaign.case import Case
    from safestart.hopping.barrier import Noise
    from safestart.hopping_flights.fly import World, fly

    world = World(angle_deg=angle, noise=Noise(0.5, 1e-3, 0.01, math.radians(0.5)))
    steer = world.controller()
    flown = [fly(world, Case(k).generator(), steer) for k in range(runs)]
    below = sum(bool((flight.closest[:-1] < world.keep_out).any()) for flight in flown)
    hold = float(np.mean([flight.hold for flight in flown]))
    fuel = float(np.mean([flight.fuel_1norm for flight in flown]))
    return _row(
        f"{runs} runs at {angle:g} deg: aborts below 50 m, hold in m, fuel in m/s",
        f"{below} of {runs}, {hold:.1f}, {fuel:.3f}",
        "all arrive; passively safe",
    )
