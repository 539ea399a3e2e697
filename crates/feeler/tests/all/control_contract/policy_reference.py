#!/usr/bin/env python3
"""Writes policy_reference.safetensors and .toml beside this script: a small policy, and what numpy makes of it.

Needs numpy and safetensors. The numbers are drawn from a fixed seed: written again, the files are the same.
"""

from pathlib import Path

import numpy as np
from safetensors.numpy import save_file

ELEMENTS = 2
WIDTHS = [3 * ELEMENTS + 21, 12, 5, 3]
RESIDUAL_SPEED = 0.02

folder = Path(__file__).parent
random = np.random.default_rng(7)


def drawn(low, high, *shape):
    return random.uniform(low, high, shape).astype(np.float32)


tensors = {"input.mean": drawn(-0.5, 0.5, WIDTHS[0]), "input.scale": drawn(0.5, 2.0, WIDTHS[0])}
for layer, (inputs, outputs) in enumerate(zip(WIDTHS, WIDTHS[1:])):
    tensors[f"layer{layer}.weight"] = drawn(-0.6, 0.6, outputs, inputs)
    tensors[f"layer{layer}.bias"] = drawn(-0.2, 0.2, outputs)
metadata = {
    "format": "feeler-policy-1",
    "activation": "tanh",
    "elements": str(ELEMENTS),
    "residual_speed": str(RESIDUAL_SPEED),
    "description": "drawn, not trained",
}
save_file(tensors, folder / "policy_reference.safetensors", metadata)

observation = random.uniform(-1.0, 1.0, WIDTHS[0])
# TOUCH, SLIP, OVER, reflex, keep_grasp.
observation[6:9] = [1.0, 0.0, 1.0]
observation[-2:] = [1.0, 0.0]
values = (observation - tensors["input.mean"].astype(float)) / tensors["input.scale"].astype(float)
for layer in range(len(WIDTHS) - 1):
    values = np.tanh(values) if layer > 0 else values
    values = tensors[f"layer{layer}.weight"].astype(float) @ values + tensors[f"layer{layer}.bias"].astype(float)
velocity = observation[19:22] + RESIDUAL_SPEED * np.tanh(values)


def toml(numbers):
    return "[" + ", ".join(repr(float(number)) for number in numbers) + "]"


text = f"# Written by policy_reference.py.\nobservation = {toml(observation)}\nvelocity = {toml(velocity)}\n"
(folder / "policy_reference.toml").write_text(text)
