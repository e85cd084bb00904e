"""The scripts that draw the pictures of docs/; those that need a reconstruction run in tests/e2e/test_reconstruct.py."""

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


@pytest.mark.parametrize("script", DRAWN)
def test_pictures_are_drawn(script, tmp_path):
    subprocess.run([sys.executable, ROOT / "benchmarks" / script, tmp_path], check=True, timeout=300)
    for name in DRAWN[script]:
        with Image.open(tmp_path / name) as drawn, Image.open(ROOT / "docs" / "pictures" / name) as shown:
            assert drawn.size == shown.size and len(drawn.convert("RGB").getcolors(1 << 20)) > 20
