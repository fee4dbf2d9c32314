"""PettingZoo: its own checker, goals of players, determinism."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

import hyped
from hyped.parallel import LevelParallelEnv

PONG = "examples/pong.hyped"


@pytest.mark.parametrize("actions", ["multi", "discrete", "box"])
@pytest.mark.parametrize("observe", [None, lambda number: hyped.Planes(7, 7, player=number)])
def test_the_checkers_of_pettingzoo_pass(actions: str, observe: object) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(LevelParallelEnv(PONG, within=80, actions=actions, observe=observe), num_cycles=300)
        parallel_seed_test(lambda: LevelParallelEnv(PONG, within=80, actions=actions, observe=observe))


def test_players_have_their_own_goals() -> None:
    goals = {1: "ball.left == 1", 2: "ball.right\n==\n1"}
    env = LevelParallelEnv(PONG, goals, reward={"goal": 1.0, "end": -1.0})
    rng, won = np.random.default_rng(1), set()
    for seed in range(12):
        env.reset(seed=seed)
        total = dict.fromkeys(env.agents, 0.0)
        while env.agents:
            acts = {agent: rng.integers(0, env.action_space(agent).nvec) for agent in env.agents}
            # One of them holds everything down, and is in no good place then.
            acts[env.agents[seed % 2]] = env.action_space(env.agents[seed % 2]).nvec - 1
            _, rewards, terminated, _, infos = env.step(acts)
            for agent, reward in rewards.items():
                total[agent] += reward
        assert terminated == {"player_1": True, "player_2": True}
        assert sorted(total.values()) == [-1.0, 1.0] and infos["player_1"]["status"] == hyped.GOAL
        assert infos["player_1"]["why"] == ("ball.left == 1" if total["player_1"] == 1.0 else "ball.right == 1")
        won.add(total["player_1"])
    assert won == {-1.0, 1.0}
    assert env.step({}) == ({}, {}, {}, {}, {})
