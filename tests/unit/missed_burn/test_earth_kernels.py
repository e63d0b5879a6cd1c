"""Compiled parts of the proof about the true Earth beside plain NumPy."""

import math

import numpy as np

from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, target_with
from safestart.missed_burn.earth.motion import inverse
from safestart.missed_burn.kernels.strays import influence_of, remainder, strays_from
from safestart.missed_burn.kernels.table import image_at, images_of
from safestart.missed_burn.kernels.variation import carried, course_of

TARGET = target_with(8.1e6, 0.1, 1.0, 0.3, 0.5)


def test_the_course_alone_is_the_course_with_its_transitions() -> None:
    course, tables = carried(TARGET, 7.0, 320, 16, STAGES, WEIGHTS)
    assert (course_of(TARGET, 7.0, 320, 16, STAGES, WEIGHTS) == course).all()
    # The transition is the derivative of the course in its start.
    for axis, size in ((0, 10.0), (4, 0.01)):
        off = np.zeros(6)
        off[axis] = size
        ahead, behind = (course_of(TARGET + s * off, 7.0, 320, 16, STAGES, WEIGHTS)[-1] for s in (1, -1))
        np.testing.assert_allclose((ahead - behind) / (2.0 * size), tables[-1, :, axis], rtol=1e-5, atol=1e-8)


def test_norms_of_blocks_between_nodes() -> None:
    _, nodes = carried(TARGET, 30.0, 100, 10, STAGES, WEIGHTS)
    found = influence_of(nodes)
    for j in range(11):
        for m in range(j + 1):
            blocks = (nodes[j] @ inverse(nodes)[m]).reshape(2, 3, 2, 3)
            np.testing.assert_allclose(
                found[:, :, j, m], np.sqrt((blocks**2).sum(axis=(1, 3))), rtol=1e-9, atol=1e-11
            )


def test_strays_add_up_part_by_part() -> None:
    """Beside a loop over the parts with the same trial radii: what each part's push does to all later ones."""
    _, nodes = carried(TARGET, 40.0, 96, 4, STAGES, WEIGHTS)
    influence, parts, h, k = influence_of(nodes), 24, 160.0, 1.3e-3
    reached, lowest = np.linspace(100.0, 3000.0, parts), 7.0e6
    grown, slid = math.cosh(k * h), math.sinh(k * h) / k
    by_position = (grown - 1.0) / k**2
    strays, trials = strays_from(reached, influence, grown, slid, by_position, lowest)
    pushes = np.array([remainder(lowest, trial) for trial in trials])
    assert (strays < 1e3).all()
    assert (reached + strays < trials).all()
    for j in range(parts):
        at, fast = (
            influence[:, 0, j, 1 : j + 1] @ pushes[:j] * by_position
            + influence[:, 1, j, 1 : j + 1] @ pushes[:j] * slid
        )
        needed = grown * at + slid * fast + by_position * pushes[j]
        assert needed <= strays[j] * (1.0 + 1e-12)
        assert needed >= strays[j] * (1.0 - 1e-6) - 1e-12
    # A push that no trial radius holds leaves the rest unbounded.
    far, _ = strays_from(np.full(parts, 4.0e6), influence, grown, slid, by_position, lowest)
    assert (far >= 1e30).all()


def test_images_at_one_time_are_those_of_all() -> None:
    rng = np.random.default_rng(3)
    tables, centre, columns = rng.normal(size=(5, 3, 6)), rng.normal(size=6), rng.normal(size=(4, 6))
    ends = np.array([1, 4])
    images, sizes = images_of(tables, centre, columns, ends)
    np.testing.assert_allclose(images[:, 0], tables @ centre, rtol=1e-13)
    np.testing.assert_allclose(
        images[:, 1:], np.einsum("tij,cj->tci", tables, columns), rtol=1e-12, atol=1e-14
    )
    np.testing.assert_allclose(sizes[:, 2], np.sqrt((images[:, 2:] ** 2).sum(axis=(1, 2))), rtol=1e-13)
    one, size = np.empty((5, 3)), np.empty(3)
    image_at(tables[2], centre, columns, ends, one, size)
    assert (one == images[2]).all()
    assert (size == sizes[2]).all()
