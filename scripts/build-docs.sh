#!/usr/bin/env bash
# build-docs.sh [PYTHON]: docs/ as a site, build/docs/html/index.html, with the reference of C++ and Python. Warnings are errors.
# Needs doxygen, and in the environment of PYTHON doublet itself and what pyproject.toml names under `docs`.
set -euo pipefail
cd "$(dirname "$0")/.."
rm -rf build/docs docs/api
"${1:-python3}" -m sphinx --fail-on-warning --keep-going --quiet --builder html docs build/docs/html
echo "build/docs/html/index.html"
