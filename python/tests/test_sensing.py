"""Sensing on arrays, compared with the forces that the control loop measured in the same images."""

from __future__ import annotations

import copy
import pickle
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import feeler
import numpy as np
import pytest
from conftest import CALIBRATION
from numpy.typing import NDArray

Frames = NDArray[np.uint8]


@pytest.fixture(scope="module")
def tip() -> feeler.Fingertip:
    return feeler.Fingertip.load(CALIBRATION)


def test_forces_and_flags_are_those_of_the_run(tip: feeler.Fingertip, pictured: feeler.Run, frames: Frames) -> None:
    recording = pictured.recording
    rows = len(frames)
    felt = tip.sense(frames, stamps=recording.time[:rows].copy())
    # The same images through the same chain: bit-identical.
    np.testing.assert_array_equal(felt.force, recording.force[:rows, 0])
    np.testing.assert_array_equal(felt.shear_rate, recording.shear_rate[:rows, 0])
    for name in ("touch", "slip", "over", "grasp_force"):
        np.testing.assert_array_equal(getattr(felt, name), getattr(recording, name)[:rows, 0], err_msg=name)
    assert felt.touch.any() and not felt.touch.all(), "the finger touches at some time"
    assert felt.valid.all() and felt.gray.min() > 0


def test_threads_change_nothing(tip: feeler.Fingertip, frames: Frames) -> None:
    one, four = tip.sense(frames, threads=1), tip.sense(frames, threads=4)
    for name in ("force", "valid", "gray", "displacement", "shear_rate"):
        np.testing.assert_array_equal(getattr(one, name), getattr(four, name), err_msg=name)


