#!/bin/bash
# Processor time that `feeler hand` takes at 1 kHz with two fingers and its recording, as a share of one core:
# user and system time of the process, and the share and context switches per second of each thread (woken: after waiting;
# preempted: by another thread).
# Prints the figures of docs/benchmarks.md. Linux.
#
# usage: benches/hand_cpu.sh [SECONDS] [FEELER[@ENDPOINT]...]     (defaults: 12, and target/release/feeler@tcp/127.0.0.1:7472)
#   cargo build --release -p feeler-cli --features link
# Measures each program at its endpoint in turn; repeat two of them to get pairs. PARTS selects from
#   sensors  one program publishes joints and two fingers, as `feeler bench link` does: four messages each millisecond
#   rig      a simulated rig in real time and two sensor programs, whose forces pass the hand: eight messages
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-12}
shift || true
[ $# -gt 0 ] || set -- "$PWD/target/release/feeler"
out=target/hand-cpu
rm -rf "$out"
mkdir -p "$out"
trap 'kill $(jobs -p) 2>/dev/null || true' EXIT

# Prints id, user and system ticks, voluntary and involuntary switches, and name of each thread of a process.
threads() {
    local task
    for task in /proc/"$1"/task/*; do
        echo "${task##*/} $(sed 's/.*) //' "$task/stat" | cut -d' ' -f12,13)" \
            "$(awk '/ctxt_switches/ { printf "%s ", $2 }' "$task/status") $(tr ' ' - <"$task/comm")"
    done
}

measure() {  # name, process
    local before after
    before=$(threads "$2")
    sleep "$seconds"
    after=$(threads "$2")
    awk -v name="$1" -v s="$seconds" -v hz="$(getconf CLK_TCK)" '
        NR == FNR { user[$1] = $2; kernel[$1] = $3; waits[$1] = $4; others[$1] = $5; next }
        {
            u = 100 * ($2 - user[$1]) / hz / s; k = 100 * ($3 - kernel[$1]) / hz / s
            v = ($4 - waits[$1]) / s; i = ($5 - others[$1]) / s
            us += u; ks += k; vs += v; is += i
            if (v >= 1 || u + k >= 0.1)
                rows = rows sprintf("  %-15s %5.1f %%  user %4.1f  system %4.1f  woken %5.0f /s  preempted %5.0f /s\n", $6, u + k, u, k, v, i)
        }
        END { printf "%s: %.1f %% of a core, user %.1f, system %.1f, woken %.0f /s, preempted %.0f /s\n%s", name, us + ks, us, ks, vs, is, rows }
    ' <(echo "$before") <(echo "$after")
}

run() {  # part, program, endpoint, folder
    local part=$1 feeler=$2 listen=$3 folder=$4 of_rig others=() hand finger
    of_rig="cap-closing --sensing direct"
    case $part in
    # The sensors of the bench announce complete sets, which the hand answers immediately.
    sensors) of_rig+=" --set control.monitor.joint_deviation=0 --set time_limit=1e5 --rig bench --speed max" ;;
    # A busy computer is occasionally late; a stopped hand would do less work.
    rig) of_rig+=" --set control.period=0.001 --set control.stale_periods=1000 --set time_limit=600 --set task.screw.strokes=100" ;;
    esac
    # shellcheck disable=SC2086
    "$feeler" hand $of_rig --listen "$listen" --out "$folder/run" >"$folder/hand.log" 2>&1 &
    hand=$!
    if [ "$part" = sensors ]; then
        "$feeler" bench link --rate 1000 --sensors-of "$listen" >"$folder/sensors.log" 2>&1 &
        others+=($!)
    else
        for finger in 0 1; do
            # shellcheck disable=SC2086
            "$feeler" sense rig: --experiment $of_rig --finger "$finger" --publish --connect "$listen" >"$folder/sense-$finger.log" 2>&1 &
            others+=($!)
        done
        # shellcheck disable=SC2086
        "$feeler" world $of_rig --connect "$listen" >"$folder/world.log" 2>&1 &
        others+=($!)
    fi
    sleep 4
    if ! kill -0 "$hand" 2>/dev/null; then
        cat "$folder/hand.log" >&2
        return 1
    fi
    measure "$part, $feeler@$listen" "$hand"
    kill -INT "$hand" "${others[@]}" 2>/dev/null || true
    wait "$hand" "${others[@]}" || true
    grep -h -E "control steps|periods missed|stopped|lost" "$folder/hand.log" | sed 's/^/  /' || true
}

turn=0
for what in "$@"; do
    case $what in
    *@*) listen=${what#*@} ;;
    *) listen=tcp/127.0.0.1:7472 ;;
    esac
    for part in ${PARTS:-sensors rig}; do
        turn=$((turn + 1))
        mkdir "$out/$turn"
        run "$part" "${what%%@*}" "$listen" "$out/$turn"
    done
done
