"""Trains a policy that tightens unknown caps: imitates the control law `best`, then improves by evolution strategies.

    pip install './python[gym]' jax==0.10.2 flax==0.12.8 optax==0.2.8 safetensors
    python examples/python/train_policy.py -o my.safetensors
    feeler compare cap-closing --laws tri-axial,best --policy my.safetensors --seed 5

Caps vary in friction, seat, offset and noise as in `feeler compare`. Ctrl-C ends the training and keeps the best policy so far.
docs/learning.md describes the results.
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
    from jax.flatten_util import ravel_pytree
    from safetensors.numpy import save_file
except ImportError as error:
    sys.exit(f"{error}: pip install './python[gym]' jax==0.10.2 flax==0.12.8 optax==0.2.8 safetensors")

Array = NDArray[Any]

# Variation and settings of `feeler compare cap-closing`.
CAPS = {
    "friction": "uniform(0.4,1.2)",
    "sim.object.cap.offset.0": "uniform(-0.001,0.001)",
    "sim.object.cap.offset.1": "uniform(-0.001,0.001)",
    "sim.object.cap.motion.thread.seat_angle": "relative(0.5,1.5)",
    "direct_sensing.normal_noise": "uniform(0,0.006)",
    "direct_sensing.shear_noise": "uniform(0,0.006)",
}
SETTINGS: dict[str, Any] = {"sim.variation.friction": 0.0, "sim.object.cap.offset": [0.0, 0.0, 0.0], "time_limit": 30.0}

FINGERTIP = feeler.Fingertip(experiment="cap-closing")
ELEMENTS, FRAMES = FINGERTIP.element_count, FINGERTIP.rotations
# A finger's observation: forces; joint angles, velocities and directions; of them the direction towards the object; a flag.
INPUTS, FORCES, MOTION, TOWARDS, KEEP_GRASP = 3 * ELEMENTS + 21, slice(0, 123), slice(127, 142), slice(139, 142), 143
# Divisors of inputs: N for forces, then flags, N, rad, rad/s, m/s twice, directions, flags.
SCALE = np.repeat(np.array([0.1, 1, 1, 0.3, 0.1, 0.01, 0.01, 0.3, 1], np.float32), [123, 3, 1, 3, 3, 3, 3, 3, 2])
TURNED = np.array([1.0, -1.0, -1.0], np.float32)  # a vector in T after half a turn about the axis
RESIDUAL_SPEED = 0.010  # m/s, most that the policy adds to the plan along each axis
SATURATED = 100.0  # tanh is 1 there
# `best`, tuned by tune_law.py: friction, margin, least grasp force, element force, slip share, gain, pressing speed.
TEACHER = (0.6, 2.891, 0.8, 0.4413, 0.1289, 0.2, 0.01072)


def half_turn() -> tuple[Array, Array]:
    """Index and sign that map a finger's observation to that after half a turn about its axis, i.e. of the other finger."""
    turned = FINGERTIP.tips * TURNED
    order = np.linalg.norm(turned[:, None] - FINGERTIP.tips, axis=-1).argmin(axis=1)
    index, sign = np.arange(INPUTS), np.ones(INPUTS, np.float32)
    index[FORCES] = (3 * order[:, None] + np.arange(3)).ravel()
    sign[:2] = -1.0  # shear of the element on the axis
    sign[MOTION] = [-1.0] * 6 + [1.0, -1.0, -1.0] * 3
    return index, sign


INDEX, SIGN = half_turn()


