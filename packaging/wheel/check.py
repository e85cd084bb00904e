"""check.py WHEEL: says what is in a wheel that is to be published, and refuses one that must not be.

Every library in it is of the list below; what each of them needs is in the wheel, or on every Linux; none is under the GPL.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

LARGEST = 80e6  #: bytes
#: Of every Linux with this glibc: a part of the list of PEP 600.
SYSTEM = {
    "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1", "libc.so.6", "libdl.so.2", "libgcc_s.so.1", "libm.so.6", "libpthread.so.0",
    "librt.so.1", "libstdc++.so.6", "libz.so.1",
}  # fmt: skip
#: What may be in it, and its licence. A new one is read before it comes here; x264, x265 and poppler are GPL and never do.
LICENCES = {
    "libOpenMeshCore": "BSD-3-Clause",
    "libOpenMeshTools": "BSD-3-Clause",
    "libbz2": "bzip2",
    "libcrypto": "Apache-2.0",  # OpenSSL 3
    "libembree3": "Apache-2.0",
    "libjpeg": "IJG, BSD-3-Clause, zlib",
    "libpng16": "libpng",
    "libpugixml": "MIT",
    "libstb": "MIT",
    "libtbb": "Apache-2.0",
    "libtinygltf": "MIT",
    "libtomlplusplus": "MIT",
    "libz": "zlib",
    "libzip": "BSD-3-Clause",
}


def needed_by(path: Path) -> set[str]:
    said = subprocess.run(["readelf", "-d", str(path)], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"NEEDED.*\[(.*)\]", said))


def library_of(name: str) -> str:
    """libembree3-0e1f2a3b.so.3 is libembree3."""
    return re.sub(r"(-[0-9a-f]{8})?(\.so.*)$", "", name)


def problems_of(wheel: Path) -> list[str]:
    """One sentence for each thing that is wrong with it."""
    found = []
    if wheel.stat().st_size > LARGEST:
        found.append(f"expected at most {LARGEST / 1e6:.0f} MB, found {wheel.stat().st_size / 1e6:.1f}")
    if "manylinux" not in wheel.name:
        found.append(f"expected a tag of manylinux, found {wheel.name}")
    with tempfile.TemporaryDirectory() as folder:
        zipfile.ZipFile(wheel).extractall(folder)
        tree = Path(folder)
        shared = [path for path in tree.rglob("*.so*") if path.read_bytes()[:4] == b"\x7fELF"]
        brought = {path.name for path in shared}
        for path in sorted(shared):
            if path.parent.name == "doublet.libs" and re.sub(r"(\d*d)$", "", library_of(path.name)) not in LICENCES:
                found.append(f"expected libraries whose licence has been read, found {path.name}")
            for name in sorted(needed_by(path) - brought - SYSTEM):
                found.append(f"{path.name}: expected what it needs in the wheel or on every Linux, found {name}")
        texts = list(tree.glob("*.dist-info/licenses/libraries/*.txt"))
        if len(texts) < len(brought):
            found.append(f"expected a licence for each of {len(brought)} libraries, found {len(texts)}")
    return found


def main(wheel: Path) -> int:
    problems = problems_of(wheel)
    for problem in problems:
        print(f"{wheel.name}: {problem}", file=sys.stderr)
    if not problems:
        print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
