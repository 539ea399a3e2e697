#!/usr/bin/env bash
# Generates python/feeler/_core.pyi from the classes and functions in src/. CI checks that it is up to date.
set -euo pipefail
cd "$(dirname "$0")"
made=$(mktemp)
trap 'rm -f "$made"' EXIT

cargo build --package feeler-python --features stubs --lib --example stubs
target=${CARGO_TARGET_DIR:-../target}/debug
"$target/examples/stubs" "$target/lib_core.so" >"$made"
cp "$made" python/feeler/_core.pyi