def demonstration(observation: Array) -> Array:
    """Velocity added to the plan by `best` (m/s in T, [..., 3]) for observations [..., 144], without friction estimation."""
    friction, margin, least, most, share, gain, speed = TEACHER
    force = observation[..., FORCES].reshape(*observation.shape[:-1], ELEMENTS, 3) * [1.0, 1.0, -1.0]
    pressed = np.where(force[..., 2] < -0.02, -force[..., 2], 0.0)
    inward = pressed @ FRAMES[..., 2]
    length = np.linalg.norm(inward, axis=-1, keepdims=True)
    inward = np.where(length > 0.0, inward / np.maximum(length, 1e-9), observation[..., TOWARDS])
    felt = np.einsum("eij,...ej->...ei", FRAMES, force) * (pressed > 0.0)[..., None]
    along = -np.einsum("...ei,...i->...e", felt, inward)
    shear = np.linalg.norm(felt + along[..., None] * inward[..., None, :], axis=-1).sum(-1)
    normal = np.maximum(along, 0.0)
    largest = np.maximum(pressed, share * np.linalg.norm(felt, axis=-1)).max(-1)
    missing = (np.maximum(margin * shear / friction, least) - normal.sum(-1)) / np.maximum((normal > 0.15).sum(-1), 1.0)
    pressing = np.clip(gain * np.minimum(missing, most - largest), -speed, speed) * observation[..., KEEP_GRASP]
    return np.asarray(pressing[..., None] * inward)


class Network(nn.Module):
    """A small perceptron that is zero where the plan does not ask to keep a grasp: its whole first layer is saturated there."""

    width: int

    @nn.compact
    def __call__(self, x: jax.Array) -> jax.Array:
        first, second = nn.Dense(self.width), nn.Dense(self.width)
        last = nn.Dense(3, use_bias=False, kernel_init=nn.initializers.zeros)
        felt = nn.tanh(first(x) + SATURATED * (x[..., KEEP_GRASP, None] - 1.0))
        return last(nn.tanh(second(felt)) - nn.tanh(second(jnp.full(self.width, -1.0))))


def residual(network: Network, parameters: Any, observation: Any) -> jax.Array:
    """What the policy adds to the plan, m/s in T: the mean over both ways to look at a finger, as it is and turned by half."""
    both: Any = network.apply(parameters, jnp.stack([observation, observation[..., INDEX] * SIGN]) / SCALE)
    return RESIDUAL_SPEED * jnp.tanh(0.5 * (both[0] + both[1] * TURNED))


def save(path: Path, parameters: Any, description: str) -> None:
    """Writes the policy as one network of twice the width, which is what the mean over both ways comes to."""
    layers = [jax.tree.map(np.array, parameters["params"][f"Dense_{k}"]) for k in range(3)]
    (w0, w1, w2), (b0, b1) = [layer["kernel"].T for layer in layers], [layer["bias"] for layer in layers[:2]]
    w0[:, KEEP_GRASP] += SATURATED
    b2 = -w2 @ np.tanh(b1 - w1.sum(axis=1))
    turned, zero = np.empty_like(w0), np.zeros_like(w1)
    turned[:, INDEX] = w0 * SIGN
    weights = [np.concatenate([w0, turned]), np.block([[w1, zero], [zero, w1]]), 0.5 * np.hstack([w2, TURNED[:, None] * w2])]
    biases = [np.tile(b0 - SATURATED, 2), np.tile(b1, 2), 0.5 * (b2 + TURNED * b2)]
    tensors = {"input.mean": np.zeros(INPUTS, np.float32), "input.scale": SCALE}
    for k, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
        tensors |= {f"layer{k}.weight": np.ascontiguousarray(weight, np.float32), f"layer{k}.bias": bias.astype(np.float32)}
    metadata = {"format": "feeler-policy-1", "activation": "tanh", "elements": str(ELEMENTS)}
    metadata |= {"residual_speed": str(RESIDUAL_SPEED), "description": description}
    part = path.with_name(path.name + ".part")
    save_file(tensors, part, metadata)
    part.replace(path)  # atomic, even if the program is interrupted


def seeds(series: int, number: int, count: int) -> range:
    """Seeds of the caps with this number in a series, `count` at a time."""
    return range(1_000_000 * series + number * count, 1_000_000 * series + (number + 1) * count)


