#!/usr/bin/env bash
# The package under other Pythons than Debian 12's: tests/slow/other_pythons.sh [PYTHON...]
# PYTHON: interpreters with their headers. By default 3.9, the oldest that pyproject.toml takes, from Debian 11's packages, with
# the oldest dependencies that it takes, and the newest that is on the PATH. Each gets a wheel, an environment that has it, and
# the tests that need nothing else. Exit status 1 if a test fails, or an interpreter is not to be had.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
work=$PWD/build/pythons
tests=(arguments bindings config evaluate lifetimes motions options player promises stages template_mask)
oldest=$(grep -oP 'requires-python = ">=\K[\d.]+' pyproject.toml)
mkdir -p "$work"

debian_11() { # FOLDER: Python 3.9 and the libraries that Debian 12 has in newer versions, unpacked there
  local sources=$1/sources.list key=/usr/share/keyrings/debian-archive-keyring.gpg
  local packages=({lib,}python3.9-minimal python3.9 libpython3.9{,-stdlib,-dev} python3-distutils libssl1.1 libffi7 libmpdec3)
  mkdir -p "$1/lists/partial" "$1/cache/archives/partial" "$1/debs"
  echo "deb [signed-by=$key] http://deb.debian.org/debian bullseye main" >"$sources"
  touch "$1/status"
  local apt=(apt-get -q -o Dir::Etc::sourcelist="$sources" -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$1/lists")
  apt+=(-o Dir::State::status="$1/status" -o Dir::Cache="$1/cache" -o APT::Sandbox::User=root)
  "${apt[@]}" update && cd "$1/debs" || return 1
  "${apt[@]}" download "${packages[@]}" || return 1
  for package in *.deb; do dpkg -x "$package" "$1" || return 1; done
}

oldest_dependencies() { # a line each
  python3 - <<'EOF'
import re, tomllib
project = tomllib.load(open("pyproject.toml", "rb"))["project"]
print("\n".join(re.sub(r">=([\d.]+).*", r"==\1.*", line) for line in project["dependencies"]))
EOF
}

try() { # PYTHON [REQUIREMENT...]: the same folder each time, so that ccache knows the libraries
  local venv=$work/venv
  rm -rf "$work/build" "$work/wheel" "$venv"
  "$work/tools/bin/virtualenv" -q -p "$1" "$venv" &&
    "$venv/bin/pip" wheel -q --no-deps -w "$work/wheel" . --config-settings=build-dir="$work/build" &&
    "$venv/bin/pip" install -q "$work"/wheel/*.whl pytest "${@:2}" &&
    "$venv/bin/python" -c 'import sys, numpy; print("== Python", sys.version.split()[0], "NumPy", numpy.__version__)' &&
    "$venv/bin/python" -m pytest -q -p no:cacheprovider "${files[@]}"
}

files=()
for name in "${tests[@]}"; do files+=("tests/python/test_$name.py"); done
python3 -m venv "$work/tools" && "$work/tools/bin/pip" install -q virtualenv || exit 1
status=0
if [ $# -gt 0 ]; then
  for python in "$@"; do try "$python" || status=1; done
  exit $status
fi

[ -x "$work/debian_11/usr/bin/python$oldest" ] || (debian_11 "$work/debian_11")
mapfile -t dependencies < <(oldest_dependencies)
(
  export LD_LIBRARY_PATH=$work/debian_11/usr/lib/x86_64-linux-gnu CPATH=$work/debian_11/usr/include
  try "$work/debian_11/usr/bin/python$oldest" "${dependencies[@]}"
) || status=1
newest=python3.11 # tests/run_tests.sh tries that one
for python in $(compgen -c python3. | grep -E '^python3\.[0-9]+$' | sort -uV); do
  "$python" -c "" 2>/dev/null && newest=$python
done
[ "$newest" = python3.11 ] || try "$newest" || status=1
exit $status
