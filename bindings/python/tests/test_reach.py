"""Questions: answers equal those of the command line, witnesses replay, searches can be stopped."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time

import numpy as np
import pytest

import hyped
from conftest import BALL

LINK, HARD = "examples/link.hyped", "treasure"
"""A goal that a simple planner does not find in minutes."""
TIMES = ("seconds", "analysis_seconds", "growth", "tree", "file")


def plain(record: dict) -> dict:  # type: ignore[type-arg]
    """A record without what depends on the machine."""
    kept = {name: of for name, of in record.items() if name not in TIMES}
    if "goals" in kept:
        kept["goals"] = [plain(goal) for goal in kept["goals"]]
    return kept


@pytest.mark.parametrize(
    ("path", "options", "arguments"),
    [
        ("examples/paper/test1.hyped", {}, []),
        (
            "examples/balloon.hyped",
            {"goals": "balloon.x > 300", "seed": 4},
            ["--goal", "balloon.x > 300", "--seed", "4"],
        ),
        (
            "examples/sokoban.hyped",
            {"planner": "exhaustive", "world": "First"},
            ["--planner", "exhaustive", "--world", "First"],
        ),
        ("examples/switch_door.hyped", {"nodes": 3000, "trees": 2}, ["--nodes", "3000", "--trees", "2"]),
        (
            "examples/balloon.hyped",
            {"without": "balloon.y > 600", "within": 400},
            ["--without", "balloon.y > 600", "--within", "400frames"],
        ),
    ],
)
def test_answers_are_those_of_the_command_line(path: str, options: dict, arguments: list[str], hypedc: str) -> None:  # type: ignore[type-arg]
    found = hyped.reach(hyped.compile(path), **options)
    shown = subprocess.run(
        [hypedc, "reach", path, *arguments, "--format", "json"], capture_output=True, text=True, check=False
    )
    assert plain(found.record) == plain(json.loads(shown.stdout))


def test_witnesses_replay() -> None:
    program = hyped.compile("examples/paper/test1.hyped")
    found = hyped.reach(program)
    answer = found["arrive"]
    assert found and answer and answer.verdict == "reached" and answer.witness is not None
    way = answer.witness
    run = way.simulator()
    assert run.goals == ["arrive"] and run.steps == way.steps == answer.steps
    batch = hyped.Batch(program, 32)
    for action in way.actions:
        assert batch.status.sum() == 0
        batch.step(np.ascontiguousarray(np.broadcast_to(action, batch.shape)))
    assert batch.status.tolist() == [hyped.GOAL] * 32
    assert len(way.trace()["hero.x"]) == way.steps + 1
    assert way._repr_svg_().startswith("<svg") and answer._repr_svg_() == way._repr_svg_()
    again = hyped.reach(program, after=way.script, goals="hero.x < 400")
    assert again.answers[0].steps is not None and again.answers[0].steps > way.steps


def test_proofs_and_pictures() -> None:
    found = hyped.reach(hyped.compile(BALL), goals=["far", "ball.x > 1000"], svg=True)
    assert [of.verdict for of in found.answers] == ["reached", "proven-unreachable"]
    assert found["ball.x > 1000"].reasons and not found
    assert all(of.svg and of.svg.startswith("<svg") for of in found.answers)
    with pytest.raises(KeyError, match="far"):
        found["near"]


def test_nevers_are_broken() -> None:
    found = hyped.reach(hyped.compile(BALL), nevers=["low", "ball.y > 40"])
    assert [of.verdict for of in found.answers] == ["violated", "violated"]
    assert found["low"].witness is not None and found["low"].witness.simulator().nevers == ["low"]


def test_jitter_is_measured() -> None:
    answer = hyped.reach(hyped.compile("examples/balloon.hyped"), sigma=2.0, trials=200)["over"]
    assert 0.0 <= answer.record["robust"]["success"] <= 1.0 and answer.record["robust"]["trials"] == 200


def test_progress_is_told_and_its_exceptions_stop_the_search() -> None:
    program, told = hyped.compile(LINK), []
    hyped.reach(program, HARD, planner="rrt", seconds=0.4, progress=lambda *numbers: told.append(numbers))
    assert told and all(len(of) == 3 for of in told) and told[-1][0] > 0

    def fails(*_: int) -> None:
        raise RuntimeError("enough")

    began = time.monotonic()
    with pytest.raises(RuntimeError, match="enough"):
        hyped.reach(program, HARD, planner="rrt", seconds=60, progress=fails)
    assert time.monotonic() - began < 20


def test_keyboard_interrupt_stops_a_search_with_what_it_has() -> None:
    program = hyped.compile(LINK)
    # A job in the background of a shell ignores it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    found = hyped.reach(program, [HARD, "unlocked"], planner="rrt", seconds=120)
    assert time.monotonic() - began < 30
    assert len(found) == 1
    assert found.interrupted and found.answers[0].verdict == "not-found" and found.answers[0].nodes > 0


def test_other_threads_run_during_a_search() -> None:
    program, counted, is_over = hyped.compile(LINK), [0], threading.Event()

    def count() -> None:
        while not is_over.is_set():
            counted[0] += 1

    other = threading.Thread(target=count)
    other.start()
    hyped.reach(program, HARD, planner="rrt", seconds=0.3)
    is_over.set()
    other.join()
    assert counted[0] > 10_000


@pytest.mark.parametrize(
    "options",
    [
        {"goals": "fra"},
        {"goals": "ball.q > 1"},
        {"planner": "rrrt"},
        {"seconds": -1.0},
        {"seconds": float("nan")},
        {"trees": 0},
        {"threads": 1 << 40},
        {"after": "jump"},
        {"after": "-*600"},
        {"world": "Sea"},
        {"style": "slow"},
        {"sigma": 0.0},
        {"seed": -1},
        {"within": 1.5},
        {"goals": [3]},
    ],
)
def test_wrong_questions_are_refused(options: dict) -> None:  # type: ignore[type-arg]
    with pytest.raises((hyped.QuestionError, hyped.CompileError)):
        hyped.reach(hyped.compile(BALL), **options)


def test_why() -> None:
    program = hyped.compile(BALL)
    of_step = hyped.why(program, "-*5 up")
    assert of_step.step is not None and of_step.step["edges"]
    never = hyped.why(program, "-*20", mode="fly", never=True)
    assert never.nearly is not None and never.nearly["entered"] is None
    with pytest.raises(hyped.QuestionError, match="fly"):
        hyped.why(program, "-*20", mode="flyy")


def test_stuck_is_that_of_the_command_line(hypedc: str) -> None:
    found = hyped.stuck(hyped.compile("examples/sokoban.hyped"), world="First")
    command = [hypedc, "stuck", "examples/sokoban.hyped", "--world", "First", "--format", "json"]
    shown = subprocess.run(command, capture_output=True, text=True, check=False)
    assert plain(found.record) == plain(json.loads(shown.stdout))
    assert found.verdict == "stuck" and found.ways and not found.interrupted
    assert found.ways[0].simulator().steps == found.ways[0].steps
    with pytest.raises(hyped.QuestionError):
        hyped.stuck(hyped.compile(BALL), "nowhere")


def test_bounds_are_those_of_the_command_line(hypedc: str) -> None:
    found = hyped.bounds(hyped.compile("examples/mario.hyped"))
    shown = subprocess.run(
        [hypedc, "bounds", "examples/mario.hyped", "--format", "json"], capture_output=True, text=True, check=False
    )
    assert plain(found.record) == plain(json.loads(shown.stdout))
    low, high = found.interval("hero.x'")
    assert low < 0 < high
    with pytest.raises(KeyError):
        found.interval("hero.z")


def test_tuning() -> None:
    text = BALL.replace("x' = 60", "param pace = 10\n    x' = pace").replace(
        "goal far: ball.x > 200", "goal far: ball.x > 200 and ball.y > 30"
    )
    program = hyped.compile(text)
    found = hyped.tune(program, {"Ball.pace": (10, 100)}, within=300, nodes=4000)
    assert found.change is not None and 40 <= found.change["Ball.pace"] <= 45 and not found.is_wanted_already
    assert found.witness is not None and found.witness.simulator().goals == ["far"]
    assert found.values.shape == (len(found.verdicts), 1) and "reached" in found.verdicts
    fast = hyped.compile(text, params={"Ball.pace": 60})
    assert hyped.tune(fast, {"Ball.pace": (10, 100)}, within=300, nodes=4000).is_wanted_already
    kept = hyped.tune(fast, {"Ball.pace": (10, 100)}, prevent=True, within=300, nodes=4000)
    assert kept.change is not None and 38 < kept.change["Ball.pace"] < 41
    for wrong in ({}, {"Ball.pac": (1, 2)}, {"Ball.pace": (2, 1)}, {"Ball.pace": 3}, {"Ball.pace": ("a", "b")}):
        with pytest.raises(hyped.QuestionError):
            hyped.tune(program, wrong)


def test_what_is_covered_is_that_of_the_command_line(hypedc: str) -> None:
    for path, options, arguments in (
        ("examples/mario.hyped", {"nodes": 2000}, ["--nodes", "2000"]),
        ("examples/link.hyped", {"nodes": 1000, "seed": 3}, ["--nodes", "1000", "--seed", "3"]),
    ):
        found = hyped.explore(hyped.compile(path), **options)  # type: ignore[arg-type]
        command = [hypedc, "reach", path, "--explore", "--format", "json", *arguments]
        shown = subprocess.run(command, capture_output=True, text=True, check=False)
        assert plain(found.record) == plain(json.loads(shown.stdout))
        assert (
            0 < found.cells[0] < found.cells[1]
            and any(found.modes.values())
            and all(found.spaces)
            and not found.interrupted
        )
    died = hyped.explore(hyped.compile(BALL), nodes=500).broken["low"]
    assert died.simulator()["never.low"]
    with pytest.raises(hyped.QuestionError, match="planner"):
        hyped.explore(hyped.compile(BALL), planner="none")
