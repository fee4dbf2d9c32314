"""Random calls with wrong shapes, types and dead objects: exceptions, never a crash. HYPED_LONG=1 makes a million."""

from __future__ import annotations

import os
import random
import sys
import warnings
from typing import Any

import numpy as np

import hyped
from conftest import BALL
from hyped import _hyped

CALLS = 1_000_000 if os.environ.get("HYPED_LONG") == "1" else 20_000

ALLOWED = (hyped.HypedError, TypeError, ValueError, KeyError, IndexError, OverflowError, RuntimeError, AttributeError)
"""What a wrong call may raise; a panic of the library is none of them."""
OPEN = "world W { tiles t 8 x 8 { '.': empty; '#': rock }; space s { map level t }; goal g: 1 > 2 }"


def arrays(rng: random.Random) -> Any:
    shape = tuple(rng.choice([0, 1, 2, 3, 5, 64]) for _ in range(rng.randint(0, 4)))
    dtype = rng.choice(
        [np.float32, np.float64, np.uint8, np.int8, np.bool_, np.int64, np.complex64, object, "U3", "V4"]
    )
    array = np.zeros(shape, dtype)
    if array.dtype.kind == "f" and rng.random() < 0.5:
        array.fill(rng.choice([np.nan, np.inf, -np.inf, 1e300 if dtype == np.float64 else 1e30, -0.0, 1.0]))
    if rng.random() < 0.2:
        array = array.T
    if rng.random() < 0.1 and array.ndim:
        array = array[::2]
    if rng.random() < 0.1:
        array.flags.writeable = False
    return array


def anything(rng: random.Random, things: list[Any]) -> Any:
    pick = rng.random()
    if pick < 0.25:
        return rng.choice(things)
    if pick < 0.45:
        return arrays(rng)
    return rng.choice(
        [
            None,
            True,
            False,
            0,
            1,
            -1,
            2,
            3,
            64,
            1 << 31,
            1 << 63,
            1 << 64,
            -(1 << 70),
            0.5,
            float("nan"),
            float("inf"),
            "",
            "up",
            "up*3",
            "ball",
            "ball.x",
            "ball.x'",
            "ball.mode",
            "far",
            "low",
            "Sky",
            "ball.x > 3",
            "ball.x > 3 and",
            "'",
            "\0",
            "é" * 50,
            "x" * 5000,
            "{" * 300,
            b"",
            b"hypedst1",
            b"\xff" * 40,
            [],
            [1],
            ["ball.x"],
            ["up", None],
            (),
            (1, 2),
            {},
            {"up": 1},
            {"up": "x"},
            {1: 2},
            {"nature:a.b": 1},
            object(),
            BALL,
            OPEN,
            "\n",
            "#.\n..",
            int,
            print,
            1j,
            range(3),
            set(),
        ]
    )


def small(value: Any) -> Any:
    """No call of the test takes long: counts stay small."""
    if isinstance(value, int) and not isinstance(value, bool) and value > 200 and value < 1 << 62:
        return 7
    return value


def fresh(rng: random.Random, programs: list[Any]) -> Any:
    """A new object to misuse."""
    program = rng.choice(programs)
    kind = rng.randint(0, 4)
    if kind == 0:
        return hyped.Simulator(program, seed=rng.randint(0, 9))
    if kind == 1:
        observe = rng.choice([None, hyped.Variables(program.world().names[-3:]), hyped.Planes(3, 5)])
        return hyped.Batch(program, rng.choice([1, 2, 5, 64]), observe=observe, threads=rng.choice([1, 2]))
    if kind == 2:
        return program.world()
    return program if kind == 3 else hyped.Planes(rng.randint(1, 9), rng.randint(1, 9))


