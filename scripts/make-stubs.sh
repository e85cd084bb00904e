#!/usr/bin/env bash
# Writes bindings/python/doublet/_doublet.pyi from the installed package; run it after a change of the bindings.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
pybind11-stubgen doublet._doublet -o "$folder" --ignore-all-errors --numpy-array-wrap-with-annotated
python scripts/tidy-stubs.py "$folder/doublet/_doublet.pyi"
cp "$folder/doublet/_doublet.pyi" bindings/python/doublet/_doublet.pyi
rm -r "$folder"
