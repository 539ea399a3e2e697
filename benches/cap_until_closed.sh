#!/bin/bash
# Evaluates a hand's findings about 2,000 caps: intact round and knurled ones, and faulty ones. Prints the figures of
# docs/benchmarks.md.
#
# usage: benches/cap_until_closed.sh [SEED] [GOOD] [FAULTY] [SENSING]     (defaults: 7101 800 134 direct)
set -euo pipefail
cd "$(dirname "$0")/.."
seed=${1:-7101} good=${2:-800} faulty=${3:-134} sensing=${4:-direct}
out=target/cap-until-closed-$sensing-$seed
feeler=target/release/feeler
thread=sim.object.cap.motion.thread
rm -rf "$out"
mkdir -p "$out"

seat=0  # rad, minimum angle of a seat
sweep() {  # name, trials, further arguments
    local name=$1 trials=$2
    shift 2
    seed=$((seed + 1))
    "$feeler" sweep cap-until-closed --sensing "$sensing" --trials "$trials" --seed "$seed" -o "$out/$name" \
        --vary 'cap.radius=uniform(0.010,0.020)' --vary 'friction=uniform(0.4,1.2)' \
        --vary "thread.seat_angle=uniform($seat,12.566)" --vary 'thread.seat_stiffness=log_uniform(0.27,2.7)' \
        --vary 'direct_sensing.normal_noise=uniform(0,0.006)' --vary 'direct_sensing.shear_noise=uniform(0,0.006)' \
        --vary 'optics.read_noise=uniform(0,4.5)' --vary 'cap.position.0=uniform(-0.002,0.002)' --vary 'cap.position.1=uniform(-0.002,0.002)' "$@" >/dev/null
    awk -F, -v name="$name" '
        NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
        {
            trials++
            ratio = $column["torque_ratio"]; over = $column["time_over_damage"]
            found[$column["found"] == "" ? $column["outcome"] : $column["found"]]++
            if (ratio != "" && ratio < 0.7) loose++
            if ($column["found"] == "closed" && ratio < 0.7) false_closed++
            if (ratio != "" && (least == "" || ratio + 0 < least)) least = ratio + 0
            if (over > 0.05) harmed++
            if (over + 0 > longest) longest = over + 0
        }
        END {
            printf "%-12s %4d trials; ", name, trials
            for (word in found) printf "%s %d, ", word, found[word]
            printf "torque below 70 %%: %d (least %.0f %%), closed though it is not tight: %d, harmed: %d (longest %.0f ms)\n",
                loose, 100 * least, false_closed, harmed, 1000 * longest
        }' "$out/$name/trials.csv"
}

sweep round "$good" --set 'sim.object.cap.shape={cylinder={radius=0.014,height=0.02}}'
sweep knurled "$good" --set 'sim.object.cap.shape={knurled_cylinder={radius=0.014,height=0.02,knurls=60,depth=0.0003}}' \
    --vary 'depth=uniform(0.00005,0.0004)'
seat=6.2832  # well after the jam
sweep crossed "$faulty" --set "$thread.fault.cross_threaded={angle=0.5,stiffness=0.03}" \
    --vary 'cross_threaded.angle=uniform(0.0,1.5)' --vary 'cross_threaded.stiffness=log_uniform(0.02,0.06)'
seat=0
sweep stripped "$faulty" --set "$thread.fault=\"stripped\""
sweep absent "$faulty" --set 'sim.object.cap.position=[0.0,0.0,0.4]'
