#!/usr/bin/env bash
# The sensor against OpenCV on the same picture, in the same run. OpenCV goes into an environment of
# its own under target/.
set -euo pipefail
cd "$(dirname "$0")/../.."

venv=target/peers/venv
if ! "$venv/bin/python" -c 'import cv2' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet opencv-python-headless==4.12.0.88
fi
cargo build --release --quiet --example moments_speed
target/release/examples/moments_speed target/peers | tee target/peers/feeler.txt
"$venv/bin/python" benches/peers/opencv.py target/peers
