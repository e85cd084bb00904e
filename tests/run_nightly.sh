#!/usr/bin/env bash
# What takes longer than tests/run_tests.sh may: tests/run_nightly.sh [PART...]. Without arguments it is every part that has not
# passed for what is checked out now, so that a second call goes on where the first was stopped; parts that are named run anyway.
# A part that fails is told at the end, and the next goes on; exit status 1 if any part of the summary has failed. Logs are in
# build/nightly, and results.txt there has a line for each part that ended. Sets itself up on a bare Debian 12.
#
#   tests       tests/run_tests.sh; the parts that need the package build and install it first if this has not
#   headers     every header and source, the benchmarks with them, compiles by itself: C++ users may build without CMAKE_UNITY_BUILD
#   conda       the conda recipe, rendered
#   wheel       the wheel of scripts/build-wheel.sh, in a clean environment
#   pythons     a wheel for Python 3.9, and for the newest that is on the PATH, each in an environment of its own
#   quickstart  the quickstart of the README, in a clean clone
#   pictures    every picture of docs/, by its script
#   stages      `doublet reconstruct`, stopped at every stage in every way
#   fuzz        libFuzzer, DOUBLET_FUZZ_SECONDS (60) a harness
#   mutate      DOUBLET_MUTANTS (1000) damaged files of every format, read from Python
#   slow        ctest -L slow: cloth in every corner of the material box; templates, first poses and searches beyond those of every run;
#               the benchmarks, linked; pytest -m slow: whole builds by users, the longest examples
#   sanitize    every C++ test under AddressSanitizer and UndefinedBehaviorSanitizer
#   threads     every C++ test under ThreadSanitizer
#   rooms       what the flaws of a real room cost on the shipped session (benchmarks/rooms.py)
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
logs=$PWD/build/nightly build=$PWD/build/tests venv=$PWD/build/tests-venv
results=$logs/results.txt
parts="tests headers conda wheel pythons quickstart pictures stages fuzz mutate slow sanitize threads rooms"
is_installed=

installed() { # the package, of what is checked out now
  [ "$is_installed" ] || tests/run_tests.sh --build-only && is_installed=yes
}

under() { # PRESET
  cmake --preset "$1" && cmake --build --preset "$1" && ctest --preset "$1" --no-tests=error -LE slow -j "$(nproc)"
}

linked_benchmarks() { # beside the tests, whose build is then as it was
  local status=0
  cmake -S . -B "$build" -DDOUBLET_BUILD_BENCHMARKS=ON && cmake --build "$build" --target benchmarks || status=1
  cmake -S . -B "$build" -DDOUBLET_BUILD_BENCHMARKS=OFF && return $status
}

slow_python() {
  PATH=$venv/bin:$PATH DOUBLET_BUILD_DIR=$build "$venv/bin/python" -m pytest -m slow -n 2 --dist loadfile
}

each_alone() {
  installed && cmake --preset alone -Dpybind11_DIR="$("$venv/bin/python" -m pybind11 --cmakedir)" \
    -DPython_EXECUTABLE="$venv/bin/python" && "$venv/bin/python" tests/slow/compiles_alone.py build/alone/compile_commands.json
}

first_command() {
  local clone=$logs/quickstart
  rm -rf "$clone" && git clone -q . "$clone" && bash "$clone/examples/quickstart.sh" &&
    ls "$clone"/out/quickstart/{report.html,character.glb,new_motion.mp4}
}

draw_pictures() { # of the quickstart's results, where these are of now
  local made=()
  [[ $(result_of quickstart) != passed* ]] || made=("$logs/quickstart/out/quickstart")
  installed && PATH=$venv/bin:$PATH scripts/make-pictures.sh --quick "$logs/pictures" "${made[@]}"
}

run_part() {
  case $1 in
    tests) tests/run_tests.sh && is_installed=yes ;;
    headers) each_alone ;;
    conda) installed && "$venv/bin/pip" install -q py-rattler-build && "$venv/bin/python" packaging/conda/check.py ;;
    wheel) installed && scripts/build-wheel.sh && PATH=$venv/bin:$PATH DOUBLET_PORTABLE_WHEEL=$(echo "$PWD"/build/portable-wheel/doublet-*.whl) \
      "$venv/bin/python" -m pytest tests/python/test_portable_wheel.py ;;
    pythons) tests/slow/other_pythons.sh ;;
    quickstart) first_command ;;
    pictures) draw_pictures ;;
    stages) installed && "$venv/bin/python" tests/slow/every_stage.py --whole ;;
    fuzz) tests/fuzz/run.sh "${DOUBLET_FUZZ_SECONDS:-60}" ;;
    mutate) installed && "$venv/bin/python" tests/fuzz/mutate.py --count "${DOUBLET_MUTANTS:-1000}" ;;
    slow) installed && linked_benchmarks && ctest --test-dir "$build" --output-on-failure --no-tests=error -L slow -j "$(nproc)" && slow_python ;;
    sanitize) under sanitize ;;
    threads) TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp under sanitize-threads ;;
    rooms) installed && rm -rf "$logs/rooms" && PATH=$venv/bin:$PATH "$venv/bin/python" benchmarks/rooms.py examples/data/session -o "$logs/rooms" ;;
    *) return 1 ;;
  esac
}

of_now() { # a word for what is checked out: the commit, and a sum of what differs from it
  local changes
  changes=$(git diff --binary HEAD && git ls-files --others --exclude-standard) || return 1
  echo "$(git rev-parse HEAD)${changes:++$(sha256sum <<<"$changes" | head -c 12)}"
}

result_of() { # PART: how it last ended for what is checked out
  awk -v now="$now" -v part="$1" '$1 == now && $2 == part { $1 = $2 = ""; found = substr($0, 3) } END { print found }' "$results"
}

for part in "$@"; do
  [[ " $parts " == *" $part "* ]] || { echo "run_nightly.sh: expected some of $parts, found $part" >&2 && exit 2; }
done

mkdir -p "$logs" && touch "$results"
scripts/apt-install.sh scripts/apt-packages{,-tests,-pages,-clang}.txt || exit 1
now=$(of_now) || exit 1
for part in ${@:-$parts}; do
  [[ $# -eq 0 && $(result_of "$part") == passed* ]] && continue
  echo "== $part"
  start=$SECONDS result=passed
  run_part "$part" >"$logs/$part.log" 2>&1 || { result="FAILED, see build/nightly/$part.log" && tail -20 "$logs/$part.log"; }
  echo "$now $part $result, $(((SECONDS - start + 30) / 60)) min" >>"$results"
done

status=0
echo "== summary of $now"
for part in $parts; do
  result=$(result_of "$part")
  echo "$part: ${result:-not run}"
  [[ $result != FAILED* ]] || status=1
done
exit $status
