"""Trains a policy that grips unknown objects by imitating a law of `task.grip`, with or without touch.

    pip install './python[gym]' jax==0.10.2 flax==0.12.8 optax==0.2.8 safetensors
    python examples/python/train_grip_policy.py -o touch.safetensors
    python examples/python/train_grip_policy.py -o blind.safetensors --blind
    feeler compare grip --policy blind.safetensors --policy touch.safetensors --trials 500 --seed 5

Objects are those of `feeler compare grip`. With --blind, the network has the same size, demonstrations and training, but no
input from the tactile sensor. docs/learning.md describes the results.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import feeler
import numpy as np
from numpy.typing import NDArray

try:
    import gymnasium
    import jax
    import jax.numpy as jnp
    import optax
    from flax import linen as nn
    from safetensors.numpy import save_file
except ImportError as error:
    sys.exit(f"{error}: pip install './python[gym]' jax==0.10.2 flax==0.12.8 optax==0.2.8 safetensors")

Array = NDArray[Any]

FINGERTIP = feeler.Fingertip(experiment="grip")
ELEMENTS, FRAMES = FINGERTIP.element_count, FINGERTIP.rotations
# A finger's observation: forces; TOUCH, SLIP, OVER; grasp force; position and velocity of the joint; last action; planned
# velocity; direction towards the object; two flags.
TOUCH_INPUTS = 3 * ELEMENTS + 4
JOINT, SPEED, ACTION, PLANNED = (TOUCH_INPUTS + k for k in (0, 1, 2, 5))
INPUTS = TOUCH_INPUTS + 13
OWN_INPUTS = [JOINT, SPEED, ACTION, PLANNED]  # of a gripper without touch; the others are constant
MOVE = 1  # phase in which the policy acts
HOLDING = 1.0  # 1/s, of the plan: speed per distance from where the finger grasped the object
RESIDUAL_SPEED = 0.04  # m/s, maximum that the policy adds to the plan
PRECISION = 0.005  # m/s, error from which the loss rises linearly
LIFT = 3.0  # s, time at which the arm lifts the gripper
BATCH = 1024


class Network(nn.Module):
    """A perceptron from a finger's observation to a speed. Rectifiers suit a law that is nearly proportional to force."""

    width: int

    @nn.compact
    def __call__(self, x: jax.Array) -> jax.Array:
        x = nn.relu(nn.Dense(self.width)(x))
        x = nn.relu(nn.Dense(self.width)(x))
        return RESIDUAL_SPEED * jnp.tanh(nn.Dense(1, kernel_init=nn.initializers.zeros)(x)[..., 0])


def mirrored(axis: int) -> tuple[Array, Array]:
    """Index and sign of an observation that is mirrored along this axis of T, across which the fingertip is symmetric."""
    mirror = np.ones(3)
    mirror[axis] = -1.0
    tips = FINGERTIP.tips
    image = np.linalg.norm((tips * mirror)[:, None] - tips, axis=-1).argmin(axis=1)
    # The frame of an element, mirrored, in the frame of its image.
    frames = np.einsum("eji,j,ejk->eik", FRAMES[image], mirror, FRAMES)
    if not np.allclose(np.abs(frames), np.eye(3), atol=1e-6):
        raise ValueError("the fingertip is not symmetric")
    index, sign = np.arange(INPUTS), np.ones(INPUTS, np.float32)
    # Of a mirrored element e, the forces are those of the element whose image it is.
    source = np.argsort(image)
    index[: 3 * ELEMENTS] = (3 * source[:, None] + np.arange(3)).ravel()
    sign[: 3 * ELEMENTS] = np.diagonal(frames, axis1=1, axis2=2)[source].ravel()
    return index, sign


