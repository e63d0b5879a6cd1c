"""The avoid game of paper 001: what grids get wrong, what the certified bounds leave open. Run by hand.

``python -m benchmarks.collision_avoidance [STUDY ...] [--json]``, the names in ``STUDIES``, all of them by default.
Nothing here is timed against a peer; a run takes some minutes of CPU time on one core.
"""

from __future__ import annotations

import json
import math
import time
from typing import Any

import numpy as np

from benchmarks.asked import parser
from safestart.collision_avoidance.bounds.certified import lower, unavoidable, upper
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.tube import solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet
from safestart.levelset import optimal_inputs
from safestart.model.scenario import Floats

W = 0.0011
BOX = (InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)))
CASES: dict[str, tuple[Game, float, tuple[float, float]]] = {
    "1 km, 60 s": (Game(W, *BOX, 1000.0), 60.0, (3000.0, 20.0)),
    "100 m, 40 s": (Game(W, *BOX, 100.0), 40.0, (500.0, 10.0)),
}
SHAPE = (41, 15)
SEED = 11


def counts() -> list[dict[str, Any]]:
    """Nodes that each grid calls wrongly; the same from hj-reachability; and after joining."""
    # Imported here: JAX takes seconds to load.
    from benchmarks.peers.hj_avoid_game import peer_tube

    rows = []
    variants = {
        "fused, their boundary": {"together": False, "boundary": "extrapolate_away_from_zero"},
        "fused, u and d": {"together": False},
        "fused, net input": {},
    }
    for name, (game, horizon, half) in CASES.items():
        states = _nodes(half, SHAPE)
        lost = unavoidable(game, states, horizon)
        saved = lower(game, states, horizon, goal_m=1e-6, effort=0) > 0.0
        for accuracy in ("low", "very_high"):
            begin = time.process_time()
            values = {"hj_reachability": peer_tube(game, horizon, half, SHAPE, accuracy)}
            spent = {"hj_reachability": time.process_time() - begin}
            for solver, given in variants.items():
                settings = TubeSettings(
                    accuracy=accuracy, shape=SHAPE, half=half, kept=2, join=False, **given
                )
                tube = solve_tube(game, horizon, settings)
                values[solver], spent[solver] = tube.raw[-1], tube.run_s
            rows += [
                {
                    "case": name,
                    "accuracy": accuracy,
                    "solver": solver,
                    "proved_unsafe": int(lost.sum()),
                    "unsafe_called_safe": int((lost & (value > 0.0)).sum()),
                    "proved_safe": int(saved.sum()),
                    "safe_called_unsafe": int((saved & (value <= 0.0)).sum()),
                    "undecided": int((~lost & ~saved).sum()),
                    "median_apart_from_peer_m": float(np.median(np.abs(value - values["hj_reachability"]))),
                    "most_apart_from_peer_m": float(np.abs(value - values["hj_reachability"]).max()),
                    "seconds": spent[solver],
                }
                for solver, value in values.items()
            ]
    return rows


def joined() -> list[dict[str, Any]]:
    """The default tube before and after joining, with its errors."""
    rows = []
    for name, (game, horizon, half) in CASES.items():
        tube = solve_tube(game, horizon, TubeSettings(shape=SHAPE, half=half))
        if tube.check is not None:
            rows.append({"case": name, **tube.check.document(), "grid_error_m": tube.grid_error_m})
    return rows


