"""The Python examples run as they stand."""

import runpy
from pathlib import Path

import pytest

NEEDS_MORE = {
    "numpy_solver.py",  # a reconstruction: runs in tests/e2e
    "blender_cameras.py",  # Blender: test_import_calibration.py
    "newton_cloth.py",  # Newton, from PyPI, and minutes: docs/export-cloth.md has what it says
    "blender_character.py",  # Blender: test_baked.py
    "mediapipe_masks.py",  # MediaPipe, which brings its own OpenCV; what it writes is read in test_scan.py
}
EXAMPLES = sorted(p for p in (Path(__file__).parents[2] / "examples").glob("*.py") if p.name not in NEEDS_MORE)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.name)
def test_example_runs(path, capsys):
    ran = runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out
    if path.name == "hang_a_cloth.py":
        assert ran["state"].positions[:, 1].min() < 0.5  # it hangs, 0.95 m long
