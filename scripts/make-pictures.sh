#!/usr/bin/env bash
# make-pictures.sh [--quick] FOLDER [OUT]: every picture of docs/pictures, into FOLDER, by the commands that the pages name.
# OUT is a reconstruction of the shipped session; without it one is made first (half an hour). --quick searches less: fewer samples
# in landscape.png and robustness.png, a shorter capture for own-footage.jpg. Of data that is not shipped: body_model.png is of a
# population of registered bodies, which DOUBLET_POPULATION names, and is left out without; dance.jpg in the docs is of a longer
# session, and of the shipped one here.
# `python` and `doublet` are those of the environment, with matplotlib and selenium; needs Chromium, and the viewer's bundle.
# Exit status 1 if a command failed, or a picture is not there.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
quick=false
[ "${1:-}" != --quick ] || { quick=true && shift; }
folder=$(realpath "${1:?expected the folder for the pictures}") || exit 1
out=${2:-}
session=$PWD/examples/data/session
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$folder"
status=0

run() { # COMMAND...: what it says is shown if it fails, and the next goes on
  "$@" >"$work/log" 2>&1 && return
  [ $? -ne 3 ] || return 0 # doublet has doubts about its result
  echo "FAILED: $*" && tail -5 "$work/log"
  status=1
}

paint() { # NAME WORDS...: by benchmarks/pictures.py
  run python benchmarks/pictures.py "${@:2}" -o "$folder/$1"
}

without_scan() { # every second camera of the shipped session, without its scan and joints; then the surface in it
  cp -r "$session" "$work/own"
  rm "$work/own/scan.ply" "$work/own/joints.json"
  python - "$work/own/session.json" <<'EOF'
import json, sys
path = sys.argv[1]
described = {k: v for k, v in json.load(open(path)).items() if k not in ("scan", "markers")}
described["cameras"] = described["cameras"][::2]
json.dump(described, open(path, "w"))
EOF
  run doublet scan "$work/own"
  run ffmpeg -y -i "$work/own/scan_check.png" -q:v 2 "$folder/scan_check.jpg"
  run doublet capture "$work/own" -o "$work/own_out" "${fewer_frames[@]}"
  run doublet segment "$work/own_out"
}

fewer_evaluations=() fewer_frames=() own_frames=(0 20 40 60 80 100) grid=17 starts=4 evaluations=128
if $quick; then
  fewer_evaluations=(--fit-max-evaluations 16) fewer_frames=(--capture-frame-count 16 --no-capture-second-pass)
  own_frames=(0 3 6 9 12 15) grid=3 starts=2 evaluations=16
fi
if [ -z "$out" ]; then
  out=$work/out
  run doublet reconstruct "$session" -o "$out" --keep-going "${fewer_evaluations[@]}"
fi

run python benchmarks/convention_pictures.py "$folder" # conventions.png
run python benchmarks/cloth_pictures.py "$folder"      # cloth_dances.png, cloth_drapes.png, cloth_hangs.png
run benchmarks/peers/run.sh --growth "$folder/cloth_growth.png"
[ -z "${DOUBLET_POPULATION:-}" ] || run python benchmarks/body_curves.py "$DOUBLET_POPULATION" --picture "$folder/body_model.png"

paint overview.jpg overview "$out" "$session/motion.bvh"
paint pipeline.jpg pipeline "$out" "$session/motion.bvh"
paint dance.jpg dance "$out" --truth "$session/ground_truth" --frames 0 30 60 90 105 120
paint tracking.jpg captured "$out" --frames 20 55 88 115
paint template.png template "$out"
paint segmentation.jpg segmentation "$out"
paint garment.png garment "$out"
paint display-hem.jpg hem "$out" "$session/motion.bvh"

without_scan # scan_check.jpg
paint own-footage.jpg captured "$work/own_out" --cameras 0 1 2 3 --frames "${own_frames[@]}"

run python benchmarks/edit_pages.py template "$out" -o "$folder/edit-template.png"
run python benchmarks/edit_pages.py segmentation "$out" -o "$folder/edit-segmentation.png"
run doublet view "$out/character.glb" --clip "$session/motion.bvh" -o "$work/page"
run python benchmarks/view_page.py "$work/page" --seconds 0 -o "$folder/view.jpg"

run python benchmarks/level_of_detail.py "$out/character.glb" "$session/motion.bvh" -o "$folder/level-of-detail.jpg"
run python benchmarks/sect7 landscape "$out" --size "$grid" --work "$work/sect7"
run cp "$work/sect7/landscape_0.png" "$folder/landscape.png"
run python benchmarks/sect7 robustness "$out" --starts "$starts" --evaluations "$evaluations" --work "$work/sect7"
run cp "$work/sect7/robustness.png" "$folder/robustness.png"

for picture in docs/pictures/*; do
  name=$(basename "$picture")
  if [ -s "$folder/$name" ]; then
    echo "$name"
  elif [ "$name" = body_model.png ] && [ -z "${DOUBLET_POPULATION:-}" ]; then
    echo "$name: not drawn: DOUBLET_POPULATION names no population"
  else
    echo "$name: MISSING"
    status=1
  fi
done
exit $status
