"""Levels judged for a generator: features, caches, executors."""

from __future__ import annotations

import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hyped
from hyped.generate import Features, FolderCache, evaluate

OPEN = """
entity Runner {
    button jump
    x' = 80
    collider body: rect(0, 0, 16, 16)
    mode ground {
        y' = 0
        when pressed(jump) -> air
        when not touching(body, rock, below) -> fall
    }
    mode air {
        y' = 100
        when timer(air) > 0.4 -> fall
    }
    initial mode fall {
        y' = -100
        when touching(body, rock, below) -> ground
    }
}
world Run {
    collide body with rock: block
    tiles land 16 x 16 { '.': empty; '#': rock }
    space main {
        bounds rect(0, 0, 320, 200)
        map level land
        place runner: Runner at (0, 16)
    }
    player 1: runner
    goal far: runner.x > 250
    never low: runner.y < 4
}
"""
FLAT = ["." * 20] * 5 + ["#" * 20]
GAP = ["." * 20] * 5 + ["#" * 8 + "." * 3 + "#" * 9]
CHASM = ["." * 20] * 5 + ["#" * 8 + "." * 12]
WRONG = ["." * 20] * 5 + ["?" * 20]


class Counting(Executor):
    """Counts tasks, and does them at once."""

    def __init__(self) -> None:
        self.tasks = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.tasks += 1
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@pytest.fixture(scope="module")
def program() -> hyped.Program:
    return hyped.compile(OPEN)


def test_features_tell_levels_apart(program: hyped.Program) -> None:
    found = evaluate(program, [FLAT, GAP, CHASM, WRONG], sigma=4.0, trials=200, nodes=20_000)
    assert [of["far"].verdict for of in found[:2]] == ["reached", "reached"]
    assert found[2]["far"].verdict in ("not-found", "proven-unreachable", "exhausted")
    (error,) = found[3].values()
    assert error.verdict == "error" and "?" in (error.error or "")
    flat, gap = found[0]["far"], found[1]["far"]
    assert flat.success == 1.0 and gap.success is not None and 0.0 < gap.success < 1.0 and (gap.presses or 0) > 1
    array = gap.array()
    assert array.shape == (len(Features.NAMES),) and array[0] == 1.0 and array[2] == gap.steps
    assert np.isnan(found[2]["far"].array()[2])


def test_equal_levels_are_judged_once(program: hyped.Program, tmp_path: Path) -> None:
    executor = Counting()
    first = evaluate(program, [FLAT, CHASM, FLAT, "\n".join(FLAT) + "\n"], executor=executor, cache=tmp_path)
    assert executor.tasks == 2 and first[0] == first[2] == first[3] != first[1]
    assert evaluate(program, [CHASM, FLAT], executor=executor, cache=tmp_path) == [first[1], first[0]]
    assert executor.tasks == 2 and len(FolderCache(tmp_path)) == 2
    evaluate(program, [GAP], executor=executor, cache=tmp_path, seed=2)
    assert executor.tasks == 3
    other = hyped.compile(OPEN.replace("x' = 80", "x' = 90"))
    evaluate(other, [GAP], executor=executor, cache=tmp_path)
    assert executor.tasks == 4
    kept: dict[str, str] = {}
    evaluate(program, [GAP], executor=executor, cache=kept)
    assert executor.tasks == 5 and len(kept) == 1


def test_executors_give_the_same(program: hyped.Program, tmp_path: Path) -> None:
    levels: list[Any] = [FLAT, GAP, CHASM]
    path = tmp_path / "gap.txt"
    path.write_text("\n".join(GAP), encoding="utf-8")
    levels.append(path)
    alone = evaluate(program, levels, ["far", "runner.x > 100"])
    assert set(alone[0]) == {"far", "runner.x > 100"} and alone[1] == alone[3]
    with ProcessPoolExecutor(2) as processes, ThreadPoolExecutor(2) as threads:
        assert evaluate(program, levels, ["far", "runner.x > 100"], executor=processes) == alone
        assert evaluate(program, levels, ["far", "runner.x > 100"], executor=threads) == alone


def test_a_changed_file_is_judged_again(program: hyped.Program, tmp_path: Path) -> None:
    path, kept = tmp_path / "level.txt", {}  # type: tuple[Path, dict[str, str]]
    found = []
    for level in (FLAT, CHASM):
        path.write_text("\n".join(level), encoding="utf-8")
        found.append(evaluate(program, [path], cache=kept)[0]["far"].verdict)
    assert found[0] == "reached" != found[1] and len(kept) == 2


def test_wrong_options(program: hyped.Program) -> None:
    for options in ({"nodes": object()}, {"planner": {1}}):
        with pytest.raises(hyped.QuestionError):
            evaluate(program, [FLAT], **options)
    with pytest.raises(TypeError):
        evaluate(program, [FLAT], depth=3)
    with pytest.raises(hyped.QuestionError):
        evaluate("program", [FLAT])  # type: ignore[arg-type]


def test_a_batch_goes_on_in_a_forked_process() -> None:
    import os

    batch = hyped.Batch(hyped.compile("examples/mario.hyped"), 256, threads=2)
    actions = np.zeros(batch.shape, np.float32)
    batch.step(actions)
    child = os.fork()
    if child == 0:
        batch.step(actions)
        os._exit(int(batch.steps.sum() != 512))
    began = time.monotonic()
    while (ended := os.waitpid(child, os.WNOHANG))[0] == 0:
        assert time.monotonic() - began < 30, "the child hangs"
        time.sleep(0.01)
    assert ended[1] == 0
