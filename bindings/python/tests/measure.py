"""Steps of batches per second, beside single steps: python tests/measure.py [PROGRAM]. Looks at the clock."""

from __future__ import annotations

import statistics
import sys
import time

import numpy as np

import hyped

ROUNDS = 15
STEPS = 200


def measured(batch: hyped.Batch, views: list[np.ndarray] | None) -> float:
    """Frames a second: the median of several rounds."""
    rng = np.random.default_rng(1)
    actions = [(rng.random(batch.shape) < 0.3).astype(np.float32) for _ in range(16)]
    status = np.zeros(len(batch), np.uint8)
    found = []
    for _ in range(ROUNDS):
        before = time.perf_counter()
        for step in range(STEPS):
            batch.step(actions[step // 8 % 16], views, status, reset=True)
        found.append(STEPS * len(batch) / (time.perf_counter() - before))
    return statistics.median(found)


def main() -> None:
    path = sys.argv[1] if len(sys.argv) > 1 else "examples/paper/test1.hyped"
    program = hyped.compile(path)
    player = program.world().players[0][1]
    names = [f"{player}.{part}" for part in ("x", "y", "x'", "y'", "mode")]
    names = [name for name in names if name in program.world().names]
    for what, observe in (
        ("no observation", None),
        (f"{len(names)} variables", hyped.Variables(names)),
        ("13 x 9 planes", hyped.Planes(13, 9)),
    ):
        for threads in (1, 2):
            batch = hyped.Batch(program, 1024, observe=observe, threads=threads)
            views = [np.zeros(shape, np.float32) for shape in batch.observation_shapes] or None
            print(f"{path}: {what}, {threads} thread(s): {measured(batch, views) / 1e6:.2f} million frames a second")
    run = hyped.Simulator(program)
    before = time.perf_counter()
    run.step(count=200_000)
    print(f"single run, one call: {0.2 / (time.perf_counter() - before):.2f} million frames a second")


if __name__ == "__main__":
    main()