def brute_force() -> list[dict[str, Any]]:
    """States proved unsafe, on nodes and between them, against random and greedy sums: how far any got away."""
    rows = []
    rng = np.random.default_rng(SEED)
    for name, (game, horizon, half) in CASES.items():
        ends = np.array([half[0], half[0], half[1], half[1]])
        states = rng.uniform(-1.0, 1.0, (40_000, 4)) * ends
        lost = states[unavoidable(game, states, horizon)]
        margins = upper(game, lost, horizon)
        # Those that are nearest to being saved are the ones to try.
        hard = lost[np.argsort(-margins)[:400]]
        best = np.full(len(hard), -np.inf)
        pieces = 160
        step, push = game.transition(horizon / pieces), game.held_input(horizon / pieces)
        half_widths = np.array(game.enforceable.bound)
        for trial in range(300):
            moved, least = hard.copy(), np.linalg.norm(hard[:, :2], axis=1)
            held = rng.integers(1, pieces + 1)
            for k in range(pieces):
                if k % held == 0:
                    sums = rng.choice([-1.0, 1.0], (len(hard), 2)) * half_widths
                if trial < 20:
                    # Straight away from the disk, or across the flight on either side, turned a little.
                    angle = 2.0 * math.pi * trial / 20.0
                    along = moved[:, :2] @ np.array(
                        [[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]
                    )
                    sums = game.enforceable.extreme(along)
                moved = moved @ step.T + sums @ push.T
                least = np.minimum(least, np.linalg.norm(moved[:, :2], axis=1))
            best = np.maximum(best, least - game.keep_out_m)
        rows.append(
            {
                "case": name,
                "random_states": len(states),
                "proved_unsafe": len(lost),
                "tried": len(hard),
                "saved": int((best > 0.0).sum()),
                "best_margin_m": float(best.max()),
                "undecided_of_random": int(
                    (
                        (upper(game, states, horizon) > 0.0)
                        & (lower(game, states, horizon, goal_m=1e-6) <= 0.0)
                    ).sum()
                ),
            }
        )
    return rows


def convergence() -> list[dict[str, Any]]:
    """Error of the grid's own value at fixed states near the boundary, by nodes and scheme."""
    rows = []
    rng = np.random.default_rng(SEED)
    for name, (game, horizon, half) in CASES.items():
        ends = np.array([half[0], half[0], half[1], half[1]])
        states = rng.uniform(-0.9, 0.9, (30_000, 4)) * ends
        above = upper(game, states, horizon)
        near = np.abs(above) < 0.1 * game.keep_out_m
        states, above = states[near][:1000], above[near][:1000]
        below = lower(game, states, horizon)
        for accuracy in ("low", "very_high"):
            for shape in ((21, 9), (41, 15), (61, 21), (61, 31)):
                settings = TubeSettings(accuracy=accuracy, shape=shape, half=half, kept=2, join=False)
                tube = solve_tube(game, horizon, settings)
                found = tube.value(states)
                error = np.maximum(np.maximum(found - above, below - found), 0.0)
                rows.append(
                    {
                        "case": name,
                        "accuracy": accuracy,
                        "shape": list(shape),
                        "states": len(states),
                        "mean_m": float(error.mean()),
                        "p99_m": float(np.quantile(error, 0.99)),
                        "max_m": float(error.max()),
                        "called_safe": int(((found > 0.0) & (above <= 0.0)).sum()),
                        "called_unsafe": int(((found <= 0.0) & (below > 0.0)).sum()),
                        "bounds_apart_max_m": float((above - below).max()),
                    }
                )
    return rows


def games() -> list[dict[str, Any]]:
    """How much the bounds leave open, by shapes of the inputs, in the plane and in space."""
    rows = []
    rng = np.random.default_rng(SEED)
    pairs = {
        "box, box": BOX,
        "disk, disk": (InputSet("disk", (0.1,)), InputSet("disk", (0.05,))),
        "box, disk": (InputSet("box", (0.1, 0.1)), InputSet("disk", (0.05,))),
        "disk, box": (InputSet("disk", (0.1,)), InputSet("box", (0.05, 0.05))),
        "space: box, box": (InputSet("box", (0.1,) * 3), InputSet("box", (0.05,) * 3)),
        "space: ball, ball": (InputSet("ball", (0.1,)), InputSet("ball", (0.05,))),
        "space: cylinder, ball": (InputSet("cylinder", (0.1, 0.1)), InputSet("ball", (0.05,))),
    }
    for (case, (planar, horizon, half)), (name, (u, d)) in (
        (case, pair) for case in CASES.items() for pair in pairs.items()
    ):
        game = Game(W, u, d, planar.keep_out_m)
        ends = np.repeat(half, game.channels)
        states = rng.uniform(-1.0, 1.0, (6000, 2 * game.channels)) * ends
        begin = time.process_time()
        above = upper(game, states, horizon)
        above_s, begin = time.process_time() - begin, time.process_time()
        below = lower(game, states, horizon, goal_m=1e-6)
        rows.append(
            {
                "case": case,
                "inputs": name,
                "states": len(states),
                "proved_unsafe": int((above <= 0.0).sum()),
                "proved_safe": int((below > 0.0).sum()),
                "undecided": int(((above > 0.0) & (below <= 0.0)).sum()),
                "upper_us_per_state": 1e6 * above_s / len(states),
                "lower_us_per_state": 1e6 * (time.process_time() - begin) / len(states),
            }
        )
    return rows


def fuel() -> list[dict[str, Any]]:
    """Closed loop on the gradient of the tube against the worst adversary: fuel and losses by the price of fuel.

    Starts are proved safe, head for the disk and would hit it by drift; both sides act on the gradient at the
    time to go, once a second. With a price, what counts are the starts that the priced value still calls safe.
    """
    rows = []
    rng = np.random.default_rng(SEED)
    game, horizon, _ = CASES["100 m, 40 s"]
    p = rng.uniform(-1.0, 1.0, (4000, 2)) * 300.0
    v = -p / 40.0 * rng.uniform(0.5, 1.5, (4000, 1)) + rng.uniform(-1.5, 1.5, (4000, 2))
    states = np.concatenate([p, v], axis=1)
    drifting = Game(W, InputSet("box", (0.0, 0.0)), InputSet("box", (0.0, 0.0)), game.keep_out_m)
    states = states[(lower(game, states, horizon) > 10.0) & (upper(drifting, states, horizon) < 30.0)][:400]
    flights: dict[float, tuple[Floats, Floats]] = {}
    for price in (0.0, 1.0, 2.0, 5.0, 10.0):
        settings = TubeSettings(half=(600.0, 10.0), shape=(31, 15), kept=9, together=False, fuel_price=price)
        tube = solve_tube(game, horizon, settings)
        x, spent = states.copy(), np.zeros(len(states))
        least = np.linalg.norm(x[:, :2], axis=1)
        step, push = game.transition(1.0), game.held_input(1.0)
        for k in range(round(horizon)):
            gradient = tube.gradient(x, horizon - k)
            u, d = optimal_inputs(tube.motion, gradient, x)
            spent += np.abs(u).sum(axis=1)
            x = x @ step.T + (u + d) @ push.T
            least = np.minimum(least, np.linalg.norm(x[:, :2], axis=1))
        flights[price] = least - game.keep_out_m, spent
        safe = tube.value(states) > 0.0
        rows.append(
            {
                "price_m_per_m_s": price,
                "starts": len(states),
                "losses": int((flights[price][0] <= 0.0).sum()),
                "called_safe": int(safe.sum()),
                "losses_of_these": int((flights[price][0][safe] <= 0.0).sum()),
                "least_margin_m": float(flights[price][0][safe].min()),
                "fuel_m_s": float(spent[safe].mean()),
                "fuel_without_price_m_s": float(flights[0.0][1][safe].mean()),
            }
        )
    return rows


def paper_variant() -> list[dict[str, Any]]:
    """Eq. (12) as printed beside the game: nodes that Player 1 can save and that it calls unsafe."""
    rows = []
    name = "100 m, 40 s"
    game, horizon, half = CASES[name]
    for players in Players:
        settings = TubeSettings(half=half, shape=SHAPE, kept=2, players=players)
        check = solve_tube(game, horizon, settings).check
        if check is not None:
            rows.append({"case": name, "players": players.value, **check.document()})
    return rows


def _nodes(half: tuple[float, float], shape: tuple[int, int]) -> Floats:
    axes = [np.linspace(-h, h, k) for h, k in zip(np.repeat(half, 2), np.repeat(shape, 2), strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


STUDIES = {
    "counts": counts,
    "joined": joined,
    "brute_force": brute_force,
    "convergence": convergence,
    "games": games,
    "fuel": fuel,
    "paper": paper_variant,
}


def _table(rows: list[dict[str, Any]]) -> str:
    columns = list(dict.fromkeys(key for row in rows for key in row))
    cells = [[_shown(row.get(key, "")) for key in columns] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in [columns, ["---"] * len(columns), *cells])


def _shown(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("studies", nargs="*", metavar="STUDY", help=f"{', '.join(STUDIES)}; all by default")
    asked.add_argument("--json", action="store_true")
    given = asked.parse_args()
    if unknown := [name for name in given.studies if name not in STUDIES]:
        asked.error(f"no such study: {', '.join(unknown)}")
    found = {}
    for study in given.studies or STUDIES:
        found[study] = STUDIES[study]()
        if not given.json:
            print(f"\n{study}\n\n{_table(found[study])}", flush=True)
    if given.json:
        print(json.dumps(found))
