"""The package over a native module without some rooms (DOUBLET_COMPONENTS), as of one that was built without capture."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WITHOUT = """
import importlib, pkgutil, re, sys
from pathlib import Path
import doublet._doublet as native

root, rooms = Path(sys.argv[1]), sys.argv[2:]
bindings = "".join(path.read_text() for room in rooms for path in (root / "bindings" / "src").glob(f"{room}*.cpp"))
headers = "".join(path.read_text() for room in rooms for path in (root / f"lib{room}").rglob("*.h"))
said = set(re.findall(r'"(\\w+)"', bindings)) | set(re.findall(r"(?:struct|class) (\\w+)", headers))
gone = [name for name in vars(native) if name in said and not name.startswith("__")]
assert len(gone) > 20, gone
for name in gone:
    delattr(native, name)
for name in [name for name in sys.modules if name.startswith("doublet") and name != native.__name__]:
    del sys.modules[name]
import doublet

# The command line, scans from cameras and reconstructions are of the whole package.
whole = ("doublet.cli", "doublet.scan", "doublet.__main__", "doublet.reconstruct.job", "doublet.reconstruct.stages")
for module in pkgutil.walk_packages(doublet.__path__, "doublet.", onerror=lambda name: None):
    if not module.name.startswith(whole):
        importlib.import_module(module.name)
from doublet import reconstruct, testing

assert "fit" in reconstruct.OPTION_GROUPS and "capture" not in reconstruct.OPTION_GROUPS
assert "cloth_solver_violations" in testing.__all__ and not hasattr(testing, "feature_tracker_violations")
"""


@pytest.mark.parametrize("rooms", [["capture", "reconstruct"], ["capture", "segment", "bodymodel", "reconstruct"]], ids="-".join)
def test_what_needs_no_capture_imports_without_it(rooms):
    done = subprocess.run([sys.executable, "-c", WITHOUT, ROOT, *rooms], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
