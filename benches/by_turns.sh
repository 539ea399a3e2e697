#!/usr/bin/env bash
# Time from image to forces before and after a change: runs two builds of the example moments_speed interleaved on one core, so that
# other load affects both. Prints the smallest median of all turns for each line.
#
#   benches/by_turns.sh BEFORE AFTER [TURNS]
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,/^$/s/^# \?//p' "$0"; exit 2; }
before=$1 after=$2 turns=${3:-3}
for _ in $(seq "$turns"); do
    taskset -c 0 "$before" | sed 's/^/before /'
    taskset -c 0 "$after" | sed 's/^/after  /'
done | awk '{
    line = sprintf("%-9s %-8s %-10s", $2, $3, $4)
    if (!(line in seen)) { seen[line]; order[++count] = line }
    for (field = 5; field < NF; field++) if ($field == "moments" || $field == "forces") {
        key = line SUBSEP $field SUBSEP $1
        time = $(field + 1) + 0
        if (!(key in least) || time < least[key]) least[key] = time
    }
}
function pair(line, what) {
    return sprintf("%s %7s -> %7s us", what, least[line, what, "before"], least[line, what, "after"])
}
END { for (i = 1; i <= count; i++) print order[i], pair(order[i], "moments") ",", pair(order[i], "forces") }'
