"""Runs, recordings, sessions, and tasks and laws in Python."""

from __future__ import annotations

import base64
import re
import signal
from html import escape
from pathlib import Path

import feeler
import numpy as np
import pytest
from feeler import FingerSense, HandSense, Plan
from numpy.typing import ArrayLike, NDArray


def test_a_run_has_summary_report_and_columns(closing: feeler.Run) -> None:
    assert closing.report_path.stat().st_size > 100_000
    assert all(claim["holds"] for claim in closing.summary["claims"])
    assert closing.force.shape == (len(closing.recording), 2, 41, 3)
    # Fig. 8: a maximum of about 40 mN·m, and the cap has turned.
    assert 0.03 < np.nanmax(closing.torque) < 0.06
    assert closing.recording.cap_angle[-1] > 0.3
    assert closing.recording.state == "done" and closing.recording.complete
    assert "claims pass" in repr(closing)
    with pytest.raises(AttributeError, match="expected one of time, phase"):
        _ = closing.forse


def test_a_notebook_shows_a_run_by_its_figures(closing: feeler.Run) -> None:
    shown = closing._repr_html_()
    assert escape(repr(closing)) in shown and f"href='{closing.report_path.as_posix()}'" in shown
    pictures = re.findall("src='data:image/svg\\+xml;base64,(.*?)'", shown)
    assert [base64.b64decode(picture) for picture in pictures] == [path.read_bytes() for path in closing.figures.values()]
    assert len(pictures) == 7 and "<figcaption>Grasp force and torque over the run</figcaption>" in shown


