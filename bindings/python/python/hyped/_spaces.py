"""What the environments share: spaces of actions and observations, rewards, the window."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt
from gymnasium import error, spaces

from hyped import _hyped
from hyped._errors import QuestionError
from hyped._status import FAULT, GOAL, NEVER, OUTSIDE, TIME_UP

View = Union[_hyped.Variables, _hyped.Planes]
Observe = Union[View, Sequence[str], Mapping[str, View], None]

MAX_ACTIONS = 4096


@dataclass(frozen=True)
class Reward:
    """The reward of a step: the sum of its parts.

    ``goal`` where a goal is reached; ``end`` where the run ends otherwise, by a ``never``, outside of the bounds or by
    an error; ``step`` in each step; ``progress`` times the growth of the number ``of``, a part of the state such as
    ``"hero.x"``.
    """

    goal: float = 1.0
    end: float = 0.0
    step: float = 0.0
    progress: float = 0.0
    of: str | None = None

    def __post_init__(self) -> None:
        if (self.of is None) != (self.progress == 0.0):
            raise QuestionError(
                'a reward for progress needs both: `progress`, the reward of 1, and `of`, such as "hero.x"'
            )


class Actions:
    """The actions of one player as a space, and as numbers for ``Batch.step``.

    ``multi`` is ``MultiDiscrete``: 0 or 1 for each button, 0, 1, 2 for -1, 0, 1 of each axis. ``discrete`` numbers all
    of these combinations. ``box`` is ``Box(-1, 1)``: a button is down above 0.
    """

    def __init__(self, world: _hyped.World, player: int, kind: str) -> None:
        buttons, axes = world.buttons(player), world.axes(player)
        self.names = [*buttons, *axes]
        self.buttons = len(buttons)
        self.kind = kind
        sizes = [2] * len(buttons) + [3] * len(axes)
        self.table: npt.NDArray[np.float32] | None = None
        self.space: spaces.Space[Any]
        if not sizes:
            raise QuestionError(f"player {player} of `{world.name}` has no button and no axis")
        if kind == "multi":
            self.space = spaces.MultiDiscrete(sizes)
        elif kind == "box":
            self.space = spaces.Box(-1.0, 1.0, (len(sizes),), np.float32)
        elif kind == "discrete":
            count = int(np.prod(sizes))
            if count > MAX_ACTIONS:
                raise QuestionError(f'there are {count} combinations of buttons and axes: use actions="multi" or "box"')
            table = np.stack(np.unravel_index(np.arange(count), sizes), axis=1).astype(np.float32)
            table[:, self.buttons :] -= 1.0
            self.table = table
            self.space = spaces.Discrete(count)
        else:
            raise QuestionError(f'no kind of actions {kind!r}: there is "multi", "discrete", "box"')

    def write(self, given: npt.ArrayLike, out: npt.NDArray[np.float32]) -> None:
        """Writes actions of the shape (n, …) as numbers of the shape (n, buttons + axes)."""
        actions = np.asarray(given)
        width = len(self.names)
        if self.table is not None:
            if actions.shape != out.shape[:1]:
                raise QuestionError(f"actions have shape {actions.shape}, not {out.shape[:1]}")
            if actions.dtype.kind not in "iu" or actions.min() < 0 or actions.max() >= len(self.table):
                raise QuestionError(f"an action is a whole number from 0 to {len(self.table) - 1}")
            out[:, :width] = self.table[actions]
            return
        if actions.shape != (len(out), width):
            raise QuestionError(f"actions have shape {actions.shape}, not {(len(out), width)}: {', '.join(self.names)}")
        out[:, :width] = actions
        if self.kind == "multi":
            out[:, self.buttons : width] -= 1.0
        else:
            out[:, : self.buttons] = actions[:, : self.buttons] > 0.0


def own_variables(world: _hyped.World, player: int) -> _hyped.Variables:
    """What is observed by default: modes, variables and timers of the player's instance."""
    instance = dict(world.players)[player]
    prefix, names = instance + ".", []
    for name in world.names:
        part = name[len(prefix) :]
        if name.startswith(prefix) and part not in ("alive", "space") and not part.endswith("''"):
            names.append(name)
    return _hyped.Variables(names)


