"""States and attitudes between the epochs of a file, but not across its gaps."""

from __future__ import annotations

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, Nanoseconds, seconds_since
from safestart.interchange.frames import to_gcrf
from safestart.model.scenario import Bools, Floats

LONGEST_STEP_S = 300.0
"""A larger distance between epochs is a gap. Up to it, 8 states interpolate to a micrometre (LEO)."""
_POINTS = 8


def states_at(ephemeris: Ephemeris, epochs: Nanoseconds) -> tuple[Floats, Bools]:
    """GCRF states (K, 6) at TAI ``epochs`` (K,), and whether each is known.

    Hermite polynomials interpolate the positions and velocities of up to eight neighbours, which belong to one piece
    and have no gap between them. An epoch of the file gets the state of the file; where two segments meet, it gets that
    of the later one. In gaps, outside the file and outside a segment's useable span the state is NaN and not known.
    """
    known = to_gcrf(ephemeris.frame, ephemeris.epochs, ephemeris.states)
    out = np.full((len(epochs), 6), np.nan)
    place = np.searchsorted(ephemeris.epochs, epochs)
    # Where two segments meet, the later one holds: the chaser fired there, and its velocity changed.
    place_in = np.maximum(np.searchsorted(ephemeris.epochs, epochs, side="right") - 1, 0)
    exact = ephemeris.epochs[place_in] == epochs
    out[exact] = known[place_in[exact]]
    runs = _runs(ephemeris)
    after = np.minimum(place, len(ephemeris.epochs) - 1)
    between = ~exact & (place > 0) & (place < len(ephemeris.epochs)) & (runs[place - 1] == runs[after])
    windows: dict[int, list[int]] = {}
    for k in np.nonzero(between)[0].tolist():
        windows.setdefault(int(place[k]), []).append(k)
    for right, indices in windows.items():
        first = int(np.searchsorted(runs, runs[right]))
        last = int(np.searchsorted(runs, runs[right], side="right"))
        begin = max(first, min(right - _POINTS // 2, last - _POINTS))
        chosen = slice(begin, min(last, begin + _POINTS))
        zero = int(ephemeris.epochs[right - 1])
        at = seconds_since(ephemeris.epochs[chosen], zero)
        out[indices] = _hermite(at, known[chosen], seconds_since(epochs[indices], zero))
    out[~_useable(ephemeris, epochs, place_in)] = np.nan
    return out, np.asarray(~np.isnan(out[:, 0]))


def _useable(ephemeris: Ephemeris, epochs: Nanoseconds, place: Nanoseconds) -> Bools:
    """(K,): whether the segment of entry ``place`` (K,) calls ``epochs`` (K,) useable."""
    out = np.ones(len(epochs), dtype=bool)
    if ephemeris.useable:
        piece = np.searchsorted(np.array(ephemeris.pieces), place, side="right") - 1
        for k, window in enumerate(ephemeris.useable):
            if window is not None:
                out[piece == k] = ((epochs >= window[0]) & (epochs <= window[1]))[piece == k]
    return out


def _runs(ephemeris: Ephemeris) -> Nanoseconds:
    """(K,): numbers that grow by one where a piece begins or a gap lies before the epoch."""
    begins = np.zeros(len(ephemeris.epochs), dtype=np.int64)
    begins[list(ephemeris.pieces)] = 1
    begins[1:] |= np.diff(ephemeris.epochs) > round(LONGEST_STEP_S * SECOND)
    begins[0] = 0
    out: Nanoseconds = np.cumsum(begins)
    return out


def _hermite(nodes: Floats, states: Floats, times: Floats) -> Floats:
    """States (Q, 6) at ``times`` (Q,) of the polynomial through states (M, 6) at ``nodes`` (M,), s."""
    from scipy.interpolate import KroghInterpolator

    both = np.empty((2 * len(nodes), 3))
    both[0::2], both[1::2] = states[:, :3], states[:, 3:]
    course = KroghInterpolator(np.repeat(nodes, 2), both)
    return np.concatenate([course(times), course.derivative(times)], axis=1)


def quaternions_at(course: AttitudeCourse, epochs: Nanoseconds) -> Floats:
    """Quaternions (K, 4) at TAI ``epochs`` (K,) by slerp; raises ``InvalidInput`` outside of the course's span."""
    from scipy.spatial.transform import Rotation, Slerp

    if int(epochs.min()) < course.epochs[0] or int(epochs.max()) > course.epochs[-1]:
        raise invalid("attitude", "a course over the whole span asked for", "a shorter one")
    zero = int(course.epochs[0])
    if len(course.epochs) == 1:
        return np.repeat(course.quaternions, len(epochs), axis=0)
    # Rotation takes the scalar last, and turns vectors where ours turn axes.
    table = Rotation.from_quat(np.roll(course.quaternions, -1, axis=1))
    turned = Slerp(seconds_since(course.epochs, zero), table)(seconds_since(epochs, zero))
    return np.roll(turned.as_quat(), 1, axis=1)
