#!/usr/bin/env bash
# Builds everything once with warnings as errors and runs every check: style, ctest, pytest. Sets itself up on a bare Debian 12.
# Arguments go to pytest; with --build-only it ends when the package is built and installed.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/apt-install.sh scripts/apt-packages.txt scripts/apt-packages-tests.txt
command -v npm >/dev/null || scripts/apt-install.sh scripts/apt-packages-node.txt

build=$PWD/build/tests
venv=$PWD/build/tests-venv
node=$PWD/build/tests-node
mkdir -p build

echo "== a browser and the viewer's bundle, beside pip, style and build"
(scripts/apt-install.sh scripts/apt-packages-viewer.txt scripts/apt-packages-pages.txt && scripts/build-viewer.sh -j1) >build/viewer.log 2>&1 &
viewer=$!

[ -x "$venv/bin/python" ] || /usr/bin/python3 -m venv "$venv"
pip_install() {
  "$venv/bin/pip" install -q --no-compile --disable-pip-version-check "$@"
}
pip_install 'scikit-build-core>=0.10' 'pybind11>=2.13' 'pybind11-stubgen>=2.5' 'numpy>=1.22' 'ruff>=0.4' 'clang-format==14.*' vermin cffconvert

echo "== style"
"$venv/bin/ruff" check .
"$venv/bin/ruff" format --check .
"$venv/bin/vermin" -q -t=3.9- --no-tips --exclude file bindings examples tests docs scripts # what Python 3.9 has; file: no built-in of ours
"$venv/bin/cffconvert" --validate >/dev/null
git ls-files '*.h' '*.cpp' | xargs "$venv/bin/clang-format" --dry-run -Werror

echo "== what the tests need, beside the build"
(
  pip_install 'pytest>=7' 'pytest-xdist>=3.7' 'selenium>=4.6' cma optuna nevergrad distributed 'sphinx>=7' 'myst-parser>=2' \
    'breathe>=4.35' furo nbclient ipykernel mypy usd-core
  [ -d "$node/node_modules/gltf-validator" ] && [ -d "$node/node_modules/three" ] ||
    npm install --silent --no-fund --no-audit --prefix "$node" gltf-validator@2.0.0-dev.3.10 three@0.180.0
) >build/needs.log 2>&1 &
needs=$!

echo "== build (warnings are errors)"
# One build folder for the package and for ctest. Without isolation its paths stay the same from run to run. Twice as many sources
# in a unit as a user's build has take 10 % less work. Below 1 GB g++ clears no memory up: 8 % less. Two units at a time need up to 5 GB.
make_wheel() {
  rm -rf build/wheel
  touch build/wheel-begun
  CC=cc CXX=c++ "$venv/bin/pip" wheel -q --disable-pip-version-check --no-build-isolation --no-deps -w build/wheel . \
    --config-settings=build-dir="$build" \
    --config-settings=cmake.define.DOUBLET_BUILD_TESTS=ON --config-settings=cmake.define.DOUBLET_BUILD_EXAMPLES=ON \
    --config-settings=cmake.define.DOUBLET_WERROR=ON --config-settings=cmake.define.CMAKE_UNITY_BUILD_BATCH_SIZE=16 \
    --config-settings=cmake.define.CMAKE_CXX_FLAGS="--param ggc-min-heapsize=1048576"
}
make_wheel
wait "$needs" || { cat build/needs.log && exit 1; }
wait "$viewer" || { cat build/viewer.log && exit 1; }
[ build/wheel-begun -nt build/viewer/viewer.css ] || make_wheel # again, with the whole bundle

"$venv/bin/pip" install -q --disable-pip-version-check build/wheel/doublet-*.whl
"$venv/bin/pip" install -q --disable-pip-version-check --force-reinstall --no-deps build/wheel/doublet-*.whl
[ "${1:-}" != --build-only ] || exit 0

echo "== ctest"
ctest --test-dir "$build" --output-on-failure --no-tests=error -LE slow -j "$(nproc)"

echo "== documentation (warnings are errors), beside pytest"
scripts/build-docs.sh "$venv/bin/python" >build/docs.log 2>&1 &
docs=$!

echo "== pytest"
PATH="$venv/bin:$PATH" DOUBLET_BUILD_DIR="$build" DOUBLET_NODE_DIR="$node" DOUBLET_WHEEL=$(echo "$PWD"/build/wheel/doublet-*.whl) "$venv/bin/python" -m pytest -m "not slow" -n 2 --dist loadfile --no-loadscope-reorder "$@"
wait "$docs" || { cat build/docs.log && exit 1; }
