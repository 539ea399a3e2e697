#!/usr/bin/env bash
# Compares many hands at once between this commit and another: control steps per second (interleaved), instructions per control step
# if valgrind is installed, and equality of the rewards of all episodes.
#
# usage: benches/hands_pair.sh BASE [HANDS] [THREADS] [STEPS] [ROUNDS]     (defaults: - 64 1 1860 3)
set -euo pipefail
cd "$(dirname "$0")/.."
base=$1 hands=${2:-64} threads=${3:-1} steps=${4:-1860} rounds=${5:-3}
out=target/pair
tree=$out/tree
example=crates/feeler-lab/examples/hands_speed.rs

[ -e "$tree" ] || git worktree add --quiet --detach "$tree" "$base"
git -C "$tree" checkout --quiet --force "$(git rev-parse "$base")"
# Both sides use the same measuring program.
cp "$example" "$tree/$example"
cargo build --release --quiet -p feeler-lab --example hands_speed
cp target/release/examples/hands_speed "$out/own"
# A separate target folder, as Cargo confuses equal crates of two working copies.
(cd "$tree" && CARGO_TARGET_DIR=../target cargo build --release --quiet -p feeler-lab --example hands_speed)
cp "$out/target/release/examples/hands_speed" "$out/base"

for _ in $(seq "$rounds"); do
    for side in base own; do
        echo "$side: $("$out/$side" "$hands" "$threads" "$steps")"
    done
done
command -v valgrind >/dev/null || exit 0
count() {  # side, steps
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$out/$1" 1 1 "$2" 2>&1 | awk '/Collected/ { print $4 }'
}
for side in base own; do
    few=$(count "$side" 1) all=$(count "$side" "$steps")
    echo "$side: $(((all - few) / (steps - 1))) instructions a control step"
done
