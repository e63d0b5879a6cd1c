"""Names of the solver's choices: derivative, flux, set."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from safestart.levelset import numbers


class Scheme(StrEnum):
    """One-sided derivative, each with the Runge-Kutta order that fits its accuracy."""

    FIRST = "first"
    ENO2 = "eno2"
    WENO3 = "weno3"
    ENO3 = "eno3"
    WENO5 = "weno5"


class SchemeFacts(NamedTuple):
    """Its number in the kernel, its ghost nodes, its default number of Runge-Kutta stages."""

    number: int
    width: int
    stages: int


FACTS = {
    Scheme.FIRST: SchemeFacts(numbers.FIRST, 1, 1),
    Scheme.ENO2: SchemeFacts(numbers.ENO2, 2, 2),
    Scheme.WENO3: SchemeFacts(numbers.WENO3, 2, 3),
    Scheme.ENO3: SchemeFacts(numbers.ENO3, 3, 3),
    Scheme.WENO5: SchemeFacts(numbers.WENO5, 3, 3),
}


class Flux(StrEnum):
    """Numerical Hamiltonian.

    ``LAX_FRIEDRICHS`` works for all; its dissipation at a node is the largest |dH/dp_i| there. ``GODUNOV`` has the
    least dissipation of all monotone ones; it needs a separable H: every input channel moves one axis, no ball
    of more than one channel, no price.
    """

    LAX_FRIEDRICHS = "lax_friedrichs"
    GODUNOV = "godunov"


class Kind(StrEnum):
    """Which times count.

    ``FIXED``: the value at the horizon. ``TUBE``: the least value on the way (reach: {V <= 0} can be brought, or
    is forced, into the target at some time). ``ALWAYS``: the largest on the way (stay: {V <= 0} can be kept in it).
    """

    FIXED = "fixed"
    TUBE = "tube"
    ALWAYS = "always"


FLUX_NUMBER = {Flux.LAX_FRIEDRICHS: numbers.LAX_FRIEDRICHS, Flux.GODUNOV: numbers.GODUNOV}
KIND_NUMBER = {
    Kind.FIXED: numbers.FIXED,
    Kind.TUBE: numbers.TUBE,
    Kind.ALWAYS: numbers.ALWAYS,
}
