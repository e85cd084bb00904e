#!/usr/bin/env bash
# build-viewer.sh: the page of `doublet view` without its data, build/viewer/. The player becomes WebAssembly with SIMD, three.js
# comes from npm as viewer/package-lock.json has it. Needs apt-packages.txt, apt-packages-viewer.txt, and npm. A doublet that is
# installed after it has the bundle in it.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v em++ >/dev/null || { echo "build-viewer.sh: expected Emscripten: scripts/apt-install.sh scripts/apt-packages-viewer.txt" >&2 && exit 1; }

export NODE_PATH=/usr/share/nodejs # where Debian's Emscripten has its parser, which a node from elsewhere does not look for
launcher=$(command -v ccache || true)
emcmake cmake -S viewer -B build/viewer-wasm -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" \
  -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=8
cmake --build build/viewer-wasm "$@"
[ -d viewer/node_modules/three ] || npm ci --silent --no-fund --no-audit --prefix viewer
node viewer/build.mjs build/viewer-wasm build/viewer
echo "build/viewer"