def test_a_recording_that_is_cut_short_is_read_with_a_warning(closing: feeler.Run, tmp_path: Path) -> None:
    whole = closing.recording.path.read_bytes()
    (tmp_path / "cut").write_bytes(whole[: len(whole) // 2])
    with pytest.warns(UserWarning, match="cut: incomplete recording: .*; read up to there"):
        recording = feeler.read(tmp_path / "cut")
    assert not recording.complete and 0 < len(recording) < len(closing.recording)
    np.testing.assert_array_equal(recording.time, closing.recording.time[: len(recording)])


def test_columns_are_read_only_and_flat_tables_hold_the_same(closing: feeler.Run) -> None:
    recording = closing.recording
    for name in recording.COLUMNS:
        column = getattr(recording, name)
        assert len(column) == len(recording) and not column.flags.writeable, name
    assert set(recording.phase) == {"SEARCH", "MOVE", "RELEASE", "RETURN", "DONE"}
    pandas, polars = recording.to_pandas(), recording.to_polars()
    np.testing.assert_array_equal(pandas["finger1.force.40.z"], recording.force[:, 1, 40, 2])
    np.testing.assert_array_equal(polars["finger0.joint_position.2"], recording.joint_position[:, 0, 2])
    np.testing.assert_array_equal(pandas["torque"], recording.torque)
    assert "object_position.x" not in pandas, "nothing is carried"


def test_forces_agree_with_grasp_force_and_flags(closing: feeler.Run) -> None:
    recording = closing.recording
    compression = np.maximum(recording.force[..., 2], 0.0).sum(axis=2)
    # Sums of 41 numbers in a different order.
    np.testing.assert_allclose(recording.grasp_force, compression, rtol=0, atol=1e-12)
    over_force = recording.experiment["control"]["over_force"]
    np.testing.assert_array_equal(recording.over, (recording.force[..., 2] > over_force).any(axis=2))


def test_no_run_is_written_over(closing: feeler.Run) -> None:
    with pytest.raises(ValueError, match="already contains a run"):
        feeler.run("cap-closing", sensing="direct", out=closing.folder)


def test_errors_have_the_programs_words(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match='no experiment "cap-closinx": expected a file or one of the built-in'):
        feeler.run("cap-closinx")
    with pytest.raises(ValueError, match=r"control\.slip_threshold = -1: expected more than 0"):
        feeler.Session("cap-closing", settings={"control.slip_threshold": -1})
    with pytest.raises(FileNotFoundError):
        feeler.read(tmp_path / "none.mcap")
    (tmp_path / "text.mcap").write_text("no recording")
    with pytest.raises(ValueError, match="magic bytes"):
        feeler.read(tmp_path / "text.mcap")


def test_a_folder_is_read_by_its_recording(closing: feeler.Run, tmp_path: Path) -> None:
    assert feeler.read(closing.folder).digest == closing.recording.digest
    with pytest.raises(FileNotFoundError, match=r"recording\.mcap"):
        feeler.read(tmp_path)


def test_progress_is_told(tmp_path: Path) -> None:
    told: list[float] = []
    feeler.run("cap-closing", sensing="image", settings={"time_limit": 1.5}, out=tmp_path / "run", progress=told.append)
    assert told and told == sorted(told) and told[-1] <= 1.51


def test_ctrl_c_ends_a_run_and_keeps_its_recording(tmp_path: Path) -> None:
    def interrupt(simulated: float) -> None:
        if simulated > 0.05:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        feeler.run("cap-closing", sensing="image", out=tmp_path / "run", progress=interrupt)
    recording = feeler.read(tmp_path / "run/recording.mcap")
    assert recording.state == "interrupted" and len(recording) > 0
    assert feeler.report(tmp_path / "run").report_path.exists()


def test_a_session_is_the_run(closing: feeler.Run) -> None:
    session = feeler.Session("cap-closing", seed=7, sensing="direct")
    for row, step in enumerate(session):
        assert step.time == closing.recording.time[row]
        for finger, sense in enumerate(step.fingers):
            np.testing.assert_array_equal(sense.force, closing.recording.force[row, finger])
            np.testing.assert_array_equal(sense.joint_position, closing.recording.joint_position[row, finger])
    assert row == len(closing.recording) - 1 and session.phase == "DONE" and session.run is None


class PaperLaw:
    """The finger speed estimator (Fig. 5), reimplemented from the paper."""

    def __init__(self, recompression_speed: float, minimum_grasp_force: float) -> None:
        self.recompression_speed = recompression_speed
        self.minimum_grasp_force = minimum_grasp_force
        self.situation: tuple[object, ...] | None = None
        self.kept: NDArray[np.float64] = np.zeros(3)

    def velocity(self, plan: Plan, finger: FingerSense) -> ArrayLike:
        weak = plan.keep_grasp and finger.grasp_force < self.minimum_grasp_force
        situation = (
            tuple(plan.velocity),
            tuple(plan.towards_object),
            plan.reflex,
            plan.keep_grasp,
            finger.touch,
            finger.slip,
            finger.over,
            weak,
        )
        # v is constant while plan and flags do not change.
        if situation != self.situation:
            self.situation = situation
            self.kept = plan.velocity
            if ((plan.reflex and finger.slip) or weak) and not finger.over:
                pressing = plan.towards_object
                if finger.largest_element is not None:
                    pressing = finger.normal[finger.largest_element]
                self.kept = plan.velocity + self.recompression_speed * pressing
        return self.kept


def test_the_papers_law_in_python_makes_the_same_run(closing: feeler.Run) -> None:
    control = closing.recording.experiment["control"]
    minimum = control.get("minimum_grasp_force", 0.2)
    laws = [PaperLaw(control["recompression_speed"], minimum) for _ in range(2)]
    session = feeler.Session("cap-closing", seed=7, sensing="direct", law=laws)
    for row, step in enumerate(session):
        joints = [sense.joint_position for sense in step.fingers]
        np.testing.assert_array_equal(joints, closing.recording.joint_position[row])
    assert row == len(closing.recording) - 1


class Squeeze(feeler.Task):
    """Two fingers close until both touch, press to a force, and open."""

    def __init__(self) -> None:
        self.approach = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
        self.force = 0.0

    @property
    def findings(self) -> dict[str, float]:
        return {"force_n": self.force}

    def advance(self, hand: HandSense) -> None:
        grasp = min(finger.grasp_force for finger in hand.fingers)
        if self.phase == "SEARCH" and grasp > 0.5:
            self.force, self.phase = grasp, "RELEASE"
        elif self.phase == "RELEASE" and not any(finger.touch for finger in hand.fingers):
            self.phase, self.outcome = "DONE", "squeezed"

    def plan(self, finger: int, hand: HandSense) -> Plan:
        speed = {"SEARCH": 4e-3, "RELEASE": -4e-3}.get(self.phase, 0.0)
        waits = self.phase == "SEARCH" and hand.fingers[finger].grasp_force > 0.6
        return Plan(0.0 * self.approach[finger] if waits else speed * self.approach[finger], self.approach[finger])


def test_a_task_in_python_runs_and_is_recorded(tmp_path: Path) -> None:
    session = feeler.Session("cap-closing", sensing="direct", task=Squeeze(), out=tmp_path / "squeeze")
    phases = [session.phase for _ in session]
    assert phases[0] == "SEARCH" and "RELEASE" in phases and session.outcome == "squeezed"
    assert 0.5 < session.findings["force_n"] < 1.0
    assert session.run is not None and session.run.recording.state == "done"


def test_what_a_task_or_law_raises_is_raised(tmp_path: Path) -> None:
    class Failing(feeler.Task):
        def advance(self, hand: HandSense) -> None:
            if hand.time > 0.1:
                raise RuntimeError("enough")

        def plan(self, finger: int, hand: HandSense) -> Plan:
            return Plan(np.zeros(3))

    session = feeler.Session("cap-closing", sensing="direct", task=Failing(), out=tmp_path / "failing")
    with pytest.raises(RuntimeError, match="enough"):
        for _ in session:
            pass
    assert session.stop_reason == "the task gave up: RuntimeError: enough"
    assert feeler.read(tmp_path / "failing/recording.mcap").state != "done"

    class Wrong:
        def velocity(self, plan: Plan, finger: FingerSense) -> ArrayLike:
            return [0.0, 1.0]

    with pytest.raises((TypeError, ValueError)):
        for _ in feeler.Session("cap-closing", sensing="direct", law=Wrong()):
            pass


def test_a_loops_body_may_move_the_hand() -> None:
    session = feeler.Session("cap-closing", sensing="direct")
    positions = []
    for step in session:
        positions.append(step.fingers[0].position)
        step.move([[0.0, 0.0, 2e-3], [0.0, 0.0, 2e-3]])
        if step.time > 0.5:
            break
    # 2 mm/s for half a second, less the servo lag.
    risen = positions[-1][2] - positions[0][2]
    assert 0.8e-3 < risen < 1.02e-3
    with pytest.raises(ValueError, match=r"velocity: expected float64 \[2, 3\], got float64 \[3\]"):
        step.move(np.zeros(3))


def test_a_session_cannot_be_asked_by_its_own_law() -> None:
    class Asks:
        def velocity(self, plan: Plan, finger: FingerSense) -> ArrayLike:
            session.stop("itself")
            return np.zeros(3)

    session = feeler.Session("cap-closing", sensing="direct", law=Asks())
    with pytest.raises(RuntimeError, match="in the middle of a step"):
        for _ in session:
            pass
