"""Batches: equal to single runs, for any number of threads; observations, resets, ends."""

from __future__ import annotations

import gc
import threading
import tracemalloc

import numpy as np
import pytest

import hyped
from conftest import BALL

WORLDS = ["examples/paper/test1.hyped", "examples/mario.hyped", "examples/asteroids.hyped", "examples/pong.hyped"]


def actions_of(batch: hyped.Batch, rng: np.random.Generator) -> np.ndarray:
    buttons = (rng.random(batch.shape) < 0.4).astype(np.float32)
    return np.where(rng.random(batch.shape) < 0.1, -1.0, buttons).astype(np.float32)


def observations(batch: hyped.Batch, dtype: type = np.float32) -> list[np.ndarray]:
    return [np.zeros(shape, dtype) for shape in batch.observation_shapes]


@pytest.mark.parametrize("path", WORLDS)
def test_rows_are_single_runs(path: str) -> None:
    program = hyped.compile(path)
    names = [name for name in program.world().names if not name.startswith("never.")][:40]
    batch = hyped.Batch(program, 64, observe=hyped.Variables(names), goals=[], nevers=[], seed=5)
    runs = [hyped.Simulator(program, seed=5 + row) for row in range(64)]
    players = [number for number, _ in program.world().players]
    rng = np.random.default_rng(1)
    seen = np.zeros(batch.observation_shapes[0], np.float64)
    for _ in range(60):
        actions = actions_of(batch, rng)
        batch.step(actions, seen)
        for row in range(0, 64, 9):
            if runs[row].left is not None:
                continue
            inputs = {}
            for place, number in enumerate(players):
                own = [*program.world().buttons(number), *program.world().axes(number)]
                prefix = "" if number == min(players) else f"{number}:"
                inputs.update({prefix + name: float(actions[row, place, at]) for at, name in enumerate(own)})
            runs[row].step(inputs)
            assert batch.simulator(row).hash() == runs[row].hash()
            assert batch.save(row) == runs[row].save() and batch.steps[row] == runs[row].steps
            words = {name: program.world().words(name) for name in names}
            for name, number in zip(names, seen[row]):
                value = runs[row][name]
                if value is None:
                    assert number == 0
                elif isinstance(value, str):
                    known = words[name]
                    assert known is None or known[int(number)] == value
                else:
                    assert number == float(value)


@pytest.mark.parametrize("path", WORLDS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.uint8])
def test_any_number_of_threads_gives_the_same(path: str, dtype: type) -> None:
    program = hyped.compile(path)
    views = [hyped.Planes(9, 7), hyped.Variables(program.world().names[:8])]
    found = []
    for threads in (1, 2, 3, 7):
        batch = hyped.Batch(program, 300, observe=views, threads=threads, within=50, seed=9)
        assert batch.threads_used == threads
        rng, seen, status = np.random.default_rng(2), observations(batch, dtype), np.zeros(300, np.uint8)
        hashes = []
        for _ in range(120):
            batch.step(actions_of(batch, rng), seen, status, reset=True)
            hashes.append((batch.hash(), *(of.tobytes() for of in seen), status.tobytes()))
        found.append(hashes)
    assert found[0] == found[1] == found[2] == found[3]
    assert len(set(found[0])) > 60


