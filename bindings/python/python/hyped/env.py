"""Environments of Gymnasium: a player in a world, alone or in many runs at once.

>>> import gymnasium, hyped
>>> env = gymnasium.make("hyped/Level-v0", file=TEXT, goal="high", within=600, actions="discrete")
>>> observation, info = env.reset(seed=1)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
>>> envs = gymnasium.make_vec("hyped/Level-v0", num_envs=16, file=TEXT, goal="high", within=600)
>>> observations, infos = envs.reset(seed=1)
>>> observations.shape[0]
16
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import error
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from hyped import _hyped
from hyped._ask import Level, Source, compile
from hyped._errors import QuestionError
from hyped._spaces import Actions, Observations, Observe, Reward, Window, first_player, is_terminated, is_truncated
from hyped._status import GOAL, RUNNING

__all__ = ["LevelEnv", "LevelVectorEnv", "Reward"]


class _Runs:
    """Runs of a world for one player: a batch with its arrays."""

    def __init__(
        self,
        n: int,
        file: Source | _hyped.Program,
        goal: str | None,
        level: Level | None,
        params: Mapping[str, float | str] | None,
        world: str | None,
        player: int | None,
        within: int | None,
        observe: Observe,
        actions: str,
        reward: Reward | Mapping[str, Any] | None,
        seed: int,
        threads: int | None,
    ) -> None:
        program = file if isinstance(file, _hyped.Program) else compile(file, level=level, params=params)
        if goal is not None:
            program = program._asking([goal], [], None, world)
        self.program = program
        self.world = program.world(world)
        self.player = first_player(self.world, player)
        self.reward = reward if isinstance(reward, Reward) else Reward(**dict(reward or {}))
        self.actions = Actions(self.world, self.player, actions)
        self.observations = Observations(self.world, self.player, observe)
        views: list[_hyped.Variables | _hyped.Planes] = list(self.observations.views.values())
        if self.reward.of is not None:
            views.append(_hyped.Variables([self.reward.of]))
        goals = None if goal is None else [_hyped._question_name(goal)]
        self.batch = _hyped.Batch(
            program, n, world=world, observe=views, goals=goals, within=within, seed=seed, threads=threads
        )
        shapes = self.batch.observation_shapes
        self.space = self.observations.space(shapes)
        self.arrays = self.observations.arrays(shapes)
        self.progress = np.zeros((n, 1), np.float64)
        self.before = np.zeros((n, 1), np.float64)
        self.status = np.zeros(n, np.uint8)
        _, players, controls = self.batch.shape
        self.inputs = np.zeros((n, players, controls), np.float32)
        place = [number for number, _ in self.world.players].index(self.player)
        self.own = self.inputs[:, place, :]

    def all_arrays(self) -> list[npt.NDArray[Any]]:
        """The arrays that the batch writes to."""
        return [*self.arrays, self.progress] if self.reward.of is not None else self.arrays

    def begin(self, rows: npt.NDArray[np.bool_] | None, seed: int | None) -> None:
        """Begins anew, and observes."""
        self.batch.reset(rows, seed=seed)
        self.observe()

    def observe(self) -> None:
        """Observes, and measures progress from here."""
        self.batch.observe(self.all_arrays(), self.status)
        self.before[:] = self.progress

    def step(self, actions: npt.ArrayLike, reset: bool) -> npt.NDArray[np.float64]:
        """A step of all rows; returns rewards."""
        self.actions.write(actions, self.own)
        was_over = self.status != RUNNING
        self.batch.step(self.inputs, self.all_arrays(), self.status, reset=reset)
        of, ended = self.reward, is_terminated(self.status)
        rewards = np.where(self.status == GOAL, of.goal, np.where(ended, of.end, 0.0)) + of.step
        if of.of is not None:
            rewards += of.progress * (self.progress - self.before)[:, 0]
            self.before[:] = self.progress
        rewards[was_over] = 0.0
        return rewards


class LevelEnv(gymnasium.Env[Any, Any]):
    """A player in a world.

    Args:
        file: The program: a path, its text, or a ``Program``.
        goal: The goal that ends an episode, as a name or a predicate such as ``"hero.x > 300"``; all goals by default.
        level: The level of a program with an open map, see ``hyped.compile``.
        params: Numbers of the program that are set.
        world: The world, where the program has several.
        player: The number of the player; the others do nothing. The one with the lowest number by default.
        within: Maximum number of steps of an episode: then it is truncated.
        observe: ``Variables``, ``Planes``, names of parts of the state, or a dict of these. By default the modes and
            variables of the player's instance, in px and px/s. Variables are float32, planes uint8.
        actions: ``"multi"``, ``"discrete"`` or ``"box"``, see ``hyped._spaces.Actions``.
        reward: A ``Reward``, or a dict of its fields: by default 1 at the goal and 0 elsewhere.
        seed: The seed of what nature draws, until ``reset(seed=…)`` gives another.
        render_mode: ``"rgb_array"``, or ``"human"`` for a window (needs pygame).

    An episode ends by a goal, a ``never``, outside of the bounds, or by a run-time error of the program (reported in
    ``info["why"]``). ``reset(options={"state": …})`` begins in a state of ``Simulator.save``.
    """

    metadata = {"render_modes": ["rgb_array", "human"], "render_fps": 60}

    def __init__(
        self,
        file: Source | _hyped.Program,
        goal: str | None = None,
        *,
        level: Level | None = None,
        params: Mapping[str, float | str] | None = None,
        world: str | None = None,
        player: int | None = None,
        within: int | None = None,
        observe: Observe = None,
        actions: str = "multi",
        reward: Reward | Mapping[str, Any] | None = None,
        seed: int = 0,
        render_mode: str | None = None,
    ) -> None:
        self.render_mode = _mode(render_mode)
        self.runs = _Runs(1, file, goal, level, params, world, player, within, observe, actions, reward, seed, 1)
        self.observation_space = self.runs.space
        self.action_space = self.runs.actions.space
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self.runs.world.step)}
        self._window: Window | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.runs.begin(None, seed)
        state = (options or {}).get("state")
        if state is not None:
            self.runs.batch.restore(0, state, int((options or {}).get("steps", 0)))
            self.runs.observe()
        if self.render_mode == "human":
            self.render()
        return self.runs.observations.give(self.runs.arrays, 0), {}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        runs = self.runs
        rewards = runs.step(np.asarray(action)[np.newaxis], False)
        terminated, truncated = bool(is_terminated(runs.status)[0]), bool(is_truncated(runs.status)[0])
        info: dict[str, Any] = {}
        if terminated or truncated:
            info = {"status": int(runs.status[0]), "why": runs.batch.why(0)}
        if self.render_mode == "human":
            self.render()
        return runs.observations.give(runs.arrays, 0), float(rewards[0]), terminated, truncated, info

    def simulator(self) -> _hyped.Simulator:
        """The run as a simulator of its own."""
        return self.runs.batch.simulator(0)

    def render(self) -> Any:
        if self.render_mode is None:
            return None
        picture = self.simulator().render()
        if self.render_mode == "rgb_array":
            return picture
        if self._window is None:
            self._window = Window(self.runs.world.name, self.runs.world.step)
        self._window.show(picture)
        return None

    def close(self) -> None:
        if self._window is not None:
            self._window.close()


class LevelVectorEnv(gymnasium.vector.VectorEnv[Any, Any, Any]):
    """As ``LevelEnv``, for ``num_envs`` runs at once in one block of memory, stepped on all cores.

    ``autoreset_mode`` is one of ``gymnasium.vector.AutoresetMode``: by default the next step of a run that has ended
    begins anew (``NEXT_STEP``); with ``SAME_STEP`` the same step does, and ``info["final_obs"]`` has the last
    observation; with ``DISABLED`` the caller resets by ``reset(options={"reset_mask": …})``. ``threads`` is the number
    of threads; results are the same for any. ``copy=False`` gives the same arrays in each step, written anew.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 60, "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int,
        file: Source | _hyped.Program,
        goal: str | None = None,
        *,
        level: Level | None = None,
        params: Mapping[str, float | str] | None = None,
        world: str | None = None,
        player: int | None = None,
        within: int | None = None,
        observe: Observe = None,
        actions: str = "multi",
        reward: Reward | Mapping[str, Any] | None = None,
        seed: int = 0,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        copy: bool = True,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise error.Error(f'render_mode is None or "rgb_array" here, not {render_mode!r}')
        self.render_mode = render_mode
        self.num_envs = num_envs
        self.mode = AutoresetMode(autoreset_mode)
        self.copy = copy
        self.runs = _Runs(
            num_envs, file, goal, level, params, world, player, within, observe, actions, reward, seed, threads
        )
        self.metadata = {
            **self.metadata,
            "autoreset_mode": self.mode,
            "render_fps": round(1.0 / self.runs.world.step),
        }
        self.single_observation_space = self.runs.space
        self.single_action_space = self.runs.actions.space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def _given(self) -> Any:
        of = self.runs.observations
        if self.copy:
            return of.give(self.runs.arrays)
        return dict(zip(of.views, self.runs.arrays)) if of.is_dict else self.runs.arrays[0]

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        if isinstance(seed, (list, tuple, np.ndarray)):
            raise QuestionError("`seed` is one number: run i draws from `seed + i`")
        super().reset(seed=seed)
        mask = (options or {}).get("reset_mask")
        self.runs.begin(None if mask is None else np.ascontiguousarray(mask, np.bool_), seed if mask is None else None)
        return self._given(), {}

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        runs = self.runs
        rewards = runs.step(actions, self.mode == AutoresetMode.NEXT_STEP)
        terminated, truncated = is_terminated(runs.status), is_truncated(runs.status)
        infos: dict[str, Any] = {}
        ended = terminated | truncated
        if self.mode == AutoresetMode.SAME_STEP and ended.any():
            infos["final_obs"], infos["_final_obs"] = runs.observations.give(runs.arrays), ended
            runs.begin(ended, None)
        return self._given(), rewards, terminated, truncated, infos

    def render(self) -> tuple[Any, ...] | None:
        if self.render_mode is None:
            return None
        return tuple(self.runs.batch.simulator(row).render() for row in range(self.num_envs))


def _mode(render_mode: str | None) -> str | None:
    if render_mode not in (None, "rgb_array", "human"):
        raise error.Error(f'render_mode is None, "rgb_array" or "human", not {render_mode!r}')
    return render_mode
