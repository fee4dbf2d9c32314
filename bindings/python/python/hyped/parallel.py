"""Environments of PettingZoo: all players of a world at once, each with an agent of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from pettingzoo import ParallelEnv

from hyped import _hyped
from hyped._ask import Level, Source, compile
from hyped._spaces import Actions, Observations, Reward, Window, is_terminated, is_truncated
from hyped._status import GOAL, RUNNING

__all__ = ["LevelParallelEnv", "Reward"]


class LevelParallelEnv(ParallelEnv[str, Any, Any]):
    """All players of a world: agent ``player_1`` is player 1, and so on.

    Args are those of ``hyped.env.LevelEnv``; ``observe`` may also be a function from the number of a player to what it
    observes, and ``goals`` gives each player a goal of its own, ``{1: "left_wins", 2: "right_wins"}``: its reward is
    ``reward.goal`` where that is reached and ``reward.end`` where the episode ends otherwise. Without ``goals``, all
    goals are of all players. An episode ends for all players at once.
    """

    metadata = {"name": "hyped_level_v0", "render_modes": ["rgb_array", "human"], "render_fps": 60}

    def __init__(
        self,
        file: Source | _hyped.Program,
        goals: Mapping[int, str] | None = None,
        *,
        level: Level | None = None,
        params: Mapping[str, float | str] | None = None,
        world: str | None = None,
        within: int | None = None,
        observe: Any = None,
        actions: str = "multi",
        reward: Reward | Mapping[str, Any] | None = None,
        seed: int = 0,
        render_mode: str | None = None,
    ) -> None:
        program = file if isinstance(file, _hyped.Program) else compile(file, level=level, params=params)
        if goals:
            program = program._asking(list(dict.fromkeys(goals.values())), [], None, world)
        self.program = program
        self.world = program.world(world)
        self.numbers = [number for number, _ in self.world.players]
        self.possible_agents = [f"player_{number}" for number in self.numbers]
        self.agents: list[str] = []
        self.goals = {number: _hyped._question_name(goal) for number, goal in (goals or {}).items()}
        self.reward = reward if isinstance(reward, Reward) else Reward(**dict(reward or {}))
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self.world.step)}
        self._actions = [Actions(self.world, number, actions) for number in self.numbers]
        of = [observe(number) if callable(observe) else observe for number in self.numbers]
        self._views: list[Observations] = [Observations(self.world, n, o) for n, o in zip(self.numbers, of)]
        # Each player has a batch of its own to look at the one that is stepped.
        ends = list(dict.fromkeys(self.goals.values())) or None
        self._batch = _hyped.Batch(program, 1, world=world, goals=ends, within=within, seed=seed, threads=1)
        self._eyes = [
            _hyped.Batch(program, 1, world=world, observe=list(view.views.values()), goals=[], nevers=[], threads=1)
            for view in self._views
        ]
        self._arrays = [view.arrays(eye.observation_shapes) for view, eye in zip(self._views, self._eyes)]
        spaces = [view.space(eye.observation_shapes) for view, eye in zip(self._views, self._eyes)]
        self.observation_spaces = dict(zip(self.possible_agents, spaces))
        self.action_spaces = {agent: of.space for agent, of in zip(self.possible_agents, self._actions)}
        self._inputs = np.zeros(self._batch.shape, np.float32)
        self._status = np.zeros(1, np.uint8)
        self._window: Window | None = None
        self.np_random, _ = seeding.np_random(seed)

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        return self.action_spaces[agent]

    def _observations(self) -> dict[str, Any]:
        state, found = self._batch.save(0), {}
        for agent, view, eye, arrays in zip(self.possible_agents, self._views, self._eyes, self._arrays):
            eye.restore(0, state)
            eye.observe(arrays)
            found[agent] = view.give(arrays, 0)
        return found

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        if seed is not None:
            self.np_random, _ = seeding.np_random(seed)
        self._batch.reset(seed=seed)
        self._batch.observe(status=self._status)
        self.agents = list(self.possible_agents)
        if self.render_mode == "human":
            self.render()
        return self._observations(), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        if not self.agents:
            return {}, {}, {}, {}, {}
        self._inputs.fill(0.0)
        for place, (agent, of) in enumerate(zip(self.possible_agents, self._actions)):
            if agent in actions:
                of.write(np.asarray(actions[agent])[np.newaxis], self._inputs[:, place, :])
        self._batch.step(self._inputs, None, self._status)
        terminated, truncated = bool(is_terminated(self._status)[0]), bool(is_truncated(self._status)[0])
        why = self._batch.why(0) if self._status[0] != RUNNING else None
        rewards = {agent: self._reward(number, why) for agent, number in zip(self.agents, self.numbers)}
        agents = self.agents
        info: dict[str, Any] = {} if why is None else {"status": int(self._status[0]), "why": why}
        if terminated or truncated:
            self.agents = []
        if self.render_mode == "human":
            self.render()
        each = {agent: dict(info) for agent in agents}
        return self._observations(), rewards, dict.fromkeys(agents, terminated), dict.fromkeys(agents, truncated), each

    def _reward(self, number: int, why: str | None) -> float:
        status = self._status[0]
        if status == GOAL and (not self.goals or self.goals.get(number) == why):
            return self.reward.goal + self.reward.step
        is_over = bool(is_terminated(self._status)[0])
        return (self.reward.end if is_over else 0.0) + self.reward.step

    def simulator(self) -> _hyped.Simulator:
        """The run as a simulator of its own."""
        return self._batch.simulator(0)

    def render(self) -> Any:
        if self.render_mode is None:
            return None
        picture = self.simulator().render()
        if self.render_mode == "rgb_array":
            return picture
        if self._window is None:
            self._window = Window(self.world.name, self.world.step)
        self._window.show(picture)
        return None

    def close(self) -> None:
        if self._window is not None:
            self._window.close()
