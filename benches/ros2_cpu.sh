#!/bin/bash
# Processor time that `feeler ros2` takes at 100 Hz with two fingers, as a share of one core (user and system time of its process), with one
# subscriber to all topics: for a replayed recording, then for a running rig. Prints the figures of docs/benchmarks.md. Linux.
#
# usage: benches/ros2_cpu.sh [SECONDS] [PARTS]     (defaults: 20, and recording rig)
#   cargo build --release -p feeler-cli --features ros2
#   cargo build --release -p feeler-ros2 --features zenoh --example listen
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20} parts=${2:-recording rig}
feeler=$PWD/target/release/feeler listen=$PWD/target/release/examples/listen
out=target/ros2-cpu
rm -rf "$out"
mkdir -p "$out"
cd "$out"
trap 'kill $(jobs -p) 2>/dev/null || true' EXIT

# User and system ticks of a process since its start.
ticks() { awk '{ print $14 + $15 }' "/proc/$1/stat"; }

measure() {  # name, process
    local name=$1 node=$2 before after
    sleep 3
    before=$(ticks "$node")
    # A subscriber counts messages during the measurement.
    sleep "$seconds"
    after=$(ticks "$node")
    awk -v n="$name" -v t=$((after - before)) -v s="$seconds" -v hz="$(getconf CLK_TCK)" \
        'BEGIN { printf "%s: %.1f %% of a core\n", n, 100 * t / hz / s }'
}

"$feeler" run cap-closing --sensing direct --out run >/dev/null
for part in $parts; do
    case $part in
    recording)
        # The node ends with the recording after about 20 s. Playback at half speed would not be 100 Hz, so the measurement must fit.
        "$listen" tcp/127.0.0.1:7461 $((seconds < 14 ? seconds + 4 : 18)) >listen-recording.txt &
        listener=$!
        sleep 1
        "$feeler" ros2 run --ros-connect tcp/127.0.0.1:7461 >/dev/null &
        node=$!
        seconds=$((seconds < 12 ? seconds : 12)) measure "a recording" "$node"
        wait "$listener"
        cat listen-recording.txt
        kill "$node" 2>/dev/null || true
        ;;
    rig)
        of_rig="cap-closing --sensing direct --set time_limit=600 --set task.screw.strokes=100"
        "$feeler" hand $of_rig --listen tcp/127.0.0.1:7462 --out rig >hand.log 2>&1 &
        for finger in 0 1; do
            "$feeler" sense rig: --experiment cap-closing --sensing direct --set time_limit=600 --set task.screw.strokes=100 \
                --finger "$finger" --publish --connect tcp/127.0.0.1:7462 >"sense-$finger.log" 2>&1 &
        done
        "$feeler" world $of_rig --connect tcp/127.0.0.1:7462 >world.log 2>&1 &
        sleep 2
        "$listen" tcp/127.0.0.1:7463 $((seconds + 5)) >listen-rig.txt &
        listener=$!
        sleep 1
        "$feeler" ros2 $of_rig --connect tcp/127.0.0.1:7462 --ros-connect tcp/127.0.0.1:7463 >ros2.log 2>&1 &
        measure "a rig" $!
        wait "$listener"
        cat listen-rig.txt
        ;;
    esac
done