class Caps:
    """Caps that are tightened in parallel."""

    def __init__(self, count: int) -> None:
        self.count = count
        make: Any = gymnasium.make_vec
        self.envs = make("feeler/CapClosing-v0", num_envs=count, vary=CAPS, settings=SETTINGS, copy=False)

    def tighten(self, seeds: Sequence[int], act: Callable[[Array], Any]) -> tuple[Array, Array]:
        """Final torque (mN·m; 0 if the strokes did not end in time) and peak force on an element (N) of each cap, where `act`
        says what is added to the plan, [n, 2, 3], for observations [n, 2, 144]."""
        observation, _ = self.envs.reset(seed=list(seeds))
        over, torque, peak = np.zeros(self.count, bool), np.zeros(self.count), np.zeros(self.count)
        while not over.all():
            added = np.asarray(act(observation.reshape(self.count, 2, INPUTS)), np.float64)
            observation, _, terminated, truncated, info = self.envs.step(self.envs.guide() + added.reshape(self.count, 6))
            torque = np.where(over, torque, 1e3 * info["cap_torque_nm"] * ~truncated)
            peak = np.where(over, peak, np.maximum(peak, info["peak_force_n"]))
            over |= terminated | truncated
        return torque, peak


def imitate(network: Network, parameters: Any, arguments: argparse.Namespace) -> Any:
    """Learns what the teacher would do: on its own caps first, and then where the policy itself gets (DAgger)."""
    caps, random = Caps(arguments.demonstrations), np.random.default_rng(arguments.seed)
    optimizer = optax.adam(optax.cosine_decay_schedule(2e-3, arguments.rounds * arguments.steps))
    state, seen, shown = optimizer.init(parameters), [], []
    decide = jax.jit(lambda parameters, x: residual(network, parameters, x))

    @jax.jit
    def learn(parameters: Any, state: Any, x: Any, y: Any) -> tuple[Any, Any, jax.Array]:
        def error(parameters: Any) -> jax.Array:
            return jnp.mean(((residual(network, parameters, x) - y) / RESIDUAL_SPEED) ** 2)

        value, gradient = jax.value_and_grad(error)(parameters)
        updates, state = optimizer.update(gradient, state)
        return optax.apply_updates(parameters, updates), state, value

    def act(observation: Array) -> Any:
        wanted = demonstration(observation)
        use = (random.random(observation.shape[:2]) < 0.25) & (observation[..., KEEP_GRASP] > 0)
        seen.append(observation[use])
        shown.append(wanted[use].astype(np.float32))
        return decide(parameters, observation) if number else wanted

    for number in range(arguments.rounds):
        torque, peak = caps.tighten(seeds(arguments.seed + 1, number, caps.count), act)
        x, y = np.concatenate(seen), np.concatenate(shown)
        for batch in random.integers(len(x), size=(arguments.steps, 512)):
            parameters, state, error = learn(parameters, state, x[batch], y[batch])
        who = "policy" if number else "teacher"
        print(f"imitation {number + 1}: {who} {torque.mean():.2f} mN·m, {peak.mean():.4f} N on {caps.count} caps; ", end="")
        print(f"then {1e3 * RESIDUAL_SPEED * float(error) ** 0.5:.2f} mm/s from the teacher", flush=True)
    return parameters