def test_threads_of_python_may_share_a_fingertip(tip: feeler.Fingertip, frames: Frames) -> None:
    felt: list[feeler.Felt] = []
    threads = [threading.Thread(target=lambda: felt.append(tip.sense(frames))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(felt) == 4
    for other in felt[1:]:
        np.testing.assert_array_equal(felt[0].force, other.force)


def test_outputs_are_written_in_place(tip: feeler.Fingertip, frames: Frames) -> None:
    out = feeler.Felt.empty(10, tip.element_count)
    force = out.force
    assert tip.sense(frames[:10], out=out) is out
    assert out.force is force
    np.testing.assert_array_equal(force, tip.sense(frames[:10]).force)


def test_one_picture_is_a_batch_of_one(tip: feeler.Fingertip, frames: Frames) -> None:
    felt = tip.sense(frames[5])
    assert felt.force.shape == (1, 41, 3)
    np.testing.assert_array_equal(felt.force, tip.sense(frames[5:6]).force)


def test_errors_name_the_mismatched_array(tip: feeler.Fingertip, frames: Frames) -> None:
    cases: list[tuple[object, str]] = [
        (frames.astype(np.float32), r"frames: expected .* uint8 \[N, 480, 640\], got float32"),
        (frames[:, :100], r"uint8 \[N, 480, 640\], got uint8 \[\d+, 100, 640\]"),
        (frames[:, :, ::2], r"got uint8 \[\d+, 480, 320\]"),
        (frames[::2], "np.ascontiguousarray"),
        (np.asfortranarray(frames[:2]), "np.ascontiguousarray"),
        ([1, 2], "got list"),
        (frames[np.newaxis], r"got uint8 \[1, "),
    ]
    for given, words in cases:
        with pytest.raises(ValueError, match=words):
            tip.sense(given)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"out.force: expected .* float64 \[3, 41, 3\], got float64 \[2, 41, 3\]"):
        tip.sense(frames[:3], out=feeler.Felt.empty(2, 41))
    locked = feeler.Felt.empty(3, 41)
    locked.valid.flags.writeable = False
    with pytest.raises(ValueError, match=r"out.valid: .* read-only"):
        tip.sense(frames[:3], out=locked)
    with pytest.raises(ValueError, match="stamps: expected rising"):
        tip.sense(frames[:3], stamps=np.zeros(3))
    with pytest.raises(ValueError, match="rate: expected"):
        tip.sense(frames[:3], rate=-1.0)
    with pytest.raises(ValueError, match="threads: expected 1 or more"):
        tip.sense(frames[:3], threads=0)


def test_dark_and_saturated_forces_are_not_valid(tip: feeler.Fingertip) -> None:
    frames = np.zeros((2, 480, 640), dtype=np.uint8)
    frames[1] = 255
    felt = tip.sense(frames)
    assert not felt.valid.any()
    assert np.isnan(felt.force).all()
    assert not felt.touch.any() and (felt.gray[0] == 0).all()


def test_without_calibration_displacements_count_from_a_reference(pictured: feeler.Run, frames: Frames) -> None:
    tip = feeler.Fingertip(experiment="cap-closing").with_reference(frames[:20])
    felt = tip.sense(frames)
    assert not tip.is_calibrated and np.isnan(felt.force).all() and felt.valid.all()
    # Without load the centroids stay within the image noise, 2.5 um; under load they move by far more.
    touching = pictured.recording.touch[: len(frames), 0]
    moved = np.abs(felt.displacement).max(axis=(1, 2))
    assert moved[:20].max() < 30e-6 < moved[touching].max()


def test_layouts_are_located_saved_and_used(frames: Frames, tmp_path: Path) -> None:
    layout = feeler.locate(frames[:20], dome="cap-closing")
    assert len(layout) == 41 and layout.centres.shape == (41, 2) and layout.radii.min() > 0
    layout.save(tmp_path / "my.layout.toml")
    read = feeler.Layout.load(tmp_path / "my.layout.toml")
    np.testing.assert_array_equal(read.centres, layout.centres)
    felt = feeler.Fingertip(layout=read).with_reference(frames[:20]).sense(frames[:30])
    assert felt.gray.shape == (30, 41)
    with pytest.raises(FileExistsError):
        layout.save(tmp_path / "my.layout.toml")
    with pytest.raises(ValueError, match="black"):
        feeler.locate(np.zeros((48, 64), dtype=np.uint8))


def test_a_calibration_is_fitted_to_loads_and_predicts_others() -> None:
    loaded, forces = feeler.simulate_loads(loads=60)
    calibration = feeler.calibrate(frames=loaded, forces=forces, model="coupled")
    others, held_out = feeler.simulate_loads(loads=20, seed=2)
    error = feeler.Fingertip(calibration).sense(others).force - held_out
    rms = np.sqrt((error**2).mean(axis=(0, 1)))
    # Full scale is 1 N of shear and 2 N of compression. With 400 loads, the reference has errors of 0.5 and 0.15 %.
    assert (rms < [0.02, 0.02, 0.02]).all(), rms


def test_loads_that_do_not_determine_a_calibration_are_rejected(pictured: feeler.Run, frames: Frames, tmp_path: Path) -> None:
    forces = np.ascontiguousarray(pictured.recording.force[: len(frames), 0])
    unloaded = np.abs(forces).max(axis=2) < 0.01
    forces[unloaded] = 0.0
    # Elements that the cap never touches have no loads to fit.
    with pytest.raises(ValueError, match="element"):
        feeler.calibrate(frames=frames, forces=forces)
    with pytest.raises(ValueError, match=r"forces: expected .* float64 \[\d+, E, 3\]"):
        feeler.calibrate(frames=frames, forces=forces[:3])
    with pytest.raises(ValueError, match="expected a file of loads"):
        feeler.calibrate()
    with pytest.raises(FileNotFoundError, match=r"nowhere\.csv"):
        feeler.calibrate(tmp_path / "nowhere.csv")


def test_calibrations_are_read_and_written(tmp_path: Path) -> None:
    calibration = feeler.Calibration.load(CALIBRATION)
    assert calibration.model == "coupled" and calibration.held_out_rms.shape == (41, 3)
    calibration.save(tmp_path / "copy.toml")
    assert "coupled" in repr(feeler.Calibration.load(tmp_path / "copy.toml"))
    with pytest.raises(ValueError, match="version"):
        (tmp_path / "other.toml").write_text("version = 1\n")
        feeler.Fingertip.load(tmp_path / "other.toml")
    with pytest.raises(FileNotFoundError):
        feeler.Fingertip.load(tmp_path / "none.toml")
    with pytest.raises(ValueError, match="calibration, a layout or an experiment"):
        feeler.Fingertip()


def test_element_poses_of_a_fingertip(tip: feeler.Fingertip) -> None:
    session = feeler.Session("cap-closing", seed=7, sensing="direct")
    finger = next(step for step in session if session.phase == "MOVE").fingers[0]
    assert finger.touch and np.linalg.norm(finger.resultant) > 0.5
    # The control loop computes the resultant in the world frame from the same poses.
    np.testing.assert_allclose(tip.rotations[:, :, 2] @ finger.rotation.T, finger.normal, atol=1e-12)
    in_world = tip.force_on_fingertip(finger.force).sum(axis=0) @ finger.rotation.T
    np.testing.assert_allclose(in_world, finger.resultant, atol=1e-12)
    np.testing.assert_allclose(tip.tips, 0.018 * tip.rotations[:, :, 2], atol=1e-12)
    # The apex comes first, on the dome's axis.
    np.testing.assert_allclose(tip.tips[0], [0.018, 0.0, 0.0], atol=1e-12)
    with pytest.raises(ValueError, match=r"force: expected float64 \[..., 41, 3\], got \[40, 3\]"):
        tip.force_on_fingertip(finger.force[:40])


def test_elements_are_where_they_are_found(tip: feeler.Fingertip, frames: Frames) -> None:
    untouched = frames[:20]
    found = feeler.locate(untouched, dome="cap-closing")
    on_dome = feeler.Fingertip(layout=found)
    np.testing.assert_array_equal(on_dome.centres, found.centres)
    # Spots of a dozen pixels are located to a tenth of a pixel; at the rim a pixel is 0.1 mm.
    np.testing.assert_allclose(tip.centres, found.centres, atol=0.5)
    np.testing.assert_allclose(tip.tips, on_dome.tips, atol=0.1e-3)
    np.testing.assert_allclose(tip.rotations, on_dome.rotations, atol=0.1)
    flat = feeler.Fingertip(layout=feeler.locate(untouched))
    assert flat.centres.shape == (41, 2)
    with pytest.raises(ValueError, match="located without a dome"):
        _ = flat.tips


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))])
def test_fingertips_calibrations_and_layouts_are_copied(
    copied: Callable[[Any], Any], tip: feeler.Fingertip, frames: Frames
) -> None:
    calibration = feeler.Calibration.load(CALIBRATION)
    assert copied(calibration).report() == calibration.report()
    other = copied(tip)
    np.testing.assert_array_equal(other.sense(frames).force, tip.sense(frames).force)
    assert other.thresholds == tip.thresholds
    layout = feeler.locate(frames[:5])
    other = copied(layout)
    np.testing.assert_array_equal(other.centres, layout.centres)
    assert other.warnings == layout.warnings and repr(other) == repr(layout)
    located = feeler.Fingertip(layout=layout).with_reference(frames[:5])
    np.testing.assert_array_equal(copied(located).sense(frames).displacement, located.sense(frames).displacement)