class Objects:
    """Random objects that are gripped in parallel. The environment's plan is the demonstration."""

    def __init__(self, count: int, teacher: str) -> None:
        self.count = count
        make: Any = gymnasium.make_vec
        settings = {"task.grip.law": teacher}
        self.envs = make("feeler/Grip-v0", num_envs=count, vary={"object": "random"}, settings=settings, copy=False)

    def grip(self, seeds: Sequence[int], act: Callable[[Array, Array, Array], Any]) -> float:
        """Grips the objects of these seeds; returns the share that is put down again. `act` receives observations [n, 2, N]
        as under a policy, the residual speeds [n, 2] that the teacher would add, and the environments that demonstrate [n]:
        those whose arm carries an object. Before the lift, the teacher holds all objects alike, which would teach a policy
        without touch to hold too little. `act` returns the residual speeds [n, 2] to execute."""
        observation, info = self.envs.reset(seed=list(seeds))
        over, good = np.zeros(self.count, bool), np.zeros(self.count, bool)
        begun, grasped = np.zeros(self.count, bool), np.zeros((self.count, 2))
        while not over.all():
            x = observation.reshape(self.count, 2, INPUTS).copy()
            action = self.envs.guide().reshape(self.count, 2, 3).copy()
            holds = (info["phase"] == MOVE) & ~over
            grasped[holds & ~begun] = x[holds & ~begun, :, JOINT]
            plan = HOLDING * (grasped - x[..., JOINT])
            x[..., PLANNED], x[..., PLANNED + 1 :] = plan, 0.0
            added = act(x, action[..., 0] - plan, holds & (info["time_s"] >= LIFT))
            action[holds, :, 0] = (plan + added)[holds]
            begun = holds
            observation, _, terminated, truncated, info = self.envs.step(action.reshape(self.count, 6))
            good |= (info["success"] > 0.0) & ~over
            over |= terminated | truncated
        return float(good.mean())


def scale(x: Array) -> tuple[Array, Array]:
    """Mean and scale of the inputs. Forces of all elements share a scale, and constant inputs are not scaled."""
    mean, deviation = x.mean(axis=0), x.std(axis=0)
    mean[: 3 * ELEMENTS] = 0.0
    for axis in range(3):
        deviation[axis : 3 * ELEMENTS : 3] = np.sqrt(np.mean(x[:, axis : 3 * ELEMENTS : 3] ** 2))
    return mean, np.where(deviation > 1e-6, deviation, 1.0)


class Imitation:
    """Demonstrations, and the network that imitates them."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        self.arguments, self.random = arguments, np.random.default_rng(arguments.seed)
        self.network = Network(arguments.width)
        self.used = np.zeros(INPUTS, np.float32)
        self.used[OWN_INPUTS] = 1.0
        if not arguments.blind:
            self.used[:TOUCH_INPUTS] = 1.0
        self.mean, self.scale = np.zeros(INPUTS, np.float32), np.ones(INPUTS, np.float32)
        self.parameters: Any = self.network.init(jax.random.key(arguments.seed), jnp.zeros(INPUTS))
        self.optimizer = optax.adam(optax.cosine_decay_schedule(arguments.rate, arguments.rounds * arguments.steps, 0.02))
        self.state = self.optimizer.init(self.parameters)
        self.seen: list[Array] = []
        self.shown: list[Array] = []
        self.of: list[Array] = []  # object of each demonstration
        self.decide = jax.jit(lambda parameters, x: self.network.apply(parameters, x))
        self.mirrors = [mirrored(1), mirrored(2)]

    def inputs(self, x: Array) -> Array:
        """Normalised inputs of the network for observations."""
        return np.asarray((x - self.mean) / self.scale * self.used, np.float32)

    def round(self, objects: Objects, number: int) -> float:
        """Collects demonstrations: on the teacher's own runs first, then in states that the policy itself reaches (DAgger)."""

        def act(x: Array, wanted: Array, shown: Array) -> Any:
            use = (self.random.random(wanted.shape) < self.arguments.share) & shown[:, None]
            self.seen.append(x[use])
            self.shown.append(wanted[use].astype(np.float32))
            self.of.append(number * objects.count + np.nonzero(use)[0])
            return np.asarray(self.decide(self.parameters, self.inputs(x)), np.float64) if number else wanted

        return objects.grip(seeds(self.arguments.seed, number, objects.count), act)

    def learn(self) -> float:
        """Improves the network on all demonstrations so far; returns the median error (m/s). All objects have the same weight,
        whether they were held long or dropped soon."""

        @jax.jit
        def step(parameters: Any, state: Any, x: Any, y: Any) -> tuple[Any, Any]:
            def loss(parameters: Any) -> jax.Array:
                return jnp.mean(optax.huber_loss((self.network.apply(parameters, x) - y) / PRECISION))

            gradient = jax.grad(loss)(parameters)
            updates, state = self.optimizer.update(gradient, state)
            return optax.apply_updates(parameters, updates), state

        x, y = np.concatenate(self.seen), np.concatenate(self.shown)
        if not self.scale_is_known():
            self.mean, self.scale = scale(x)
        x, of = self.inputs(x), np.concatenate(self.of)
        ends = np.cumsum(1.0 / np.bincount(of)[of])
        for _ in range(self.arguments.steps):
            batch = np.searchsorted(ends, ends[-1] * self.random.random(BATCH))
            some = x[batch]
            for index, sign in self.mirrors:
                if self.random.random() < 0.5:
                    some = some[:, index] * sign
            self.parameters, self.state = step(self.parameters, self.state, some, y[batch])
        some = self.random.integers(len(x), size=20_000)
        return float(np.median(np.abs(self.decide(self.parameters, x[some]) - y[some])))

    def scale_is_known(self) -> bool:
        return bool((self.scale != 1.0).any())

    def save(self, path: Path, description: str) -> None:
        """Writes the policy. Inputs that it must not use have weights of zero, as have speeds across the closing direction."""
        layers = [jax.tree.map(np.array, self.parameters["params"][f"Dense_{k}"]) for k in range(3)]
        weights, biases = [layer["kernel"].T for layer in layers], [layer["bias"] for layer in layers]
        weights[0] = weights[0] * self.used
        weights[2] = np.concatenate([weights[2], np.zeros((2, self.arguments.width))])
        biases[2] = np.concatenate([biases[2], np.zeros(2)])
        tensors = {"input.mean": self.mean.astype(np.float32), "input.scale": self.scale.astype(np.float32)}
        for k, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
            tensors |= {f"layer{k}.weight": np.ascontiguousarray(weight, np.float32), f"layer{k}.bias": bias.astype(np.float32)}
        metadata = {"format": "feeler-policy-1", "activation": "relu", "elements": str(ELEMENTS), "joints": "1"}
        metadata |= {"residual_speed": str(RESIDUAL_SPEED), "description": description}
        part = path.with_name(path.name + ".part")
        save_file(tensors, part, metadata)
        part.replace(path)  # atomic, even if the program is interrupted


