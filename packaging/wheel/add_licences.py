"""add_licences.py PLAIN REPAIRED FOLDER: the repaired wheel, with the licences of everything in it, as a file of FOLDER.

Debian's copyright files of the packages whose libraries auditwheel copied into it, and of those that are compiled into it; the
licences of third_party/ are there as they are here.
"""

import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
#: Of packages that are compiled in: static libraries, and headers.
COMPILED_IN = (
    "libboost1.74-dev",
    "libeigen3-dev",
    "liblbfgspp-dev",
    "libnanoflann-dev",
    "libopencv-core-dev",
    "libtinygltf-dev",
    "libtomlplusplus-dev",
    "nlohmann-json3-dev",
)


def bundled_names(wheel: Path) -> list[str]:
    """As the system calls them: auditwheel has put a hash into the name."""
    names = [Path(name).name for name in zipfile.ZipFile(wheel).namelist() if name.startswith("doublet.libs/") and ".so" in name]
    return sorted(re.sub(r"-[0-9a-f]{8}(?=[.-])", "", name) for name in names)


def places_of_libraries(plain: Path) -> dict[str, str]:
    """Name of each library that the module needs, and they in turn -> where it is."""
    with tempfile.TemporaryDirectory() as folder:
        module = next(name for name in zipfile.ZipFile(plain).namelist() if re.fullmatch(r"doublet/_doublet\..*\.so", name))
        path = zipfile.ZipFile(plain).extract(module, folder)
        linked = subprocess.run(["ldd", path], capture_output=True, text=True, check=True).stdout
        places = [Path(place) for place in re.findall(r"=> (/\S+)", linked)]
        return {name: str(place) for place in places for name in (place.name, place.resolve().name)}


def package_of(path: str) -> str:
    for tried in (path, str(Path(path).resolve()), path.removeprefix("/usr"), "/usr" + path):
        owner = subprocess.run(["dpkg", "-S", tried], capture_output=True, text=True).stdout
        if owner:
            return owner.split(":")[0]
    raise SystemExit(f"{path}: expected a library of a Debian package, whose licence is known")


def main(plain: Path, repaired: Path, folder: Path) -> None:
    places = places_of_libraries(plain)
    packages = {package_of(places[name]) for name in bundled_names(repaired)} | set(COMPILED_IN)
    with tempfile.TemporaryDirectory() as temporary:
        subprocess.run(
            [sys.executable, "-m", "wheel", "unpack", "-d", temporary, repaired], check=True, stdout=subprocess.DEVNULL
        )
        (tree,) = Path(temporary).iterdir()
        (info,) = tree.glob("*.dist-info")
        licences = info / "licenses" / "libraries"
        licences.mkdir(parents=True)
        for package in sorted(packages):
            shutil.copy(Path("/usr/share/doc", package, "copyright"), licences / f"{package}.txt")
        for name in ("PoissonRecon", "ufbx"):
            shutil.copy(ROOT / "third_party" / name / "LICENSE", licences / f"{name}.txt")
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", "-d", folder, tree], check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
