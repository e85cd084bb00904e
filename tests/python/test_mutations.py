"""Twenty damaged files of each format (tests/fuzz/mutate.py reads them by the ten thousand)."""

import subprocess
import sys
from pathlib import Path

RUNNER = Path(__file__).parents[1] / "fuzz" / "mutate.py"


def test_damaged_files_are_read_or_refused():
    done = subprocess.run([sys.executable, str(RUNNER), "--count", "20"], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len([line for line in done.stdout.splitlines() if ": " in line]) >= 32, done.stdout
