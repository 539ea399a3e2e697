#!/usr/bin/env bash
# Compares trials of a sweep between this commit and another: trials per second (interleaved), and significant changes of the means of
# measures. Detects changes of physics or control that no test covers.
#
# usage: benches/trials_pair.sh BASE TRIALS [SWEEP ARGUMENTS]
#        benches/trials_pair.sh HEAD~1 3000 cap-closing --sensing direct --vary 'friction=uniform(0.4,1.2)'      (the default)
#        benches/trials_pair.sh HEAD~1 200 contour --sensing direct
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 2 ] || { sed -n '2,/^set/s/^# \?//p' "$0"; exit 2; }
base=$1 trials=$2
shift 2
[ $# -gt 0 ] || set -- cap-closing --sensing direct --vary 'friction=uniform(0.4,1.2)'
out=target/pair
tree=$out/tree

[ -e "$tree" ] || git worktree add --quiet --detach "$tree" "$base"
git -C "$tree" checkout --quiet --force "$(git rev-parse "$base")"
cargo build --release --quiet -p feeler-cli
# A separate target folder, as Cargo confuses equal crates of two working copies.
(cd "$tree" && CARGO_TARGET_DIR=../target cargo build --release --quiet -p feeler-cli)
cp target/release/feeler "$out/own-feeler"
cp "$out/target/release/feeler" "$out/base-feeler"

rm -rf "$out/trials"
mkdir -p "$out/trials"
for side in base own; do
    start=$(date +%s.%N)
    "$out/$side-feeler" sweep "$@" --trials "$trials" -o "$out/trials/$side" >/dev/null
    echo "$side: $(echo "$trials $start $(date +%s.%N)" | awk '{ printf "%.1f trials a second", $1 / ($3 - $2) }')"
done
python3 benches/trials_pair.py "$out/trials/base/trials.csv" "$out/trials/own/trials.csv"
