"""What holds for ever after a flight of `synchronize`: the chaser stops against the body frame and stands there.

From body-frame position q0 and velocity w it goes straight on and slows down,

    q(t) = q0 + w (t - t^2 / 2T) up to T, then it stands at q1 = q0 + w T / 2.

With W the body's inertial rate (tumble rate + mean motion) and k = W^2 + 2 n^2 the thrust is at every phase at most

    |w| / T + 2 W |w| + k (|q0| + |w| T / 2),

the path is the segment from q0 to q1, so that its least distance to a face is that of an end, and the LVLH speed is at
most |w| + omega (|q0| + |w| T / 2). docs/theory/exact.md has the proof.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.exact.answer import GUARD, Arrival
from safestart.exact.question import Question
from safestart.model.scenario import Floats

_SHARE = 1e-9
"""The share of the thrust limit left unused, far above rounding."""
_SHORTEST = 1e-3
"""Shortest stop, s."""


def arrival_of(question: Question, state: Floats, time: float) -> Arrival | None:
    """The shortest stop from ``state`` (2 d,), LVLH, at ``time`` (s); None where it lacks thrust, room or speed."""
    d, target = question.dimensions, question.scenario.target
    rate, n = target.tumble_rate, target.mean_motion
    turn = np.eye(d)
    turn[:2, :2] = rotation(rate * time).T
    place, velocity = turn @ state[:d], turn @ state[d:]
    velocity[:2] -= rate * np.array([-place[1], place[0]])
    far, fast = float(np.linalg.norm(place)), float(np.linalg.norm(velocity))
    stand = (rate + n) ** 2 + 2.0 * n * n
    most = question.scenario.chaser.max_acceleration * (1.0 - _SHARE)
    left = most - 2.0 * (rate + n) * fast - stand * far
    square = left * left - 2.0 * stand * fast * fast
    if left <= 0.0 or square < 0.0:
        return None
    # The smaller root of |w| / T + k |w| T / 2 = left.
    stop = max(2.0 * fast / (left + math.sqrt(square)), _SHORTEST)
    reach = 0.5 * fast * stop
    if fast / stop + stand * reach > left * (1.0 + _SHARE):
        return None
    limit = question.speed_limit
    if limit is not None and fast + rate * (far + reach) > limit * (1.0 - _SHARE):
        return None
    corridor = corridor_of(question.scenario.corridor, d)
    ends = np.stack([place, place + 0.5 * stop * velocity])
    room = (corridor.offsets - ends @ corridor.normals.T) / corridor.lengths
    margin = float(room.min())
    return Arrival(stop, margin) if margin > GUARD else None
