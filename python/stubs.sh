#!/usr/bin/env bash
# Makes python/feeler/_core.pyi from what PyO3 knows of the classes and functions in src/. CI compares.
set -euo pipefail
cd "$(dirname "$0")"
made=$(mktemp)
trap 'rm -f "$made"' EXIT

cargo build --package feeler-python --features stubs --lib --example stubs
target=${CARGO_TARGET_DIR:-../target}/debug
"$target/examples/stubs" "$target/lib_core.so" >"$made"
cp "$made" python/feeler/_core.pyi
