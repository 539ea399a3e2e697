"""Runs the Python code of the book and of the package's README page by page, as a reader would."""

from __future__ import annotations

import importlib
import importlib.util
import re
import subprocess
from pathlib import Path

import feeler
import pytest
from conftest import missing, the_program

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = [page for page in [ROOT / "python/README.md", *sorted((ROOT / "docs").glob("*.md"))] if BLOCK.search(page.read_text())]

# Number of trials on a page, and in this test: a debug build takes almost a second per trial.
TRIALS, FEWER = "trials=100,", "trials=10,"

# Files written by the program that pages read.
EXPORTS = {"data-sets.md": [["parquet", "runs/seven", "-o", "seven.parquet"]]}


def test_there_are_pages() -> None:
    assert {"README.md", "python.md", "learning.md", "sweeps.md"} <= {page.name for page in PAGES}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_code_runs(page: Path, closing: feeler.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = [block.replace(TRIALS, FEWER) for block in BLOCK.findall(page.read_text())]
    if importlib.util.find_spec("lerobot") is None:
        # Needs a newer Python than the oldest version that the package supports.
        code = [block for block in code if "from lerobot" not in block]
    uses_ray = any('engine="ray"' in block for block in code)
    if uses_ray and importlib.util.find_spec("ray") is None:
        missing("ray")
    monkeypatch.chdir(tmp_path)
    # Ignore a running cluster.
    monkeypatch.setenv("RAY_ADDRESS", "local")
    # A run for pages that read one without creating it.
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs/seven").symlink_to(closing.folder)
    for arguments in EXPORTS.get(page.name, []):
        subprocess.run([the_program(), "export", *arguments], check=True)
    names: dict[str, object] = {"__name__": page.stem}
    try:
        for number, block in enumerate(code):
            exec(compile(block, f"{page.name}, block {number}", "exec"), names)
    finally:
        if uses_ray:
            importlib.import_module("ray").shutdown()
