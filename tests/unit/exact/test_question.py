"""The linear model of the exact question against interval-by-interval CWH flights."""

import numpy as np
import pytest

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.errors import InvalidInput
from safestart.exact.question import Question
from safestart.model.scenario import Scenario
from tests.unit.exact.linear_model import rows


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("mean_motion", [0.0, 1.1e-3])
def test_rows_are_the_face_distances_of_the_flight(dimensions: int, mean_motion: float) -> None:
    rng = np.random.default_rng(7)
    scenario = Scenario.of(3.0, 0.1, mean_motion)
    question = Question(scenario, dimensions=dimensions, steps=10)
    thrust, state = 0.1 * rng.normal(size=(10, dimensions)), 10.0 * rng.normal(size=2 * dimensions)
    times = np.r_[0.0, 2.0, 20.0, rng.uniform(0.0, 20.0, 7)]
    model = rows(question, times)
    predicted = model.constant(state) + model.thrust @ thrust.ravel()
    keep = np.r_[0:dimensions, 3 : 3 + dimensions]
    corridor = corridor_of(scenario.corridor, dimensions)
    for t, distances in zip(times, predicted, strict=True):
        x = np.zeros(6)
        x[keep] = state
        for k in range(10):
            held = min(2.0, max(0.0, t - 2.0 * k))
            x = (
                transition_matrix(mean_motion, held) @ x
                + input_matrix(mean_motion, held)[:, :dimensions] @ thrust[k]
            )
        p = x[:dimensions].copy()
        p[:2] = rotation(-scenario.target.tumble_rate * t) @ p[:2]
        np.testing.assert_allclose(distances, corridor.slack(p) / corridor.lengths, atol=1e-11)


@pytest.mark.parametrize(
    "change", [{"steps": 0}, {"steps": 1.5}, {"dt": 0.0}, {"dt": float("nan")}, {"dimensions": 4}]
)
def test_bad_questions(change: dict[str, object]) -> None:
    with pytest.raises(InvalidInput):
        Question(Scenario.of(1.0, 0.1), **change)  # type: ignore[arg-type]
