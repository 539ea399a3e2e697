"""Control steps per second of the environments, compared with EnvPool's HalfCheetah (if installed) and Gymnasium's CartPole.

    python python/benches/environments.py [SECONDS]

Each rate is the median of five rounds. The agent follows the task's plan, so that the fingers are in contact as often as in a
run. The time of steps and resets counts, the time of the agent does not.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable

import gymnasium
import numpy as np
from feeler.gym import TactileEnv, TactileVectorEnv

ROUNDS = 5


def rate(steps: Callable[[], tuple[int, float]], seconds: float) -> float:
    """Returns the median of the steps per second over rounds of ``seconds`` each."""
    rates = []
    for _ in range(ROUNDS):
        count, elapsed = 0, 0.0
        while elapsed < seconds:
            more, took = steps()
            count, elapsed = count + more, elapsed + took
        rates.append(count / elapsed)
    return statistics.median(rates)


def single(experiment: str) -> Callable[[], tuple[int, float]]:
    """Returns a function that steps a single environment."""
    env = TactileEnv(experiment)
    env.reset(seed=1)

    def steps() -> tuple[int, float]:
        action = env.guide()
        start = time.perf_counter()
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
        return 1, time.perf_counter() - start

    return steps


def vector(envs: TactileVectorEnv) -> Callable[[], tuple[int, float]]:
    """Returns a function that steps all environments, whose episodes are at different stages."""
    envs.reset(seed=1)
    delays = np.random.default_rng(0).integers(0, 1800, envs.num_envs)
    for step in range(int(delays.max())):
        envs.step(envs.guide() * (step >= delays)[:, np.newaxis])

    def steps() -> tuple[int, float]:
        action = envs.guide()
        start = time.perf_counter()
        envs.step(action)
        return envs.num_envs, time.perf_counter() - start

    return steps


def python_share(envs: TactileVectorEnv, seconds: float) -> float:
    """Returns the share of a step's time that is spent in Python, measured by interleaving steps with and without it."""
    envs.reset(seed=1)
    took = {"step": 0.0, "native": 0.0}
    end = time.perf_counter() + 2 * seconds
    while time.perf_counter() < end:
        for what in took:
            action = envs.guide()
            start = time.perf_counter()
            if what == "step":
                envs.step(action)
            else:
                envs._environments.step(action, envs._results)
            took[what] += time.perf_counter() - start
    return 1.0 - took["native"] / took["step"]


def half_cheetah(threads: int) -> Callable[[], tuple[int, float]] | None:
    """Returns a function that steps EnvPool's vector of 256 environments, or ``None`` if it is not installed."""
    try:
        import envpool
    except ImportError:
        return None
    envs = envpool.make("HalfCheetah-v5", env_type="gymnasium", num_envs=256, num_threads=threads)
    envs.reset()
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (256, 6))

    def steps() -> tuple[int, float]:
        start = time.perf_counter()
        envs.step(actions)
        return 256, time.perf_counter() - start

    return steps


def main() -> None:
    """Prints one line per environment."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 2.0
    print(f"load before: {os.getloadavg()[0]:.1f}")
    print(f"single, cap-closing: {rate(single('cap-closing'), seconds):,.0f} steps/s")
    # The states of 64 environments fit into a core's cache, those of 256 do not.
    few = TactileVectorEnv(64, "cap-closing", threads=1, copy=False)
    print(f"vector of 64 on 1 thread: {rate(vector(few), seconds):,.0f} steps/s")
    few.close()
    for threads in (1, 2):
        envs = TactileVectorEnv(256, "cap-closing", threads=threads, copy=False)
        print(f"vector of 256 on {threads} threads: {rate(vector(envs), seconds):,.0f} steps/s")
        print(f"  share of Python: {100.0 * python_share(envs, seconds):.1f} %")
        envs.close()
        if cheetah := half_cheetah(threads):
            print(f"EnvPool's vector of 256 HalfCheetah on {threads} threads: {rate(cheetah, seconds):,.0f} steps/s")
    cart = gymnasium.make_vec("CartPole-v1", num_envs=256, vectorization_mode="sync")
    cart.reset(seed=1)
    action = np.zeros(256, dtype=np.int64)

    def cart_steps() -> tuple[int, float]:
        start = time.perf_counter()
        cart.step(action)
        return 256, time.perf_counter() - start

    print(f"Gymnasium's vector of 256 CartPole: {rate(cart_steps, seconds):,.0f} steps/s")
    print(f"load after: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
