"""Compiled part of the sweep: left and right derivative along one axis, five schemes."""

from __future__ import annotations

from safestart.levelset.kernels.jit_options import Indices, Value, Word, inlined, part
from safestart.levelset.numbers import ENO2, ENO3, FIRST, WENO3
from safestart.model.scenario import Floats


@part
def _first_order(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Differences to either neighbour, three runs."""
    a, b, c = at[0], at[1], at[2]
    for j in range(length):
        left[to + j] = (src[b + j] - src[a + j]) * scale
        right[to + j] = (src[c + j] - src[b + j]) * scale


@inlined
def _bends(src: Floats, a: Word, b: Word, c: Word, d: Word, e: Word, scale: float) -> tuple[Value, ...]:
    """For five values: the slopes to either neighbour of the middle one, and the three second differences."""
    d0, d1 = (src[b] - src[a]) * scale, (src[c] - src[b]) * scale
    d2, d3 = (src[d] - src[c]) * scale, (src[e] - src[d]) * scale
    return d1, d2, d1 - d0, d2 - d1, d3 - d2


@part
def _eno2(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Second-order essentially non-oscillatory (Osher and Shu 1991), five runs; ties take the left stencil."""
    half = src.dtype.type(0.5)
    a, b, c, d, e = at[0], at[1], at[2], at[3], at[4]
    for j in range(length):
        d1, d2, e0, e1, e2 = _bends(src, a + j, b + j, c + j, d + j, e + j, scale)
        left[to + j] = d1 + half * (e1 if abs(e1) < abs(e0) else e0)
        right[to + j] = d2 - half * (e2 if abs(e2) < abs(e1) else e1)


@part
def _weno3(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Third-order weighted ENO, five runs; the weights 1/3, 2/3 over (E^2 + eps)^2 on one denominator."""
    real = src.dtype.type
    half, two, eps = real(0.5), real(2.0), real(1e-6)
    a, b, c, d, e = at[0], at[1], at[2], at[3], at[4]
    for j in range(length):
        d1, d2, e0, e1, e2 = _bends(src, a + j, b + j, c + j, d + j, e + j, scale)
        s0, s1, s2 = e0 * e0 + eps, e1 * e1 + eps, e2 * e2 + eps
        # Weights 1/s0^2 : 2/s1^2 (left) and 2/s1^2 : 1/s2^2 (right), times both squares.
        w0, w1, w2 = two * s0 * s0, s1 * s1, two * s2 * s2
        left[to + j] = d1 + half * (w1 * e0 + w0 * e1) / (w1 + w0)
        right[to + j] = d2 - half * (w2 * e1 + w1 * e2) / (w2 + w1)


@inlined
def _third_order(
    src: Floats, a: Word, b: Word, c: Word, d: Word, e: Word, f: Word, g: Word, scale: float
) -> tuple[Value, ...]:
    """For seven values: third-order derivatives at the middle one by four stencils, and the five second differences."""
    real = src.dtype.type
    third, five, six = real(1.0 / 3.0), real(5.0 / 6.0), real(1.0 / 6.0)
    seven, eleven = real(7.0 / 6.0), real(11.0 / 6.0)
    d0, d1 = (src[b] - src[a]) * scale, (src[c] - src[b]) * scale
    d2, d3 = (src[d] - src[c]) * scale, (src[e] - src[d]) * scale
    d4, d5 = (src[f] - src[e]) * scale, (src[g] - src[f]) * scale
    q0 = third * d0 - seven * d1 + eleven * d2
    q1 = five * d2 - six * d1 + third * d3
    q2 = third * d2 + five * d3 - six * d4
    q3 = eleven * d3 - seven * d4 + third * d5
    return q0, q1, q2, q3, d1 - d0, d2 - d1, d3 - d2, d4 - d3, d5 - d4


@part
def _eno3(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Third-order essentially non-oscillatory, seven runs."""
    a, b, c, d, e, f, g = at[0], at[1], at[2], at[3], at[4], at[5], at[6]
    for j in range(length):
        q0, q1, q2, q3, e0, e1, e2, e3, e4 = _third_order(
            src, a + j, b + j, c + j, d + j, e + j, f + j, g + j, scale
        )
        f0, f1, f2, f3 = abs(e1 - e0), abs(e2 - e1), abs(e3 - e2), abs(e4 - e3)
        middle_low = q2 if f2 < f1 else q1
        left[to + j] = middle_low if abs(e2) < abs(e1) else (q1 if f1 < f0 else q0)
        right[to + j] = (q3 if f3 < f2 else q2) if abs(e3) < abs(e2) else middle_low


@inlined
def _roughness(src: Floats, a: Value, b: Value, c: Value, d: Value) -> tuple[Value, ...]:
    """Jiang and Peng's smoothness of the three stencils of one side, plus epsilon, from four second differences."""
    real = src.dtype.type
    k4, k5, k10, k11 = real(4.0 / 3.0), real(5.0 / 3.0), real(10.0 / 3.0), real(11.0 / 3.0)
    eps = real(1e-6)
    return (
        a * (k4 * a - k11 * b) + k10 * b * b + eps,
        b * (k4 * b - k5 * c) + k4 * c * c + eps,
        c * (k10 * c - k11 * d) + k4 * d * d + eps,
    )


@part
def _weno5(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Fifth-order weighted ENO (Jiang and Peng 2000), seven runs; one division per side."""
    sixfold, threefold = src.dtype.type(6.0), src.dtype.type(3.0)
    a, b, c, d, e, f, g = at[0], at[1], at[2], at[3], at[4], at[5], at[6]
    for j in range(length):
        q0, q1, q2, q3, e0, e1, e2, e3, e4 = _third_order(
            src, a + j, b + j, c + j, d + j, e + j, f + j, g + j, scale
        )
        # Weights 1/s0^2 : 6/s1^2 : 3/s2^2 (left) and 3/s0^2 : 6/s1^2 : 1/s2^2 (right), times all the squares.
        s0, s1, s2 = _roughness(src, e0, e1, e2, e3)
        u0, u1, u2 = s1 * s2, s0 * s2, s0 * s1
        w0, w1, w2 = u0 * u0, sixfold * u1 * u1, threefold * u2 * u2
        left[to + j] = (w0 * q0 + w1 * q1 + w2 * q2) / (w0 + w1 + w2)
        s0, s1, s2 = _roughness(src, e1, e2, e3, e4)
        u0, u1, u2 = s1 * s2, s0 * s2, s0 * s1
        w0, w1, w2 = threefold * u0 * u0, sixfold * u1 * u1, u2 * u2
        right[to + j] = (w0 * q1 + w1 * q2 + w2 * q3) / (w0 + w1 + w2)


@part
def derivatives(
    scheme: int, src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Left and right derivative by the scheme's number (see :mod:`safestart.levelset.scheme`)."""
    if scheme == FIRST:
        _first_order(src, at, scale, left, right, to, length)
    elif scheme == ENO2:
        _eno2(src, at, scale, left, right, to, length)
    elif scheme == WENO3:
        _weno3(src, at, scale, left, right, to, length)
    elif scheme == ENO3:
        _eno3(src, at, scale, left, right, to, length)
    else:
        _weno5(src, at, scale, left, right, to, length)
