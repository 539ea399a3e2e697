#!/usr/bin/env bash
# Compares the sensor with OpenCV on the same image, and the physics with MuJoCo on a similar scene, each in one run.
# The peers are installed in separate environments under target/.
set -euo pipefail
cd "$(dirname "$0")/../.."

venv=target/peers/venv
if ! "$venv/bin/python" -c 'import cv2' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet opencv-python-headless==4.12.0.88
fi
cargo build --release --quiet -p feeler-lab --example moments_speed
mkdir -p target/peers
target/release/examples/moments_speed target/peers | tee target/peers/feeler.txt
"$venv/bin/python" benches/peers/opencv.py target/peers

venv=target/peers/mujoco
if ! "$venv/bin/python" -c 'import mujoco' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet mujoco==4.0.0 numpy==2.4.6
fi
cargo bench --quiet -p feeler-lab --bench sim -- physics_of_mujocos_scene | tee target/peers/sim.txt
"$venv/bin/python" benches/peers/mujoco.py target/peers/sim.txt
