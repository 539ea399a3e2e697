#!/usr/bin/env bash
# Runs every fuzz target for a while: fuzz/short-run.sh [SECONDS, default 60].
# New inputs go to a scratch corpus, which keeps the committed one small.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
# Stable Rust has no address sanitizer; feeler's only unsafe code is in its SIMD sums.
for target in layout taxels calibration wrench policy loads forces netft picture experiment recording link inboxes stop_wire skins drives_bus ros2; do
    scratch=fuzz/target/found/$target
    mkdir -p "$scratch"
    cargo fuzz run --sanitizer none "$target" "$scratch" "fuzz/corpus/$target" -- \
        -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096
done
