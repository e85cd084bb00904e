"""In a program that has set the language of its user, where numbers have a comma: files are the same."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import locale
import sys
from pathlib import Path

import doublet as d
import numpy as np

if len(sys.argv) > 2:
    locale.setlocale(locale.LC_NUMERIC, sys.argv[2])
    assert locale.localeconv()["decimal_point"] == ","
record = d.RunRecord(sys.argv[1])
record.begin("performance", {}, {})
record.end("performance", {"silhouette_iou_against_measured_masks": 0.9712345678}, [])
print(record.summary("performance"))
skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0.25, 0.5, 0], 6)])
poses = np.linspace(-0.5, 0.75, 18).reshape(3, 6)
d.write_bvh("motion.bvh", skeleton, d.Motion(40, poses))
print(Path("motion.bvh").read_text())
clip = d.SourceMotion.read("motion.bvh")
print(clip.fps, np.asarray(clip.positions).tolist())
"""


def said(folder, *language) -> str:
    folder.mkdir()
    command = [sys.executable, "-c", PROGRAM, "out", *language]
    environment = {**os.environ, "LOCPATH": str(folder.parent)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_numbers_have_a_point_in_any_language(tmp_path):
    if not shutil.which("localedef") or not Path("/usr/share/i18n/locales/de_DE").exists():
        pytest.skip("needs the package locales")
    subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", tmp_path / "de_DE.UTF-8"], capture_output=True, check=True)
    usual = said(tmp_path / "usual")
    assert "0.971235" in usual and "OFFSET 0.250000 0.500000 0.000000" in usual
    assert said(tmp_path / "german", "de_DE.UTF-8") == usual