def seeds(seed: int, number: int, count: int) -> range:
    """Seeds of the objects of a round. Those of `feeler compare grip` with a seed above 0 are far larger."""
    first = 1_000_000 * seed + number * count
    return range(first, first + count)


def main() -> None:
    """Trains a policy and prints the duration."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", type=Path, default=Path("policy.safetensors"), help="policy file to write")
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    add = parser.add_argument
    add("--blind", action="store_true", help="without the inputs of the tactile sensor")
    add("--teacher", default="known-friction", help="law that demonstrates")
    add("--seed", type=int, default=100, help="seed of network, samples and training objects")
    add("--width", type=int, default=64, help="neurons per layer")
    add(
        "--rounds",
        type=int,
        default=8,
        help="rounds of demonstrations; the teacher acts in the first, the policy in the others",
    )
    add("--objects", type=int, default=64, help="objects per round")
    add("--share", type=float, default=0.3, help="share of the steps that is kept")
    add("--steps", type=int, default=2000, help="gradient steps per round")
    add("--rate", type=float, default=2e-3, help="initial learning rate")
    arguments = parser.parse_args()
    if arguments.out.exists() and not arguments.force:
        sys.exit(f"{arguments.out} already exists; expected a new file, or --force")
    start = time.monotonic()
    imitation, objects = Imitation(arguments), Objects(arguments.objects, arguments.teacher)
    for number in range(arguments.rounds):
        held = imitation.round(objects, number)
        error = imitation.learn()
        who = "policy" if number else arguments.teacher
        minutes = (time.monotonic() - start) / 60
        print(
            f"{minutes:5.1f} min, round {number + 1}: {who} puts down {100 * held:.0f} % of {objects.count} objects; ", end=""
        )
        print(f"then {1e3 * error:.2f} mm/s from the teacher", flush=True)
        own = f"train_grip_policy.py --seed {arguments.seed}{' --blind' if arguments.blind else ''}, round {number + 1}"
        imitation.save(arguments.out, own)
    print(f"{arguments.out} after {(time.monotonic() - start) / 60:.1f} min")


if __name__ == "__main__":
    main()
