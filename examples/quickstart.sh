#!/usr/bin/env bash
# From a bare Debian 12 to an animated character: installs what is needed, builds doublet into .venv, reconstructs the shipped session,
# animates the character with a motion capture clip and measures the result.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/apt-install.sh scripts/apt-packages.txt
[ -x .venv/bin/python ] || /usr/bin/python3 -m venv .venv
if command -v em++ >/dev/null && command -v npm >/dev/null; then # the page of `doublet view`, which the installation takes along
  mkdir -p build && scripts/build-viewer.sh >build/viewer.log 2>&1 || { cat build/viewer.log >&2 && exit 1; }
else
  echo "Without the page of 'doublet view': scripts/apt-install.sh scripts/apt-packages-viewer.txt, and npm, before this adds it"
fi
echo "Building doublet (some minutes) ..."
.venv/bin/pip install -q --disable-pip-version-check .

session=examples/data/session
out=out/quickstart
.venv/bin/doublet reconstruct "$session" -o "$out"
.venv/bin/doublet animate "$out/character.glb" "$session/motion.bvh" -o "$out/new_motion.mp4"
.venv/bin/doublet evaluate "$out" --truth "$session/ground_truth"

echo
echo "Report:    $PWD/$out/report.html"
echo "Character: $PWD/$out/character.glb"
echo "Video:     $PWD/$out/new_motion.mp4"
echo "Your own session: source .venv/bin/activate; doublet reconstruct SESSION -o OUT"
