"""Covariance of a state: checks it, converts it to LVLH in a named sense, and gives a box at a confidence.

Axes that move with the orbit have two senses. *Inertial*: the axes of that instant, at rest; velocity errors are only
turned. *Rotating*: the velocity seen in the turning axes, dv' = R dv - omega x R dr, so that position errors enter. The
names RTN and RSW do not tell which one a file means; OCM's RSW_ROTATING and RSW_INERTIAL do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from safestart.errors import invalid
from safestart.interchange.frames import INERTIAL, frame_of
from safestart.model.scenario import Floats, number

Sense = Literal["rotating", "inertial"]
_ROUNDING = 1e-9
"""Eigenvalues this far below 0, after scaling to a unit diagonal, count as rounding in a file."""


@dataclass(frozen=True)
class Covariance:
    """``matrix`` (6, 6), m^2, m^2/s, m^2/s^2, at one TAI ``epoch``, ns, in ``frame``: inertial, or RTN in a sense.

    ``frame`` is an inertial frame, ``RTN_ROTATING`` or ``RTN_INERTIAL``. Raises ``InvalidInput`` for a matrix that is
    not symmetric or not positive semi-definite.
    """

    epoch: int
    frame: str
    matrix: Floats

    def __post_init__(self) -> None:
        matrix = self.matrix
        if matrix.shape != (6, 6) or not np.isfinite(matrix).all():
            raise invalid("covariance", "6 x 6 finite numbers", matrix.shape)
        if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=0.0):
            raise invalid("covariance", "a symmetric matrix", "another")
        diagonal = np.diagonal(matrix)
        scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        least = float(np.linalg.eigvalsh(matrix / np.outer(scale, scale)).min())
        if diagonal.min() < 0.0 or least < -_ROUNDING:
            raise invalid(
                "covariance",
                "a positive semi-definite matrix",
                f"least eigenvalue {least:.3g} at unit diagonal",
            )


def covariance_frame(name: str, sense: Sense | None) -> str:
    """The frame of a covariance by its name; ``sense`` gives the sense of RTN and RSW, which their names leave open.

    Raises ``InvalidInput`` for an unknown frame, and for RTN without a sense.
    """
    plain = name.upper()
    for axes in ("RTN", "RSW", "RIC"):
        if plain == axes:
            if sense is None:
                raise invalid(
                    "COV_REF_FRAME",
                    f"{axes}_ROTATING or {axes}_INERTIAL, or the sense said beside the file (rotating, inertial)",
                    f"{name} alone",
                )
            return f"RTN_{sense.upper()}"
        if plain in (f"{axes}_ROTATING", f"{axes}_INERTIAL"):
            return f"RTN_{plain.rpartition('_')[2]}"
    frame = frame_of(name)
    if frame not in INERTIAL:
        raise invalid("COV_REF_FRAME", f"one of {', '.join(INERTIAL)}, RTN, RSW", name)
    return frame


def into_axes(matrix: Floats, turn: Floats, rate: Floats, sense: Sense) -> Floats:
    """A covariance (6, 6) in axes reached by ``turn`` (3, 3) that rotate at ``rate`` (3,), rad/s, in the new axes."""
    jacobian = np.zeros((6, 6))
    jacobian[:3, :3] = jacobian[3:, 3:] = turn
    if sense == "rotating":
        jacobian[3:, :3] = -_cross(rate) @ turn
    out: Floats = jacobian @ matrix @ jacobian.T
    return 0.5 * (out + out.T)


def other_sense(matrix: Floats, rate: Floats, to: Sense) -> Floats:
    """A covariance (6, 6) in moving axes, converted from one sense to the other, ``to``; ``rate`` (3,), rad/s."""
    sign = -1.0 if to == "rotating" else 1.0
    jacobian = np.eye(6)
    jacobian[3:, :3] = sign * _cross(rate)
    out: Floats = jacobian @ matrix @ jacobian.T
    return 0.5 * (out + out.T)


def box_at(matrix: Floats, confidence: float, dimensions: int = 3) -> Floats:
    """Half-widths (2 d,), m and m/s, of the box around the ellipsoid that holds the state with this probability.

    The ellipsoid is that of a normal distribution: chi-squared with 2 d degrees of freedom. The box contains at least
    this probability. Raises ``InvalidInput`` for a confidence outside [0.5, 1 - 1e-9].
    """
    from scipy.stats import chi2

    number("confidence", confidence, 0.5, 1.0 - 1e-9)
    kept = [*range(dimensions), *range(3, 3 + dimensions)]
    out: Floats = np.sqrt(chi2.ppf(confidence, 2 * dimensions) * np.diagonal(matrix)[kept])
    return out


def _cross(w: Floats) -> Floats:
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
