"""Total forces from arrays, with a calibration whose weights are given."""

from __future__ import annotations

import copy
import hashlib
import pickle
from pathlib import Path

import feeler
import numpy as np
import pytest
from numpy.typing import NDArray

SIDE = 6
SPACING = 24


def picture(shift: float) -> NDArray[np.uint8]:
    """Image of a grid of bright spots that have moved by ``shift`` pixels along x."""
    rows, columns = np.mgrid[: SIDE * SPACING, : SIDE * SPACING]
    x = (columns - shift) % SPACING - SPACING / 2
    y = rows % SPACING - SPACING / 2
    return np.asarray(20 + 180 * np.exp(-(x**2 + y**2) / 20), dtype=np.uint8)


@pytest.fixture(scope="module")
def layout() -> feeler.Layout:
    return feeler.locate(picture(0.0)[np.newaxis])


def calibration(path: Path, layout: feeler.Layout) -> str:
    """Calibration of f_x: a third of the mean displacement along x (N/px)."""
    layout.save(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    count = len(layout)
    elements = """
        [[model.elements]]
        used = true
        gray = 1000.0
        centroid = [0.0, 0.0]
        mean = [0.0, 0.0, 0.0, 0.0]
        scale = [1.0, 1.0, 1.0, 1.0]
        """
    weights = [1 / 3 / count, 0.0] * count
    errors = "{ rows = 10, rmse = 0.1, mae = 0.1, bias = 0.0 }"
    return f"""
        kind = "wrench"
        version = 1
        made_for = {{ sha256 = "{digest}", elements = {count}, length_unit = "px" }}
        quality = [{{ axis = "f_x", range = [-2.0, 2.0], mean_rmse = 1.0, r2 = 0.9, hysteresis = 0.0, blocks = {errors},
                     recordings = [] }}]
        [[model.axes]]
        axis = "f_x"
        terms = {{ growth = "ignored", displacement = true, squares = false }}
        penalty = 1.0
        intercept = 0.5
        weights = {weights}
        [model.novelty]
        terms = {{ growth = "ignored", displacement = true, squares = false }}
        limit = 4.0
        rest = 1.0
        directions = []
        {count * elements}
        """


def test_force_is_that_of_the_weights(tmp_path: Path, layout: feeler.Layout) -> None:
    text = calibration(tmp_path / "layout.toml", layout)
    (tmp_path / "wrench.toml").write_text(text, encoding="utf-8")
    estimator = feeler.WrenchEstimator.load(tmp_path / "wrench.toml", layout=tmp_path / "layout.toml")
    assert estimator.element_count == len(layout)
    shifts = [0.0, 1.0, 2.0]
    frames = np.stack([picture(shift) for shift in shifts])
    wrenches = estimator.estimate(frames)
    # Spots are located to 0.05 px; a spot partly outside its sub-region moves its centroid less, by up to a tenth.
    moved = wrenches.force[:, 0] - wrenches.force[0, 0]
    np.testing.assert_allclose(moved, np.array(shifts) / 3, rtol=0.1, atol=0.02)
    # The force is a third of the mean displacement of the same moments.
    displacement = feeler.Fingertip(layout=layout).with_reference(frames[:1]).sense(frames).displacement
    np.testing.assert_allclose(moved, displacement[..., 0].mean(axis=1) / 3, atol=1e-12)
    assert np.isnan(wrenches.force[:, 1:]).all() and np.isnan(wrenches.torque).all() and np.isnan(wrenches.place).all()
    assert wrenches.valid.all() and len(wrenches) == 3
    dark = estimator.estimate(np.zeros_like(frames[0]))
    assert not dark.valid[0] and np.isnan(dark.force).all() and np.isinf(dark.novelty[0])
    for other in (copy.deepcopy(estimator), pickle.loads(pickle.dumps(estimator))):
        np.testing.assert_array_equal(other.estimate(frames).force, wrenches.force)


def taxel_calibration(taxels: int) -> str:
    """Calibration of f_x: z of taxel 0, and f_z: a tenth of the difference between z of taxel 1 and its 0.3 s filter."""
    readings = 3 * taxels
    linear, memory = [0.0] * readings, [0.0] * (6 * readings)
    linear[2], memory[readings + 5] = 1.0, 1.0
    errors = "{ rows = 10, rmse = 0.1, mae = 0.1, bias = 0.0 }"
    quality = ", ".join(
        f'{{ axis = "{axis}", range = [-2.0, 2.0], mean_rmse = 1.0, r2 = 0.9, hysteresis = 0.0, blocks = {errors}, '
        "recordings = [] }"
        for axis in ("f_x", "f_z")
    )
    return f"""
        kind = "taxel_wrench"
        version = 1
        made_for = {{ sha256 = "", elements = {taxels}, length_unit = "m" }}
        quality = [{quality}]
        [[model.axes]]
        axis = "f_x"
        terms = {{ kind = "linear", memory = false }}
        penalty = 1.0
        intercept = 0.0
        weights = {linear}
        [[model.axes]]
        axis = "f_z"
        terms = {{ kind = "linear", memory = true }}
        penalty = 1.0
        intercept = 0.0
        weights = {memory}
        [model.novelty]
        terms = {{ kind = "linear", memory = false }}
        limit = 4.0
        rest = 1.0
        directions = []
        [model.elements]
        taxels = {taxels}
        norm_floor = 0.1
        features = {{ mean = {[0.0] * (6 * readings)}, scale = {[1.0] * (6 * readings)} }}
        """


def test_taxels_have_a_memory_that_begins_with_the_array() -> None:
    taxels, step = 11, 0.1
    estimator = feeler.WrenchEstimator(taxel_calibration(taxels))
    readings = np.zeros((5, taxels, 3))
    readings[1:, 0, 2] = 0.7
    readings[1:, 1, 2] = 1.0
    stamps = np.linspace(0.0, 4 * step, 5)
    first, again = estimator.estimate_taxels(readings, stamps), estimator.estimate_taxels(readings, stamps)
    np.testing.assert_array_equal(first.force, again.force)
    np.testing.assert_allclose(first.force[:, 0], readings[:, 0, 2], atol=1e-12)
    # The filter approaches a step exponentially.
    difference = np.where(stamps > 0, np.exp(-stamps / 0.3), 0.0)
    np.testing.assert_allclose(np.abs(first.force[:, 2]), 0.1 * difference, atol=1e-12)
    assert first.valid.all() and np.isnan(first.force[:, 1]).all()
    with pytest.raises(ValueError, match=r"readings: expected .*11, 3\], got float64 \[5, 3, 3\]"):
        estimator.estimate_taxels(readings[:, :3], stamps)
    with pytest.raises(ValueError, match="expected a calibration of a camera's sensor"):
        estimator.estimate(np.zeros((4, 4), dtype=np.uint8))


def test_other_inputs_are_refused(tmp_path: Path, layout: feeler.Layout) -> None:
    text = calibration(tmp_path / "layout.toml", layout)
    estimator = feeler.WrenchEstimator(text, layout=layout)
    with pytest.raises(ValueError, match=r"frames: expected .*144, 144\], got uint8 \[1, 10, 144\]"):
        estimator.estimate(np.zeros((10, 144), dtype=np.uint8))
    with pytest.raises(ValueError, match="expected a calibration of a taxel array"):
        estimator.estimate_taxels(np.zeros((1, len(layout), 3)), np.zeros(1))
    with pytest.raises(ValueError, match="pass its layout or experiment"):
        feeler.WrenchEstimator(text)
    with pytest.raises(ValueError, match="the calibration is for another fingertip"):
        feeler.WrenchEstimator(text, experiment="cap-closing")
    with pytest.raises(FileNotFoundError):
        feeler.WrenchEstimator.load(tmp_path / "none.toml")
