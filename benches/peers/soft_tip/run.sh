#!/usr/bin/env bash
# Presses, shears and twists a soft tip in feeler and in other simulators, each on one core, and compares all with closed
# forms. Prints the table of docs/simulators.md and writes its figure, docs/figures/soft-tip.svg.
#
# usage: benches/peers/soft_tip/run.sh [PEER...]   default: feeler mujoco drake pybullet newton; records of other peers
#                                                  are reused. All of them take about an hour.
set -euo pipefail
cd "$(dirname "$0")/../../.."

scripts=$PWD/benches/peers/soft_tip
environments=$PWD/target/peers
out=$PWD/target/peers/soft_tip
mkdir -p "$out"
export OMP_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
# MuJoCo writes a log in the current folder.
python() { (cd "$out" && "$environments/$1/bin/python" "${@:2}"); }
install() {
    [ -e "$environments/$1/bin/python" ] || python3 -m venv "$environments/$1"
    "$environments/$1/bin/pip" install --quiet "${@:2}"
}

[ $# -gt 0 ] || set -- feeler mujoco drake pybullet newton
for peer in "$@"; do
    case $peer in
    feeler)
        cargo build --release --quiet -p feeler-lab --example soft_tip
        for layout in dense reference; do
            python3 "$scripts/scene.py" | target/release/examples/soft_tip "$layout" >"$out/1-feeler-$layout.json"
        done
        ;;
    mujoco)
        install mujoco mujoco==4.0.0 numpy==2.4.6
        python mujoco "$scripts/mujoco_tip.py" "$out/2-mujoco-sphere.json" sphere
        python mujoco "$scripts/mujoco_tip.py" "$out/3-mujoco-flex.json" flex
        ;;
    drake)
        install drake drake==1.51.1
        python drake "$scripts/drake_tip.py" "$out/4-drake.json"
        ;;
    pybullet)
        install pybullet pybullet==3.2.7 numpy==2.4.6
        python pybullet "$scripts/pybullet_tip.py" "$out/5-pybullet.json"
        ;;
    newton)
        install newton newton==1.8.0
        python newton "$scripts/newton_tip.py" "$out/6-newton.json"
        ;;
    *)
        echo "expected feeler, mujoco, drake, pybullet or newton, got '$peer'" >&2
        exit 2
        ;;
    esac
done
install plot matplotlib==3.11.2 numpy==2.4.6
python plot "$scripts/table.py" "$PWD/docs/figures/soft-tip.svg" "$out"/*.json | tee "$out/table.md"