def test_rows_end_and_begin_anew() -> None:
    batch = hyped.Batch(hyped.compile(BALL), 96, within=250)
    status, fly = np.zeros(96, np.uint8), np.zeros(batch.shape, np.bool_)
    ended = set()
    for step in range(400):
        # The first third falls, the second stays at its height, the last one rises to a rock that it does not pass.
        fly[32:64] = step % 2 == 0
        fly[64:] = step < 60 or step % 2 == 0
        batch.step(fly, status=status)
        assert (status == batch.status).all()
        ended |= set(zip(np.arange(96)[status > 0] // 32, status[status > 0].tolist()))
    assert ended == {(0, hyped.NEVER), (1, hyped.GOAL), (2, hyped.TIME_UP)}
    before = batch.hash()
    batch.step(fly, status=status)
    assert batch.hash() == before, "runs that have ended stay"
    assert batch.why(0) == "low" and batch.why(-1) is not None
    batch.reset(status == hyped.NEVER)
    assert batch.steps[:32].sum() == 0 and batch.steps[32:].min() > 100 and batch.status[:32].sum() == 0
    assert batch.seeds[:32].tolist() == list(range(96, 128)) and batch.seeds[32] == 32
    batch.reset()
    assert batch.steps.sum() == 0
    batch.reset(seed=7)
    assert batch.seeds.tolist() == list(range(7, 103))


def test_states_move_between_rows_and_simulators() -> None:
    program = hyped.compile("examples/mario.hyped")
    batch, run = hyped.Batch(program, 40), hyped.Simulator(program)
    run.run("right*60 right+jump*10")
    batch.restore(3, run.save(), steps=70)
    assert batch.simulator(3).hash() == run.hash() and batch.steps[3] == 70
    assert batch.simulator(2).hash() == hyped.Simulator(program).hash()
    for row in (40, -41):
        with pytest.raises(IndexError):
            batch.save(row)


def test_planes_show_what_is_around() -> None:
    program = hyped.compile(BALL)
    batch = hyped.Batch(program, 32, observe=hyped.Planes(5, 3, tags=["rock"], entities=["Ball"]))
    (seen,) = observations(batch, np.uint8)
    assert seen.shape == (32, 2, 3, 5)
    batch.observe(seen)
    # The ball is at (0, 24): column 0, row 1 from below, and reaches into row 2; below it is rock.
    assert seen[0, 0].tolist() == [[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 1, 1, 1]]
    assert seen[0, 1].tolist() == [[0, 0, 1, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0]]
    run = batch.simulator(0)
    run["ball.x"], run["ball.y"] = 150, 32
    batch.restore(0, run.save())
    batch.observe(seen)
    assert seen[0, 0].tolist() == [[0, 0, 0, 1, 0], [0] * 5, [0] * 5]
    assert seen[0, 1].tolist() == [[0] * 5, [0, 0, 1, 1, 0], [0] * 5]
    assert seen[1, 0].sum() == 3


def test_broken_tiles_are_gone_from_planes() -> None:
    program = hyped.compile("examples/breakout.hyped")
    batch = hyped.Batch(program, 1, observe=hyped.Planes(64, 64), nevers=[], goals=[])
    (seen,) = observations(batch, np.uint8)
    batch.observe(seen)
    before = int(seen.sum())
    with open("examples/inputs/breakout.inputs", encoding="utf-8") as file:
        run = batch.simulator(0)
        run.run(file.read())
    batch.restore(0, run.save())
    batch.observe(seen)
    assert int(seen.sum()) < before


def test_arrays_that_do_not_fit_are_refused() -> None:
    batch = hyped.Batch(hyped.compile(BALL), 64, observe=hyped.Variables(["ball.x"]))
    good, out = np.zeros((64, 1, 1), np.float32), np.zeros((64, 1), np.float32)
    batch.step(good[:, :, 0], out)
    bad_actions = [good[:-1], np.zeros((64, 2), np.float32), np.zeros((128, 1, 1), np.float32)[::2], good.tolist()]
    bad_actions += [good.astype(np.int64), good.astype(object), None, "up"]
    for actions in bad_actions:
        with pytest.raises((ValueError, TypeError)):
            batch.step(actions, out)
    frozen = out.copy()
    frozen.flags.writeable = False
    for outputs in (out[:-1], out.T, out.astype(np.int32), frozen, [out, out], [], 3):
        with pytest.raises((ValueError, TypeError)):
            batch.step(good, outputs)
    shared = np.zeros((64, 1), np.float32)
    with pytest.raises(ValueError, match="cannot be used"):
        batch.step(shared, shared)
    for status in (np.zeros(64, np.int8), np.zeros(63, np.uint8), np.zeros(64, np.float32)):
        with pytest.raises((ValueError, TypeError)):
            batch.step(good, out, status)
    assert batch.steps.tolist() == [1] * 64


def test_impossible_batches_are_refused() -> None:
    program = hyped.compile(BALL)
    for wrong in (
        {"n": 0},
        {"n": 1 << 60},
        {"n": 4, "threads": 0},
        {"n": 4, "goals": ["fra"]},
        {"n": 4, "nevers": ["x"]},
    ):
        with pytest.raises(hyped.QuestionError):
            hyped.Batch(program, **wrong)  # type: ignore[arg-type]
    for view in (hyped.Variables(["ball.q"]), hyped.Planes(3, 3, tags=["x"]), hyped.Planes(3, 3, player=2)):
        with pytest.raises(hyped.QuestionError):
            hyped.Batch(program, 4, observe=view)
    with pytest.raises(hyped.QuestionError, match="far"):
        hyped.Batch(program, 4, goals=["fra"])


def test_a_step_of_a_batch_makes_no_python_objects_per_row() -> None:
    batch = hyped.Batch(hyped.compile("examples/mario.hyped"), 2048, observe=hyped.Variables(["hero.x"]), threads=2)
    actions, out = np.zeros(batch.shape, np.float32), np.zeros((2048, 1), np.float32)
    batch.step(actions, out)
    gc.collect()
    tracemalloc.start()
    for _ in range(50):
        batch.step(actions, out)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 16_384


def test_the_gil_is_free_during_a_step() -> None:
    batch = hyped.Batch(hyped.compile("examples/mario.hyped"), 4096, threads=1)
    actions, counted, is_over = np.zeros(batch.shape, np.float32), [0], threading.Event()

    def count() -> None:
        while not is_over.is_set():
            counted[0] += 1

    other = threading.Thread(target=count)
    other.start()
    for _ in range(20):
        batch.step(actions)
    is_over.set()
    other.join()
    assert counted[0] > 1000


def test_two_threads_cannot_step_one_batch() -> None:
    batch = hyped.Batch(hyped.compile("examples/mario.hyped"), 8192, threads=1)
    actions, errors = np.zeros(batch.shape, np.float32), []

    def step() -> None:
        for _ in range(40):
            try:
                batch.step(actions)
            except RuntimeError as error:
                errors.append(error)

    threads = [threading.Thread(target=step) for _ in range(2)]
    for of in threads:
        of.start()
    for of in threads:
        of.join()
    assert len(batch) == 8192
    assert int(batch.steps.max()) + len(errors) <= 80
