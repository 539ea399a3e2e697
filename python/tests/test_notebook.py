"""Runs the notebook from top to bottom, as a reader would."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import Any

import matplotlib.image
import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[2] / "examples/python/fingertip_to_finger.ipynb"


def read() -> Any:
    """Returns the committed notebook."""
    return nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]


def test_no_output_is_committed() -> None:
    notebook = read()
    nbformat.validate(notebook)
    for cell in notebook.cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None, f"{cell.id}: clear the outputs"
        assert not cell.metadata, f"{cell.id}: {cell.metadata}"
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    assert set(notebook.metadata.language_info) == {"name"}, "remove the metadata that the editor added"


@pytest.fixture(scope="module")
def executed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Executes the notebook outside of the clone, so that it can only use the installed package."""
    folder = tmp_path_factory.mktemp("notebook")
    notebook = read()
    with pytest.MonkeyPatch.context() as environment:
        # Directory of its runs.
        environment.setenv("TMPDIR", str(folder))
        # Timeout in s. The slowest cell takes 10 s on two idle cores.
        NotebookClient(notebook, timeout=900, kernel_name="python3", resources={"metadata": {"path": str(folder)}}).execute()
    return notebook


def outputs(executed: Any, kind: str) -> dict[str, list[str]]:
    """Returns the outputs of one kind, by cell id."""
    cells = {cell.id: [o.data[kind] for o in cell.get("outputs", []) if kind in o.get("data", {})] for cell in executed.cells}
    return {cell: shown for cell, shown in cells.items() if shown}


def test_each_figure_is_a_picture_of_something(executed: Any) -> None:
    figures = outputs(executed, "image/png")
    expected = [cell.id for cell in executed.cells if "plt.show()" in cell.source]
    assert list(figures) == expected and len(expected) == 5
    for cell, pictures in figures.items():
        (picture,) = (matplotlib.image.imread(io.BytesIO(base64.b64decode(shown)))[..., :3] for shown in pictures)
        rows, columns, _ = picture.shape
        assert 200 <= rows <= 1000 and 600 <= columns <= 1400, f"{cell}: {columns}x{rows} px"
        # Axes, text and empty frames are black, gray and white; data are coloured.
        coloured = np.mean(np.ptp(picture, axis=2) > 0.2)
        assert coloured > 0.005 and picture.std() > 0.05, f"{cell}: coloured {coloured:.1%}, deviation {picture.std():.3f}"


def test_the_run_shows_itself(executed: Any) -> None:
    shown = outputs(executed, "text/html")
    assert list(shown) == ["display", "pandas"]
    assert "11 of 11 claims pass" in shown["display"][0] and shown["display"][0].count("<figure") == 7


def test_nothing_is_said_but_progress(executed: Any) -> None:
    for cell in executed.cells:
        for output in cell.get("outputs", []):
            assert output.output_type != "error"
            if output.get("name") == "stderr":
                # A progress bar overwrites itself.
                assert cell.id in ("run", "sweep") and output.text[0] in "\r\n", f"{cell.id}: {output.text}"
