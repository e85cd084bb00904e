#!/usr/bin/env bash
# What takes longer than tests/run_tests.sh may: tests/run_nightly.sh [PART...], all parts without arguments. A part that fails is
# told at the end, and the next goes on; exit status 1 if any did. Logs are in build/nightly. Sets itself up on a bare Debian 12.
#
#   tests     tests/run_tests.sh; the parts that need the package use what it installed (and run its beginning if nothing is)
#   sanitize  every C++ test under AddressSanitizer and UndefinedBehaviorSanitizer
#   threads   every C++ test under ThreadSanitizer
#   fuzz      libFuzzer, DOUBLET_FUZZ_SECONDS (60) a harness
#   mutate    DOUBLET_MUTANTS (1000) damaged files of every format, read from Python
#   stages    `doublet reconstruct`, stopped at every stage in every way
#   slow      ctest -L slow: cloth in every corner of the material box; templates, first poses and searches beyond those of every run
#   rooms     what the flaws of a real room cost on the shipped session (benchmarks/rooms.py)
#   pictures  every picture of docs/, by its script
#   conda     the conda recipe, rendered
#   wheel     the wheel of scripts/build-wheel.sh, in a clean environment
#   pythons   a wheel for Python 3.9, and for the newest that is on the PATH, each in an environment of its own
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
logs=$PWD/build/nightly build=$PWD/build/tests venv=$PWD/build/tests-venv
all=()
parts="tests sanitize threads fuzz mutate stages slow rooms pictures conda wheel pythons"

installed() {
  [ -x "$venv/bin/doublet" ] || tests/run_tests.sh -k test_the_version_is_one
}

under() { # PRESET
  cmake --preset "$1" && cmake --build --preset "$1" && ctest --preset "$1" --no-tests=error -LE slow
}

run_part() {
  case $1 in
    tests) tests/run_tests.sh ;;
    sanitize) under sanitize ;;
    threads) TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp under sanitize-threads ;;
    fuzz) tests/fuzz/run.sh "${DOUBLET_FUZZ_SECONDS:-60}" ;;
    mutate) installed && "$venv/bin/python" tests/fuzz/mutate.py --count "${DOUBLET_MUTANTS:-1000}" ;;
    stages) installed && "$venv/bin/python" tests/slow/every_stage.py --whole ;;
    slow) installed && ctest --test-dir "$build" --output-on-failure --no-tests=error -L slow ;;
    rooms) installed && rm -rf "$logs/rooms" && PATH=$venv/bin:$PATH "$venv/bin/python" benchmarks/rooms.py examples/data/session -o "$logs/rooms" ;;
    pictures) installed && PATH=$venv/bin:$PATH scripts/make-pictures.sh --quick "$logs/pictures" ;;
    conda) installed && "$venv/bin/pip" install -q py-rattler-build && "$venv/bin/python" packaging/conda/check.py ;;
    wheel) installed && scripts/build-wheel.sh && PATH=$venv/bin:$PATH DOUBLET_PORTABLE_WHEEL=$(echo "$PWD"/build/portable-wheel/doublet-*.whl) \
      "$venv/bin/python" -m pytest tests/python/test_portable_wheel.py ;;
    pythons) tests/slow/other_pythons.sh ;;
    *) return 1 ;;
  esac
}

for part in "$@"; do
  [[ " $parts " == *" $part "* ]] || { echo "run_nightly.sh: expected some of $parts, found $part" >&2 && exit 2; }
done
[ $# -gt 0 ] || read -ra all <<<"$parts"

mkdir -p "$logs"
scripts/apt-install.sh scripts/apt-packages.txt scripts/apt-packages-tests.txt || exit 1
status=0 summary=()
for part in "$@" "${all[@]}"; do
  echo "== $part"
  start=$SECONDS result=passed
  run_part "$part" >"$logs/$part.log" 2>&1 || { result="FAILED, see build/nightly/$part.log" && status=1 && tail -20 "$logs/$part.log"; }
  summary+=("$part: $result, $(((SECONDS - start + 30) / 60)) min")
done
printf '%s\n' "== summary" "${summary[@]}"
exit $status