def evolve(network: Network, parameters: Any, arguments: argparse.Namespace, start: float) -> None:
    """Evolution strategies on all layers but the first: mirrored perturbations on the same cap, and a step along the
    differences that they make. A newton above the budget has a price, which rises as long as the policy presses too hard."""
    pairs, price, best, random = arguments.pairs, 200.0, -np.inf, np.random.default_rng(arguments.seed)
    caps, check = Caps(2 * pairs), Caps(arguments.checks)
    layers = dict(parameters["params"])
    first = layers.pop("Dense_0")
    centre, unravel = ravel_pytree(layers)
    optimizer = optax.adam(optax.cosine_decay_schedule(arguments.rate, max(1, arguments.generations), 0.1))
    state = optimizer.init(centre)

    def whole(flat: Any) -> Any:
        return {"params": {"Dense_0": first, **unravel(flat)}}

    one = jax.jit(lambda flat, x: residual(network, whole(flat), x))
    each = jax.jit(jax.vmap(lambda flat, x: residual(network, whole(flat), x)))
    for generation in range(arguments.generations + 1):
        minutes = (time.monotonic() - start) / 60
        last = generation == arguments.generations or minutes > arguments.minutes
        if generation % arguments.every == 0 or last:
            torque, peak = check.tighten(seeds(arguments.seed + 2, 0, check.count), lambda x: one(centre, x))  # noqa: B023
            excess = peak.mean() - arguments.budget
            score = torque.mean() - 500.0 * max(0.0, excess)  # steeper than the rise of torque with force
            told = f"{torque.mean():.2f} mN·m, {peak.mean():.4f} N on {check.count} caps"
            if kept := score > best:
                best = score
                save(arguments.out, whole(centre), f"train_policy.py --seed {arguments.seed}, generation {generation}: {told}")
            print(f"{minutes:5.1f} min, generation {generation}: {told}{', kept' if kept else ''}", flush=True)
            price *= np.exp(20.0 * excess)
        if last:
            break
        noise = random.standard_normal((pairs, centre.size), np.float32)
        population = centre + arguments.sigma * np.concatenate([noise, -noise])
        own = seeds(arguments.seed + 3, generation, pairs)
        torque, peak = caps.tighten([*own, *own], lambda x: each(population, x))  # noqa: B023
        fitness = torque - price * np.maximum(peak - arguments.budget, 0.0)
        # Ranks limit the influence of a lost cap to that of the largest other difference.
        difference = fitness[:pairs] - fitness[pairs:]
        weight = np.sign(difference) * (np.argsort(np.argsort(np.abs(difference))) + 1) / pairs
        updates, state = optimizer.update(-jnp.asarray(weight @ noise / pairs, jnp.float32), state)
        centre = optax.apply_updates(centre, updates)


def main() -> None:
    """Trains a policy and prints the duration."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", type=Path, default=Path("policy.safetensors"), help="the policy's file")
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    add = parser.add_argument
    add("--seed", type=int, default=100, help="seed of network, perturbations and training caps")
    add("--minutes", type=float, default=27.0, help="minutes after which the next generation ends the training")
    add("--width", type=int, default=24, help="neurons of a layer; the file's network has twice as many")
    add("--demonstrations", type=int, default=32, help="caps of a round of imitation")
    add("--rounds", type=int, default=4, help="rounds of imitation")
    add("--steps", type=int, default=2000, help="gradient steps of a round")
    add("--generations", type=int, default=180, help="generations of evolution")
    add("--pairs", type=int, default=64, help="pairs of perturbations of a generation")
    add("--sigma", type=float, default=0.02, help="standard deviation of the perturbations")
    add("--rate", type=float, default=0.004, help="learning rate, which goes down to a tenth")
    add("--budget", type=float, default=0.513, help="N, mean peak force on an element")
    add("--every", type=int, default=5, help="generations from one check to the next")
    add("--checks", type=int, default=128, help="caps of a check")
    arguments = parser.parse_args()
    if arguments.out.exists() and not arguments.force:
        sys.exit(f"{arguments.out} is there already; expected a new file, or --force")
    start = time.monotonic()
    network = Network(arguments.width)
    parameters = network.init(jax.random.key(arguments.seed), jnp.zeros(INPUTS))
    try:
        evolve(network, imitate(network, parameters, arguments), arguments, start)
    except KeyboardInterrupt:
        print("interrupted")
    kept = arguments.out if arguments.out.exists() else "no policy"
    print(f"{kept} after {(time.monotonic() - start) / 60:.1f} min")


if __name__ == "__main__":
    main()
