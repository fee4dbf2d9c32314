"""Frames a second on one core: batches of ``hyped``, the same world written by hand in Rust, and environments of PyPI.

    python benches/peers.py [ROUNDS]

Measures short rounds of each alternately, in processor time, so that other load affects all of them, and prints one
table of medians. What is not installed is left out. Needs ``rustc``, and for the peers ``pip install ale-py procgen
gym-super-mario-bros 'numpy<2'`` on Python 3.9 or 3.10.
"""

from __future__ import annotations

import importlib.metadata
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

import hyped

HERE = Path(__file__).parent
TEST_1 = HERE / "../../../examples/paper/test1.hyped"
ROWS = 1024
SECONDS = 0.5
"""Minimum duration of a round."""

Round = Callable[[], list[float]]
"""Measures once; returns frames a second, one number for each of its rows of the table."""


def timed(step: Callable[[int], object], frames: int) -> float:
    """Frames a second of a step that is repeated for a while."""
    before, count = time.process_time(), 0
    while (elapsed := time.process_time() - before) < SECONDS:
        for _ in range(20):
            step(count)
            count += 1
    return count * frames / elapsed


def by_hand(folder: str) -> tuple[list[str], Round]:
    """The world of Test 1 written by hand: a process that measures when it is asked."""
    binary = f"{folder}/by_hand"
    compiled = ["rustc", "--edition", "2024", "-C", "opt-level=3", "-C", "codegen-units=1", "-o", binary]
    subprocess.run([*compiled, str(HERE / "by_hand.rs")], check=True)
    process = subprocess.Popen([binary], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def measure() -> list[float]:
        assert process.stdin and process.stdout
        print(file=process.stdin, flush=True)
        return [float(number) for number in process.stdout.readline().split()]

    return ["Test 1 by hand, one run after the other", f"Test 1 by hand, batch of {ROWS:,}"], measure


def of_batch(observe: hyped.Variables | hyped.Planes | None) -> Round:
    """A batch with random buttons, each held for 8 steps; what has ended begins anew."""
    batch = hyped.Batch(hyped.compile(TEST_1), ROWS, observe=observe, threads=1)
    rng = np.random.default_rng(1)
    actions = [(rng.random(batch.shape) < 0.3).astype(np.float32) for _ in range(16)]
    views = [np.zeros(shape, np.float32) for shape in batch.observation_shapes] or None
    status = np.zeros(ROWS, np.uint8)
    return lambda: [timed(lambda at: batch.step(actions[at // 8 % 16], views, status, reset=True), ROWS)]


def one_run() -> Round:
    """A single run in one call."""
    run = hyped.Simulator(hyped.compile(TEST_1))

    def step(_: int) -> None:
        run.reset()
        run.step("right", count=500)

    return lambda: [timed(step, 500)]


def breakout() -> Round:
    """Breakout of the Arcade Learning Environment: the emulator alone, without pictures as arrays."""
    import ale_py
    from ale_py import roms

    ale_py.ALEInterface.setLoggerMode(ale_py.LoggerMode.Error)
    ale = ale_py.ALEInterface()
    ale.setInt("random_seed", 1)
    ale.loadROM(roms.get_rom_path("breakout"))
    actions = ale.getMinimalActionSet()
    chosen = np.random.default_rng(1).integers(0, len(actions), 4096)

    def step(at: int) -> None:
        ale.act(actions[chosen[at // 8 % 4096]])
        if ale.game_over():
            ale.reset_game()

    return lambda: [timed(step, 1)]


def coinrun() -> Round:
    """CoinRun of Procgen in its own batch, with its pictures of 64 x 64: it has no mode without."""
    from procgen import ProcgenGym3Env

    rows = 64
    env = ProcgenGym3Env(num=rows, env_name="coinrun", num_threads=0, rand_seed=1)
    actions = np.random.default_rng(1).integers(0, 15, (64, rows)).astype(np.int32)

    def step(at: int) -> None:
        env.act(actions[at // 8 % 64])
        env.observe()

    return lambda: [timed(step, rows)]


def super_mario() -> Round:
    """Super Mario Bros. of gym-super-mario-bros, an emulator of the console with its pictures."""
    from gym_super_mario_bros import SuperMarioBrosEnv

    env = SuperMarioBrosEnv()
    env.reset()
    # Of the console's buttons: right, left, B, A.
    chosen = [int(of) & 0b11000011 for of in np.random.default_rng(1).integers(0, 256, 4096)]

    def step(at: int) -> None:
        if env.step(chosen[at // 8 % 4096])[2]:
            env.reset()

    return lambda: [timed(step, 1)]


PEERS: list[tuple[str, str, Callable[[], Round]]] = [
    ("ale-py", "Breakout, emulator alone", breakout),
    ("procgen", "CoinRun, batch of 64, pictures", coinrun),
    ("gym-super-mario-bros", "Super Mario Bros., pictures", super_mario),
]


def processor() -> str:
    """The name of the processor."""
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def main() -> None:
    """Measures and prints the table."""
    warnings.simplefilter("ignore")
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 9
    if hasattr(os, "sched_setaffinity"):
        # Threads and processes that are started from here are on the same core.
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    player = hyped.compile(TEST_1).world().players[0][1]
    variables = hyped.Variables([f"{player}.{part}" for part in ("x", "y", "x'", "y'", "mode")])
    with tempfile.TemporaryDirectory() as folder:
        measures = [
            by_hand(folder),
            ([f"hyped: Test 1, batch of {ROWS:,}"], of_batch(None)),
            ([f"hyped: Test 1, batch of {ROWS:,}, 5 variables"], of_batch(variables)),
            ([f"hyped: Test 1, batch of {ROWS:,}, planes of 13 x 9"], of_batch(hyped.Planes(13, 9))),
            (["hyped: Test 1, one run in one call"], one_run()),
        ]
        for package, what, start in PEERS:
            try:
                name = f"{package} {importlib.metadata.version(package)}: {what}"
                measures.append(([name], start()))
            except Exception as error:
                print(f"{package} is left out: {error}", file=sys.stderr)
        found: list[list[list[float]]] = [[] for _ in measures]
        for _ in range(rounds):
            for (_, measure), numbers in zip(measures, found):
                numbers.append(measure())
    rows = [(name, each) for (names, _), numbers in zip(measures, found) for name, each in zip(names, zip(*numbers))]
    reference = rows[0][1]
    width = max(len(name) for name, _ in rows)
    version = f"hyped {importlib.metadata.version('hyped')}, Python {platform.python_version()}, NumPy {np.__version__}"
    print(f"{version}; {processor()}, one core; medians of {rounds} rounds; load {os.getloadavg()[0]:.1f}")
    print(f"{'':<{width}}  {'frames/s':>12}  {'of by hand':>10}")
    for name, each in rows:
        # Of the same round: load changes.
        share = statistics.median(rate / by_hand for rate, by_hand in zip(each, reference))
        print(f"{name:<{width}}  {statistics.median(each):>12,.0f}  {100 * share:>8.3f} %")


if __name__ == "__main__":
    main()
