"""Conjunction Data Messages (508.0-B-1): the two states at the time of closest approach, with their covariances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.interchange.ccsds.message import Message
from safestart.interchange.ccsds.parameters import STATE
from safestart.interchange.ccsds.tokens import Fields, refused
from safestart.interchange.covariance import Covariance, Sense, covariance_frame
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import epochs_of

_AXES = ("R", "T", "N", "RDOT", "TDOT", "NDOT")
TRIANGLE = tuple(f"C{row}_{column}" for k, row in enumerate(_AXES) for column in _AXES[: k + 1])
_UNITS = ("m**2", "m**2/s", "m**2/s**2")


@dataclass(frozen=True)
class Encounter:
    """``first`` and ``second``, OBJECT1 and OBJECT2, as courses of one epoch: the time of closest approach.

    ``miss_distance`` is the message's value, m.
    """

    first: Ephemeris
    second: Ephemeris
    miss_distance: float


def encounter_of(message: Message, sense: Sense) -> Encounter:
    """The two objects of a CDM; ``sense`` gives the sense of its RTN covariances.

    Raises ``InvalidInput``, also if the states' distance differs from MISS_DISTANCE by more than 1 % and 10 m.
    """
    head, *objects = _fields(message)
    if len(objects) != 2:
        raise invalid("file", "OBJECT1 and OBJECT2", f"{len(objects)} objects (truncated)")
    at = epochs_of([head.get("TCA")], "UTC")
    first, second = (
        _object(one, name, at, sense) for one, name in zip(objects, ("OBJECT1", "OBJECT2"), strict=True)
    )
    if first.frame != second.frame:
        raise invalid("REF_FRAME", f"one frame for both objects, {first.frame}", second.frame)
    miss = head.number("MISS_DISTANCE", "m")
    apart = float(np.linalg.norm(first.states[0, :3] - second.states[0, :3]))
    if abs(apart - miss) > 10.0 + 0.01 * miss:
        raise invalid("MISS_DISTANCE", f"the distance of the states, {apart:.6g} m", f"{miss:g} m")
    return Encounter(first, second, miss)


def _fields(message: Message) -> list[Fields]:
    found = []
    for one in message.blocks():
        if one.name or one.rows:
            raise refused(one.fields.line, "keywords of CDM", one.name or "a row of data")
        found.append(one.fields)
    if not found:
        raise invalid("file", "the keywords of CDM", "none (truncated)")
    return found


def _object(
    one: Fields, name: str, at: np.ndarray[tuple[int, ...], np.dtype[np.int64]], sense: Sense
) -> Ephemeris:
    if one.get("OBJECT") != name:
        raise refused(one.line, name, one.get("OBJECT"))
    state = [one.number(axis, "km" if k < 3 else "km/s", 3) for k, axis in enumerate(STATE)]
    matrix = np.zeros((6, 6))
    for entry, (row, column) in zip(TRIANGLE, zip(*np.tril_indices(6), strict=True), strict=True):
        matrix[row, column] = matrix[column, row] = one.number(entry, _UNITS[entry.count("DOT")])
    covariance = Covariance(int(at[0]), covariance_frame("RTN", sense), matrix)
    named = one.get("OBJECT_NAME"), one.get("INTERNATIONAL_DESIGNATOR", one.get("OBJECT_DESIGNATOR"))
    return Ephemeris(*named, one.get("REF_FRAME"), "UTC", at, np.array([state]), (covariance,))
