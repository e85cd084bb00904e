"""The scripts that draw the pictures of docs/; those that need a reconstruction run in tests/e2e/test_reconstruct.py, all of them
in tests/run_nightly.sh."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
DRAWN = {
    "convention_pictures.py": ["conventions.png"],
    "cloth_pictures.py": ["cloth_drapes.png", "cloth_hangs.png", "cloth_dances.png"],
}

SHOWN = sorted(path.name for path in (ROOT / "docs" / "pictures").iterdir())


@pytest.mark.parametrize("name", SHOWN)
def test_a_picture_is_drawn_by_the_script_of_all_and_shown_in_a_page(name):
    commands = [line for line in (ROOT / "scripts" / "make-pictures.sh").read_text().splitlines() if not line.startswith("#")]
    assert any(re.search(rf"(^|[ /]){re.escape(name)}\b", line) for line in commands)
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    assert any(f"pictures/{name})" in page.read_text(encoding="utf-8") for page in pages)


@pytest.mark.parametrize("script", DRAWN)
def test_pictures_are_drawn(script, tmp_path):
    subprocess.run([sys.executable, ROOT / "benchmarks" / script, tmp_path], check=True, timeout=300)
    for name in DRAWN[script]:
        with Image.open(tmp_path / name) as drawn, Image.open(ROOT / "docs" / "pictures" / name) as shown:
            assert drawn.size == shown.size and len(drawn.convert("RGB").getcolors(1 << 20)) > 20
