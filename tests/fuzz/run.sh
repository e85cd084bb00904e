#!/usr/bin/env bash
# Builds libFuzzer's harnesses and runs each: tests/fuzz/run.sh SECONDS [HARNESS...]. What it finds is left in build/fuzz/found/HARNESS:
# crash-*, oom-*, timeout-*; such an input, once mended, goes into corpus/HARNESS/. Exit status 1 if anything was found.
# A process may hold 512 MiB, and ask for 256 MiB at once; an input may take 10 s.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:?expected the seconds that each harness runs}
shift

scripts/apt-install.sh scripts/apt-packages.txt scripts/apt-packages-clang.txt
if [ $# -eq 0 ]; then
  for corpus in tests/fuzz/corpus/*/; do set -- "$@" "$(basename "$corpus")"; done
fi
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target "${@/#/fuzz_}"

memory=$(mktemp -d -p /dev/shm doublet-fuzz-XXXXXX)
trap 'rm -rf "$memory"' EXIT
export TMPDIR=$memory
# Freed memory is kept from use, 16 MiB of it: more would count as the readers'.
export ASAN_OPTIONS=quarantine_size_mb=16:detect_odr_violation=0 UBSAN_OPTIONS=print_stacktrace=1
status=0
for harness in "$@"; do
  found=$PWD/build/fuzz/found/$harness corpus=$PWD/build/fuzz/corpus/$harness log=$PWD/build/fuzz/$harness.log
  mkdir -p "$found" "$corpus"
  result=clean dictionary=()
  [ ! -f "tests/fuzz/dict/$harness.dict" ] || dictionary=(-dict="tests/fuzz/dict/$harness.dict")
  build/fuzz/tests/fuzz/fuzz_"$harness" "$corpus" "tests/fuzz/corpus/$harness" -max_total_time="$seconds" -timeout=10 \
    -rss_limit_mb=512 -malloc_limit_mb=256 -artifact_prefix="$found/" -print_final_stats=1 -verbosity=1 \
    "${dictionary[@]}" >"$log" 2>&1 || result="FOUND, see $log"
  [ "$result" = clean ] || status=1
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  echo "$harness: ${executions:-?} executions, $result"
done
exit $status