class Observations:
    """The observations of a player: one array, or several by name."""

    def __init__(self, world: _hyped.World, player: int, observe: Observe) -> None:
        views: dict[str, View]
        if observe is None:
            views = {"": own_variables(world, player)}
        elif isinstance(observe, (_hyped.Variables, _hyped.Planes)):
            views = {"": observe}
        elif isinstance(observe, Mapping):
            views = dict(observe)
        elif isinstance(observe, Sequence) and not isinstance(observe, str):
            views = {"": _hyped.Variables(list(observe))}
        else:
            raise QuestionError("`observe` is a Variables, a Planes, names of parts of the state, or a dict of these")
        self.is_dict = "" not in views
        self.views = views

    def space(self, shapes: Sequence[tuple[int, ...]]) -> spaces.Space[Any]:
        """The space of one observation, given the shapes of all rows."""
        found: dict[str, spaces.Space[Any]] = {}
        for (name, view), shape in zip(self.views.items(), shapes):
            if isinstance(view, _hyped.Planes):
                found[name] = spaces.Box(0, 1, shape[1:], np.uint8)
            else:
                found[name] = spaces.Box(-np.inf, np.inf, shape[1:], np.float32)
        return spaces.Dict(found) if self.is_dict else found[""]

    def arrays(self, shapes: Sequence[tuple[int, ...]]) -> list[npt.NDArray[Any]]:
        """Arrays that observations are written to."""
        types = [np.uint8 if isinstance(view, _hyped.Planes) else np.float32 for view in self.views.values()]
        return [np.zeros(shape, of) for of, shape in zip(types, shapes)]

    def give(self, arrays: Sequence[npt.NDArray[Any]], row: int | None = None) -> Any:
        """Observations as the space has them: of all rows, or of one."""
        found = {name: (of if row is None else of[row]).copy() for name, of in zip(self.views, arrays)}
        return found if self.is_dict else found[""]


def first_player(world: _hyped.World, player: int | None) -> int:
    """The player that is meant."""
    numbers = [number for number, _ in world.players]
    if not numbers:
        raise QuestionError(f"`{world.name}` has no player")
    if player is None:
        return min(numbers)
    if player not in numbers:
        raise QuestionError(f"no player {player} in `{world.name}`: there is {', '.join(map(str, numbers))}")
    return player


def is_terminated(status: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
    """Whether the run of a row is over: by a goal, a ``never``, outside, by an error."""
    return np.asarray((status == GOAL) | (status == NEVER) | (status == OUTSIDE) | (status == FAULT))


def is_truncated(status: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
    """Whether its time is up."""
    return np.asarray(status == TIME_UP)


class Window:
    """A window that shows pictures, by pygame."""

    def __init__(self, title: str, seconds: float) -> None:
        try:
            import pygame
        except ImportError as why:
            raise error.DependencyNotInstalled(
                "render_mode=\"human\" needs pygame: pip install 'hyped[human]'"
            ) from why
        self.pygame = pygame
        self.title, self.seconds = title, seconds
        self.screen: Any = None
        self.clock: Any = None

    def show(self, picture: npt.NDArray[np.uint8]) -> None:
        """Shows a picture of the shape (height, width, 3) for a step of the world."""
        pygame = self.pygame
        if self.screen is None:
            pygame.init()
            pygame.display.set_caption(self.title)
            self.screen = pygame.display.set_mode((picture.shape[1], picture.shape[0]))
            self.clock = pygame.time.Clock()
        pygame.event.pump()
        pygame.surfarray.blit_array(self.screen, picture.transpose(1, 0, 2))
        pygame.display.flip()
        self.clock.tick(1.0 / self.seconds)

    def close(self) -> None:
        """Closes it."""
        if self.screen is not None:
            self.pygame.display.quit()
            self.screen = None
