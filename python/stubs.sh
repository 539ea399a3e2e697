#!/usr/bin/env bash
# Makes python/feeler/_core.pyi from what PyO3 knows of the classes and functions in src/; with --check, compares instead.
set -euo pipefail
cd "$(dirname "$0")"

made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
if ! maturin generate-stubs --profile "${PROFILE:-dev}" --features stubs -o "$made" >"$made/log" 2>&1; then
    cat "$made/log" >&2
    exit 1
fi
stubs=$(find "$made" -name '*.pyi')
if [ "${1:-}" = --check ]; then
    diff "$stubs" python/feeler/_core.pyi && exit
    echo "python/feeler/_core.pyi is not what src/ makes: run python/stubs.sh" >&2
    exit 1
fi
cp "$stubs" python/feeler/_core.pyi
