"""Gymnasium: its own checkers, rewards, ends, the native vector environment."""

from __future__ import annotations

import os
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import hyped
from conftest import BALL
from hyped.env import LevelEnv, LevelVectorEnv

MARIO = "examples/mario.hyped"


@pytest.mark.parametrize("actions", ["multi", "discrete", "box"])
@pytest.mark.parametrize(
    "observe", [None, hyped.Planes(9, 9), {"tiles": hyped.Planes(5, 5), "self": hyped.Variables(["hero.x"])}]
)
def test_the_checker_of_gymnasium_passes(actions: str, observe: object) -> None:
    env = gymnasium.make(
        "hyped/Level-v0", file=MARIO, within=50, actions=actions, observe=observe, render_mode="rgb_array"
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Positions have no bounds.
        warnings.filterwarnings("ignore", message=".*Box observation space.*")
        check_env(env.unwrapped)


def test_an_episode_ends_at_the_goal_and_by_a_never() -> None:
    env = gymnasium.make(
        "hyped/Level-v0", file=BALL, reward={"goal": 5.0, "end": -2.0, "step": -0.5}, actions="discrete"
    )
    for choose, expected in ((lambda y: int(y < 24), 4.5), (lambda y: 0, -2.5)):
        (_, y, *_), _ = env.reset(seed=3)
        total, terminated = 0.0, False
        while not terminated:
            observation, reward, terminated, truncated, info = env.step(choose(env.unwrapped.simulator()["ball.y"]))
            total += float(reward) + 0.5 * (not terminated)
            assert not truncated
        assert total == pytest.approx(expected)
        assert info["why"] in ("far", "low")


def test_within_truncates_and_progress_is_rewarded() -> None:
    env = LevelEnv(BALL, "ball.x > 10000", within=30, reward={"progress": 2.0, "of": "ball.x"}, observe=["ball.x"])
    start, _ = env.reset()
    rewards = []
    while True:
        observation, reward, terminated, truncated, info = env.step(np.array([1]))
        rewards.append(reward)
        if terminated or truncated:
            break
    assert (terminated, truncated, len(rewards)) == (False, True, 30)
    assert sum(rewards) == pytest.approx(2.0 * (observation[0] - start[0]), rel=1e-5)
    assert info["status"] == hyped.TIME_UP


def test_an_episode_can_begin_in_a_saved_state() -> None:
    env = LevelEnv(BALL, observe=["ball.x", "ball.y"])
    run = hyped.Simulator(hyped.compile(BALL))
    run.step("up", count=20)
    observation, _ = env.reset(options={"state": run.save(), "steps": 20})
    assert observation.tolist() == [np.float32(run["ball.x"]), np.float32(run["ball.y"])]


def test_pictures_and_windows() -> None:
    env = LevelEnv(BALL, render_mode="rgb_array")
    env.reset()
    assert env.render().ndim == 3
    with pytest.raises(gymnasium.error.Error):
        LevelEnv(BALL, render_mode="ansi")
    os.environ["SDL_VIDEODRIVER"] = "dummy"
    shown = LevelEnv(BALL, render_mode="human")
    shown.reset()
    for _ in range(3):
        shown.step(np.array([1]))
    assert shown._window is not None and shown._window.screen is not None
    shown.close()


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_the_vector_environment_is_that_of_gymnasium(mode: AutoresetMode) -> None:
    options = dict(
        file=BALL, within=40, observe=["ball.x", "ball.y"], reward={"end": -1.0, "progress": 0.1, "of": "ball.x"}
    )
    native = gymnasium.make_vec(
        "hyped/Level-v0", num_envs=37, vector_kwargs=None, autoreset_mode=mode, threads=2, **options
    )
    assert isinstance(native.unwrapped, LevelVectorEnv) and native.metadata["autoreset_mode"] == mode
    sync = gymnasium.make_vec(
        "hyped/Level-v0", num_envs=37, vectorization_mode="sync", vector_kwargs={"autoreset_mode": mode}, **options
    )
    assert native.observation_space == sync.observation_space and native.action_space == sync.action_space
    ours, theirs = native.reset(seed=1)[0], sync.reset(seed=1)[0]
    assert (ours == theirs).all()
    native.action_space.seed(4)
    ends = 0
    for _ in range(200):
        actions = native.action_space.sample()
        ours, theirs = native.step(actions), sync.step(actions)
        for a, b in zip(ours[:4], theirs[:4]):
            np.testing.assert_allclose(a, b, rtol=1e-6)
        if mode == AutoresetMode.SAME_STEP and "final_obs" in ours[4]:
            for row in np.flatnonzero(ours[4]["_final_obs"]):
                np.testing.assert_allclose(ours[4]["final_obs"][row], theirs[4]["final_obs"][row])
        ends += int((ours[2] | ours[3]).sum())
        assert ours[0] in native.observation_space
    assert ends > 50
    sync.close()
    native.close()


def test_disabled_autoreset_waits_for_the_caller() -> None:
    envs = LevelVectorEnv(33, BALL, within=20, autoreset_mode="Disabled", copy=False, render_mode="rgb_array")
    first, _ = envs.reset(seed=2)
    for _ in range(30):
        seen, rewards, terminated, truncated, _ = envs.step(np.ones((33, 1), np.int64))
    assert seen is first and truncated.all() and not rewards.any()
    envs.reset(options={"reset_mask": np.arange(33) < 3})
    assert envs.runs.batch.steps.tolist() == [0] * 3 + [20] * 30
    assert len(envs.render() or ()) == 33


def test_wrong_arguments() -> None:
    for options in (
        {"actions": "some"},
        {"player": 2},
        {"observe": 3},
        {"reward": {"progress": 1.0}},
        {"goal": "ball.q > 1"},
    ):
        with pytest.raises(hyped.HypedError):
            LevelEnv(BALL, **options)  # type: ignore[arg-type]
    env = LevelEnv(BALL, actions="discrete")
    env.reset()
    for action in (2, -1, 0.5, [0, 1]):
        with pytest.raises(hyped.QuestionError):
            env.step(action)
    pickle.loads(pickle.dumps(hyped.Planes(3, 3)))
