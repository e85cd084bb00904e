import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SESSION = ROOT / "examples" / "data" / "session"


def doublet(*arguments, timeout=900, **options):
    """Runs the command line as a user does; returns the finished process."""
    command = [sys.executable, "-m", "doublet", *(str(a) for a in arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, **options)


@pytest.fixture
def broken_session(tmp_path):
    """A copy of the shipped session that a test may spoil; the videos are links."""
    copy = tmp_path / "session"
    shutil.copytree(SESSION, copy, ignore=shutil.ignore_patterns("videos", "ground_truth"))
    (copy / "videos").mkdir()
    for video in (SESSION / "videos").iterdir():
        (copy / "videos" / video.name).symlink_to(video)
    return copy


@pytest.fixture(scope="session")
def shipped():
    return SESSION


@pytest.fixture(scope="session")
def cpp_examples():
    """The folder of the C++ examples that were built."""
    build = os.environ.get("DOUBLET_BUILD_DIR")
    if not build:
        pytest.skip("DOUBLET_BUILD_DIR does not name a build folder (tests/run_tests.sh sets it)")
    return Path(build) / "examples"
