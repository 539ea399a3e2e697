#!/usr/bin/env bash
# Makes python/feeler/_core.pyi from what PyO3 knows of the classes and functions in src/; with --check, compares instead.
set -euo pipefail
cd "$(dirname "$0")"

made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
# Stripped of its symbols, a library could not be asked.
if ! maturin build --release --features stubs --generate-stubs --strip=false -o "$made" >"$made/log" 2>&1; then
    cat "$made/log" >&2
    exit 1
fi
python3 -m zipfile -e "$made"/*.whl "$made/wheel"
stubs=$made/wheel/feeler/_core.pyi
if [ "${1:-}" = --check ]; then
    diff "$stubs" python/feeler/_core.pyi && exit
    echo "python/feeler/_core.pyi is not what src/ makes: run python/stubs.sh" >&2
    exit 1
fi
cp "$stubs" python/feeler/_core.pyi
