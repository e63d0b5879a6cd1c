"""Pictures of proofs show what is proved: every window, the whole of each set, and no more than it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from safestart.passive_safety.verify import Verification, verify
from safestart.processes.execute import execute
from safestart.processes.passive_safety import plots
from safestart.processes.passive_safety.run import question_of
from safestart.processes.passive_safety.spec import PassiveSafetyInputs
from safestart.processes.plotting import figure
from safestart.processes.registry import process
from safestart.processes.safe_abort_map.plots import _boxes
from safestart.processes.safe_abort_map.spec import SafeAbortMapInputs
from safestart.runtime.progress import Context


def verified(*windows: tuple[float, float]) -> list[Verification]:
    base = question_of(PassiveSafetyInputs.model_validate({}))
    return [verify(replace(base, window=window), Context(), 0) for window in windows]


@pytest.mark.parametrize("window", [(0.0, 240.0), (120.0, 125.0)])
def test_the_whole_of_every_drift_is_in_the_picture(window: tuple[float, float]) -> None:
    """The widest cells were cut off."""
    (answer,) = verified(window)
    whole, close = figure(10.0, 5.0).subplots(1, 2)
    plots._drift_row(whole, close, answer)
    (left, right), (low, high) = whole.get_xlim(), whole.get_ylim()
    for outlines, _ in plots._drifts(answer):
        x, y = np.asarray(outlines)[..., 0], np.asarray(outlines)[..., 1]
        assert left <= x.min() <= x.max() <= right
        assert low <= y.min() <= y.max() <= high


def test_every_window_has_its_row() -> None:
    """Only one of several was drawn."""
    one, two = verified((120.0, 125.0), (235.0, 240.0))
    heights = [plots.drift_picture(answers).data for answers in ([one], [one, two])]
    sizes = [int.from_bytes(data[20:24], "big") for data in heights]
    assert sizes[1] > 1.7 * sizes[0]


def test_a_safe_abort_map_paints_the_boxes_it_proves_and_nothing_between() -> None:
    """The cells reached from start to start, 75 m where 5 m were proved."""
    inputs = SafeAbortMapInputs.model_validate(
        {"arc": {"rings": 1, "angles": 3}, "windows": 2, "half_width_m": 4.0, "starts_per_shard": 3}
    )
    outputs = execute("safe-abort-map", inputs.model_dump(mode="json")).document["outputs"]
    process("safe-abort-map").outputs.model_validate(outputs)
    boxes = _boxes(inputs, outputs)
    assert boxes.shape == (3, 4, 2)
    np.testing.assert_allclose(
        boxes.mean(axis=1), np.stack([outputs["x_m"], outputs["y_m"]], axis=-1), atol=1e-9
    )
    np.testing.assert_allclose(np.ptp(boxes, axis=1), 8.0)
