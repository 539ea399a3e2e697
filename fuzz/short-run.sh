#!/usr/bin/env bash
# Runs every fuzz target for a while: fuzz/short-run.sh [SECONDS, 60 unless told].
# What is found on the way goes to a scratch corpus, so that the committed one stays small.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
# Stable Rust has no address sanitizer; feeler has no unsafe code but that of its processor-specific sums.
for target in layout taxels calibration wrench policy loads forces netft picture experiment recording link inboxes stop_wire drives_bus ros2; do
    scratch=fuzz/target/found/$target
    mkdir -p "$scratch"
    cargo fuzz run --sanitizer none "$target" "$scratch" "fuzz/corpus/$target" -- \
        -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096
done
