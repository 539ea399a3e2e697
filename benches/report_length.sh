#!/bin/bash
# Cost of a report by length of the run: wall and processor time and peak resident memory of `feeler report`, and the
# page's size. Prints the figures of docs/benchmarks.md. Needs GNU time; one hour of a run requires 2.1 GB of disk;
# each recording is removed before the next.
#
# usage: benches/report_length.sh [FEELER] [OTHER] [STROKES...]     (defaults: target/release/feeler, none (""), 13 128 768 1536)
#
# With OTHER, another build of the program (e.g. of an earlier commit), both report each recording alternately.
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
    local span recording page
    /usr/bin/time -o "$out/time" -f '%e %U %S %M' "$2" report "$3" >/dev/null
    span=$(grep -o '"sim_time": [0-9.]*' "$3/summary.json" | cut -d' ' -f2)
    recording=$(stat -c %s "$3/recording.mcap") page=$(stat -c %s "$3/report.html")
    awk -v name="$1" -v span="$span" -v recording="$recording" -v page="$page" '{
        printf "%-6s %6.0f s on record, %7.1f MB: %6.1f s (processor %5.1f s), %7.1f MB of memory, page %5.2f MB\n",
            name, span, recording / 1e6, $1, $2 + $3, $4 * 1024 / 1e6, page / 1e6
    }' "$out/time"
}

for count in "${strokes[@]}"; do
    run=$out/run-$count
    "$feeler" run cap-closing --sensing direct --set task.screw.strokes="$count" --set time_limit=100000 --out "$run" >/dev/null
    for _ in 1 2 3; do
        [ -z "$other" ] || report before "$other" "$run"
        report today "$feeler" "$run"
    done
    rm -r "$run"
done
