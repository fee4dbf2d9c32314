"""The same inputs give the same bits as `hypedc sim`, for every world of the examples: a run of 10,000 steps."""

from __future__ import annotations

import json
import os
import random
import subprocess
from pathlib import Path

import numpy as np
import pytest

import hyped
from conftest import ROOT, programs

STEPS = 10_000
HOLD = 40
"""Maximum number of steps for which inputs are held."""


def worlds() -> list[tuple[str, str | None, str]]:
    """All worlds of the examples, with a level for those that are open."""
    found = []
    for path in programs():
        for name in hyped.compile(path).worlds:
            levels = [None, *sorted(str(of) for of in path.parent.glob("*.txt"))]
            for level in levels:
                try:
                    hyped.compile(path, level=level).world(name)
                except hyped.HypedError:
                    continue
                found.append((str(path), level, name))
                break
    return found


def control_names(world: hyped.World) -> list[tuple[str, bool]]:
    first = min((number for number, _ in world.players), default=1)
    names = []
    for number, _ in world.players:
        prefix = "" if number == first else f"{number}:"
        names += [(prefix + name, False) for name in world.buttons(number)]
        names += [(prefix + name, True) for name in world.axes(number)]
    return names


def drawn(names: list[tuple[str, bool]], rng: random.Random) -> dict[str, float]:
    inputs: dict[str, float] = {}
    for name, is_axis in names:
        if is_axis:
            value = rng.choice([-1.0, 0.0, 1.0, rng.uniform(-1.0, 1.0)])
            inputs.update({name: value} if value else {})
        elif rng.random() < 1 / 3:
            inputs[name] = 1.0
    return inputs


def token(inputs: dict[str, float], names: list[tuple[str, bool]], count: int) -> str:
    is_axis = dict(names)
    parts = [f"{name}={value!r}" if is_axis[name] else name for name, value in inputs.items()]
    return f"{'+'.join(parts) or '-'}*{count}"


def survived(
    run: hyped.Simulator, names: list[tuple[str, bool]], rng: random.Random, most: int
) -> list[tuple[str, int]]:
    """Random inputs, held for a while each, that do not end the run: what ends it is taken back."""
    taken: list[tuple[dict[str, float], int, hyped.Simulator]] = []
    failures = 0
    here = run.copy()
    while here.steps < most and failures < 400:
        before = here.copy()
        inputs, count = drawn(names, rng), min(rng.randint(1, HOLD), most - here.steps)
        try:
            for _ in range(count):
                here.step(inputs)
                if here.left is not None:
                    break
            is_over = here.left is not None
        except hyped.StepError:
            is_over = True
        if is_over:
            failures += 1
            here = before
            # A dead end is left by taking back more and more.
            for _ in range(min(len(taken), failures % 8)):
                here = taken.pop()[2]
        else:
            taken.append((inputs, count, before))
    return [(token(inputs, names, count), count) for inputs, count, _ in taken]


@pytest.mark.parametrize(("path", "level", "name"), worlds(), ids=lambda of: Path(of).stem if of else "")
def test_same_bits(path: str, level: str | None, name: str, hypedc: str, tmp_path: Path) -> None:
    program = hyped.compile(path, level=level)
    world = program.world(name)
    names, rng = control_names(world), random.Random(f"{path} {name}")
    run = hyped.Simulator(program, name, seed=7)
    tokens = survived(run, names, rng, STEPS)
    count = sum(of for _, of in tokens)
    assert count == STEPS, f"no inputs were found that survive for longer than {count} steps"
    assert compared(run, " ".join(text for text, _ in tokens), count, (path, level, hypedc, 7), tmp_path) >= STEPS


def compared(
    run: hyped.Simulator, script: str, count: int, of: tuple[str, str | None, str, int], tmp_path: Path
) -> int:
    """Runs a script and some steps without inputs; returns the number of steps."""
    path, level, hypedc, seed = of
    inputs = tmp_path / "run.inputs"
    inputs.write_text(script, encoding="utf-8")
    # The end of a run is compared, too.
    frames = count + 60
    command = [hypedc, "sim", path, "--world", run.world.name, "--inputs-file", str(inputs), "--frames", str(frames)]
    command += ["--trace", "-"] + (["--map", level] if level else [])
    command += ["--chance", f"seed={seed}"]
    shown = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    lines = shown.stdout.splitlines()[1:]
    assert lines, shown.stderr
    held = [token.rsplit("*", 1) for token in script.split()]
    each = [text for text, times in held for _ in range(int(times))] + ["-"] * 60
    assert lines[0] == run.trace_line()
    for line, text in zip(lines[1:], each):
        run.step(text)
        assert run.trace_line(text) == line
    if len(lines) <= frames:
        # It ended early: by leaving the bounds, or by an error in the next step.
        assert run.left is not None or fails(run, each[len(lines) - 1])
    values(run, json.loads(lines[-1]))
    batched(run, each[: len(lines) - 1], seed)
    return len(lines) - 1


def fails(run: hyped.Simulator, text: str) -> bool:
    try:
        run.copy().step(text)
    except hyped.StepError:
        return True
    return False


def values(run: hyped.Simulator, line: dict) -> None:  # type: ignore[type-arg]
    """The last state by name, bit by bit."""
    seen = 0
    for name, instance in line["instances"].items():
        for part, value in instance.items():
            if isinstance(value, list) and len(value) == 3 and part != "modes":
                for degree, number in enumerate(value):
                    found = run[f"{name}.{part}" + "'" * degree]
                    assert np.float64(found).tobytes() == np.float64(number).tobytes()
                    seen += 1
        assert run.modes(name) == instance["modes"] and run[f"{name}.space"] == instance["space"]
    assert seen > 0 or not line["instances"]


def batched(run: hyped.Simulator, each: list[str], seed: int) -> None:
    """The same inputs in a batch give the same bits."""
    script = " ".join(each)
    actions = hyped.trace(run.program, script, world=run.world.name, names=[], chance=seed).inputs
    assert len(actions) == len(each)
    batch = hyped.Batch(run.program, 2, world=run.world.name, goals=[], nevers=[], seed=seed, threads=1)
    both = np.zeros(batch.shape)
    for action in actions:
        both[0] = action
        batch.step(both)
    assert batch.simulator(0).hash() == run.hash()


def test_every_example_is_compared() -> None:
    compared = {path for path, _, _ in worlds()}
    without_worlds = {str(path) for path in programs() if not hyped.compile(path).worlds}
    assert compared | without_worlds == {str(path) for path in programs()}
    assert len(compared) > 20


assert os.getcwd() == str(ROOT)
