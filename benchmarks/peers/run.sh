#!/usr/bin/env bash
# The cloth solver beside other engines: builds what is needed, runs them all in turn, prints medians and ratios.
#   benchmarks/peers/run.sh [--rounds 3]          the comparison
#   benchmarks/peers/run.sh --growth FILE.png     cost against the number of vertices, as a plot
# From Debian: cmake g++ ninja-build libeigen3-dev libbenchmark-dev libbullet-dev blender python3-numpy python3-venv.
# An engine that is not there is left out, and said to be. Everything lands in build/peers.
set -euo pipefail
cd "$(dirname "$0")/../.."

build=$PWD/build/peers
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DDOUBLET_COMPONENTS=pbd -DDOUBLET_BUILD_BENCHMARKS=ON >"$build.log" 2>&1 ||
  { cat "$build.log"; exit 1; }
ninja -C "$build" --quiet cloth_peers
[ -x "$build/venv/bin/python" ] || /usr/bin/python3 -m venv "$build/venv"
wanted=(-r benchmarks/peers/requirements.txt)
[ "${1:-}" != --growth ] || wanted=(numpy matplotlib) # of our own solver alone
"$build/venv/bin/pip" install -q --disable-pip-version-check --only-binary :all: "${wanted[@]}"

export OMP_NUM_THREADS=1 # one core for everybody
"$build/venv/bin/python" benchmarks/peers/peers.py "$build/benchmarks/cloth_peers" "$@"
