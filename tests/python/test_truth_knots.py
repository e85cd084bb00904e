"""What tells how much a true garment is worth: faces that cross."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
CLEAN = 3  # frames before the garment passes through itself


@pytest.fixture
def truth(tmp_path, shapes):
    """A skirt of which one vertex goes out through the other side."""
    body, body_faces = shapes["tube"](0.10, 0.0, 1.0)
    cloth, cloth_faces = shapes["tube"](0.20, 0.4, 0.7)
    frames = np.stack([cloth] * (CLEAN + 1))
    frames[CLEAN, 0] *= [-1.5, 1, -1.5]
    np.savez(tmp_path / "static.npz", body_tris=body_faces, cloth_tris=cloth_faces)
    np.savez(tmp_path / "frames_0000.npz", frames=np.arange(CLEAN + 1), body=np.stack([body] * (CLEAN + 1)), cloth=frames)
    np.savez(tmp_path / "skeleton.npz", joint_names=["pelvis"], joints=np.tile([0.0, 0.5, 0.0], (CLEAN + 1, 1, 1)))
    return tmp_path


def test_counts_crossing_faces_and_compares_before_and_after(truth):
    command = [sys.executable, BENCHMARKS / "truth_knots.py", truth, "--again", truth]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    counts = [int(line.split(":")[1].split(";")[0]) for line in lines if line.startswith("frame")]
    assert counts[:CLEAN] == [0] * CLEAN and counts[CLEAN] > 0
    compared = [line for line in lines if line.startswith("again")]
    assert [line.split(":")[0] for line in compared] == ["again, all", f"again, before {CLEAN}", f"again, from {CLEAN} on"]
    assert all("flare_cm 0.00" in line and "resim_two_sided_cm 0.00" in line for line in compared)