def test_contacts_of_forces(tip: feeler.Fingertip) -> None:
    force = np.zeros((3, tip.element_count, 3))
    force[1, 0] = [0.7, 0.0, 1.0]
    force[2, :5] = [0.0, 0.0, 0.5]
    force[2, 9] = np.nan
    contacts = feeler.contacts(force, tip.tips, tip.rotations, friction=0.7)
    np.testing.assert_array_equal(contacts.touching, [0, 1, 5])
    assert np.isnan(contacts.centre[0]).all() and np.isnan(contacts.sliding[0])
    np.testing.assert_allclose(contacts.centre[1], tip.tips[0], atol=1e-12)
    np.testing.assert_allclose(contacts.force[1], tip.force_on_fingertip(force)[1, 0], atol=1e-12)
    np.testing.assert_array_equal(contacts.sliding[1:], [1.0, 0.0])
    assert contacts.area[2] > 0 and np.isnan(contacts.area[1])
    with pytest.raises(ValueError, match=r"tips: expected .*\[41, 3\], got float64 \[3, 3\]"):
        feeler.contacts(force, tip.tips[:3], tip.rotations)
    with pytest.raises(ValueError, match="touch: expected a number greater than 0, got -1"):
        feeler.contacts(force, tip.tips, tip.rotations, touch=-1)
