#!/bin/bash
# What a report takes by the length of the run: wall time and peak of resident memory (VmHWM) of `feeler report`, and the size
# of the page. Prints the figures of docs/benchmarks.md. An hour of a run takes 2.1 GB of disk; every recording is removed
# before the next is made.
#
# usage: benches/report_length.sh [FEELER] [OTHER] [STROKES...]     (defaults: target/release/feeler, none (""), 13 128 768 1536)
#
# With OTHER, another build of the program (of a commit before, say), each recording is reported by turns by both.
set -euo pipefail
cd "$(dirname "$0")/.."
feeler=${1:-target/release/feeler} other=${2:-}
shift $(($# < 2 ? $# : 2))
strokes=("$@")
[ ${#strokes[@]} -gt 0 ] || strokes=(13 128 768 1536)
out=target/report-length
rm -rf "$out"
mkdir -p "$out"

report() {  # name, program, run's folder
    local begin end
    begin=$(date +%s.%N)
    "$2" report "$3" >/dev/null 2>"$out/errors" &
    local program=$! peak=0 now
    # The peak is the system's own; read until the program is gone.
    while now=$(awk '/VmHWM/ { print $2 }' "/proc/$program/status" 2>/dev/null) && [ -n "$now" ]; do
        peak=$now
        sleep 0.02
    done
    wait "$program" || true
    end=$(date +%s.%N)
    awk -v name="$1" -v peak="$peak" -v time="$(echo "$end - $begin" | bc)" -v page="$(stat -c %s "$3/report.html")" \
        -v recording="$(stat -c %s "$3/recording.mcap")" -v span="$(grep -o '"sim_time": [0-9.]*' "$3/summary.json" | cut -d' ' -f2)" \
        'BEGIN { printf "%-6s %6.0f s on record, %7.1f MB: %6.1f s, %6.0f MB of memory, page %5.2f MB\n", name, span, recording / 1e6, time, peak / 1024, page / 1e6 }'
}

for count in "${strokes[@]}"; do
    run=$out/run-$count
    "$feeler" run cap-closing --sensing direct --set task.screw.strokes="$count" --set time_limit=100000 --out "$run" >/dev/null 2>&1 || true
    for round in 1 2 3; do
        [ -z "$other" ] || report before "$other" "$run"
        report today "$feeler" "$run"
    done
    rm -r "$run"
done
