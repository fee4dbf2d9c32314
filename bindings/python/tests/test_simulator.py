"""Running worlds: names, inputs, events, states, pictures."""

from __future__ import annotations

import numpy as np
import pytest

import hyped
from conftest import BALL


@pytest.fixture
def run() -> hyped.Simulator:
    return hyped.Simulator(hyped.compile(BALL))


def test_the_world_tells_its_names(run: hyped.Simulator) -> None:
    world = run.world
    assert (world.name, world.step, world.players) == ("Sky", pytest.approx(1 / 60), [(1, "ball")])
    assert (world.goals, world.nevers, world.spaces) == (["far"], ["low"], ["main"])
    assert (world.buttons(), world.axes()) == (["up"], [])
    assert "ball.x'" in world.names and world.words("ball.mode") == ["fly", "fall"]
    assert world.tiles().shape == (4, 20) and world.tiles()[0, 10] == "#"


def test_parts_of_the_state_are_read_and_written(run: hyped.Simulator) -> None:
    assert (run["ball.mode"], run["ball in fall"], run["ball.alive"]) == ("fall", True, True)
    run["ball.x"] = 201.5
    run["ball.mode"] = "fly"
    assert (run["ball.x"], run["ball in fly"], run.goals) == (201.5, True, ["far"])
    run["ball.y"] = 2
    assert run.nevers == ["low"] and run["never.low"] is True
    for name, value in (("ball.x", float("nan")), ("ball.mode", "swim"), ("ball.x", "far"), ("ball.alive", False)):
        before = run.hash()
        with pytest.raises(hyped.QuestionError):
            run[name] = value
        assert run.hash() == before
    with pytest.raises(KeyError, match="ball.x") as caught:
        run["ball.xx"]
    # It prints as other errors do, where KeyError shows line breaks as \n.
    assert isinstance(caught.value, hyped.UnknownNameError) and "\\n" not in str(caught.value)


def test_inputs_have_several_forms(run: hyped.Simulator) -> None:
    runs = [run.copy() for _ in range(4)]
    runs[0].step("up", count=10)
    runs[1].step({"up": True}, count=10)
    runs[2].run("up*4 up*6")
    for _ in range(10):
        runs[3].step({"up": 1.0})
    assert len({of.hash() for of in runs}) == 1 and runs[0].hash() != run.hash()
    for wrong in ({"down": 1}, {"2:up": 1}, "jump", "up*3", ["up"], {"up": "yes"}, {"up": float("nan")}):
        with pytest.raises((hyped.QuestionError, TypeError)):
            run.step(wrong)  # type: ignore[arg-type]
    assert run.steps == 0


def test_events_are_told(run: hyped.Simulator) -> None:
    events = run.step_with_events("up")
    assert [(of.kind, of.instance, of.what) for of in events if of.kind == "edge"] == [("edge", "ball", "fly")]
    seen = []
    while not run.goals:
        seen += run.step_with_events("up" if run["ball.y"] < 24 else None)
    assert [of.what for of in seen if of.kind == "goal"] == ["far"]


def test_states_are_saved(run: hyped.Simulator) -> None:
    run.step("up", count=20)
    saved, at = run.save(), run.hash()
    run.step(count=5)
    run.restore(saved, steps=20)
    assert (run.hash(), run.steps, run.time) == (at, 20, pytest.approx(20 / 60))
    other = hyped.Simulator(hyped.compile(BALL.replace("y' = 30", "y' = 40")))
    other.restore(saved)
    assert other.hash() == at
    for wrong in (b"", saved[:-1], saved + b"\0", b"x" * len(saved)):
        with pytest.raises(hyped.QuestionError):
            run.restore(wrong)
    run.reset()
    assert run.steps == 0 and run.hash() == hyped.Simulator(run.program).hash()


def test_a_broken_rule_leaves_the_state() -> None:
    text = "entity A { param k: px/s = 1000; x' = k * x / (32 - x) }"
    text += " world W { space s { place a: A at (32, 0) } player 1: a }"
    run = hyped.Simulator(hyped.compile(text))
    before = run.hash()
    with pytest.raises(hyped.StepError, match="division by zero") as caught:
        run.step()
    assert "<text>:1:" in str(caught.value)
    assert (run.hash(), run.steps) == (before, 0)
    batch = hyped.Batch(run.program, 3)
    batch.step(np.zeros(batch.shape, np.float32))
    assert batch.status.tolist() == [hyped.FAULT] * 3 and "division by zero" in (batch.why(0) or "")


def test_seeds_decide_what_is_drawn() -> None:
    program = hyped.compile("examples/asteroids.hyped")
    runs = [hyped.Simulator(program, seed=seed) for seed in (1, 1, 2)]
    for of in runs:
        of.step(count=200)
    assert runs[0].hash() == runs[1].hash()


def test_pictures(run: hyped.Simulator) -> None:
    first = run.render()
    assert first.dtype == np.uint8 and first.shape == run.picture_shape() and len(np.unique(first)) > 2
    run.step("up", count=60)
    second = run.render()
    assert second.shape == first.shape and (second != first).any()
    assert run.render(scale=1).shape == run.picture_shape(scale=1)
    assert run._repr_svg_().startswith("<svg") and run.world._repr_svg_().startswith("<svg")


def test_traces_are_arrays(run: hyped.Simulator) -> None:
    found = hyped.trace(run.program, "up*20 -*10")
    assert found["ball.x"].shape == (31,) and found.inputs.shape == (30, 1, 1)
    assert found.inputs[:, 0, 0].tolist() == [1.0] * 20 + [0.0] * 10
    assert found["ball.mode"][0] == "fall" and found["ball.mode"][20] == "fly"
    for step in range(31):
        assert run["ball.y"] == found["ball.y"][step]
        run.step("up" if step < 20 else None)
    short = hyped.trace(run.program, "-*600", names=["ball.y"])
    assert short.end is not None and "bounds" in short.end
    with pytest.raises(hyped.QuestionError):
        hyped.trace(run.program, "-*100000000")