METHODS = {
    hyped.Simulator: [
        "step",
        "step_with_events",
        "run",
        "reset",
        "restore",
        "save",
        "copy",
        "hash",
        "values",
        "modes",
        "__getitem__",
        "__setitem__",
        "trace_line",
        "picture_shape",
        "state",
        "__reduce__",
        "goals",
        "left",
        "seed",
    ],
    hyped.Batch: [
        "step",
        "observe",
        "reset",
        "why",
        "save",
        "restore",
        "simulator",
        "hash",
        "status",
        "steps",
        "seeds",
        "shape",
        "observation_shapes",
        "__len__",
    ],
    hyped.World: ["buttons", "axes", "words", "tiles", "names", "players", "goals", "step"],
    hyped.Program: ["world", "worlds", "sha256", "_asking", "__reduce__", "warnings"],
    hyped.Planes: ["tags", "rows", "__reduce__"],
}
FUNCTIONS = [
    hyped.compile,
    hyped.Simulator,
    hyped.Batch,
    hyped.Variables,
    hyped.Planes,
    hyped.with_level,
    hyped.trace,
    _hyped._compile,
    _hyped._rebuilt,
    _hyped._stuck,
    _hyped._bounds,
    _hyped._tune,
    _hyped._resumed,
    _hyped._reach,
    _hyped._why,
    _hyped._trace,
    hyped.why,
    hyped.reach,
    hyped.explore,
    _hyped._explore,
    hyped.World,
    hyped.Program,
    hyped.Event,
]
KEYWORDS = [
    "observe",
    "goals",
    "nevers",
    "within",
    "seed",
    "threads",
    "world",
    "level",
    "tile",
    "params",
    "planner",
    "status",
    "reset",
    "observations",
    "count",
    "steps",
    "rows",
    "chance",
    "nodes",
]


def test_wrong_calls_raise() -> None:
    rng = random.Random(24)
    programs = [hyped.compile(BALL), hyped.compile("examples/pong.hyped"), hyped.compile("examples/asteroids.hyped")]
    things: list[Any] = [fresh(rng, programs) for _ in range(12)]
    fine, raised = 0, {}  # type: int, dict[str, int]
    warnings.simplefilter("ignore")
    for call in range(CALLS):
        if call % 50 == 0:
            # What is replaced is dead, and so is what it was made of.
            things[rng.randrange(len(things))] = fresh(rng, programs)
        target = rng.choice(things)
        arguments = [small(anything(rng, things)) for _ in range(rng.choice([0, 1, 1, 2, 2, 3, 4]))]
        keywords = {rng.choice(KEYWORDS): small(anything(rng, things)) for _ in range(rng.choice([0, 0, 0, 1, 2]))}
        methods = METHODS.get(type(target))
        try:
            if methods is None or rng.random() < 0.1:
                function = rng.choice(FUNCTIONS)
                if function in (hyped.reach, hyped.explore):
                    keywords["nodes"] = 50
                function(*arguments, **keywords)
            else:
                name = rng.choice(methods)
                member = getattr(target, name)
                if callable(member):
                    member(*arguments, **keywords)
                elif arguments and rng.random() < 0.1:
                    setattr(target, name, arguments[0])
            fine += 1
        except ALLOWED as error:
            name = type(error).__name__
            raised[name] = raised.get(name, 0) + 1
            assert "mistake in hypedc" not in str(error), (target, arguments, keywords, error)
    print(fine, raised, file=sys.stderr)
    assert fine > CALLS // 100 and {"TypeError", "ValueError", "QuestionError"} <= set(raised)
    # All of them still work.
    run = hyped.Simulator(programs[0])
    run.step("up", count=30)
    assert run["ball.mode"] == "fly"


def test_states_of_random_bytes_are_refused_or_run() -> None:
    rng = random.Random(5)
    program = hyped.compile("examples/mario.hyped")
    run = hyped.Simulator(program)
    run.run("right*40 right+jump*20")
    good = run.save()
    ran = 0
    for _ in range(CALLS // 10):
        bad = bytearray(good)
        for _ in range(rng.randint(1, 3)):
            bad[rng.randrange(len(bad))] = rng.randrange(256)
        try:
            run.restore(bytes(bad))
            run.step("right+jump", count=3)
            ran += 1
        except (hyped.QuestionError, hyped.StepError):
            pass
    assert 0 < ran < CALLS // 10
