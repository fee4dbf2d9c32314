"""The extension module. Lengths are in pixels (px), times in seconds (s), y points up."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "Batch",
    "Event",
    "Planes",
    "Program",
    "Simulator",
    "VERSION",
    "Variables",
    "World",
    "_bounds",
    "_compile",
    "_explore",
    "_question_name",
    "_reach",
    "_rebuilt",
    "_resumed",
    "_stuck",
    "_trace",
    "_tune",
    "_why",
]
VERSION: str
"""The version of the library."""

_Actions = (
    npt.NDArray[np.float32]
    | npt.NDArray[np.float64]
    | npt.NDArray[np.uint8]
    | npt.NDArray[np.int8]
    | npt.NDArray[np.bool_]
)
_Output = npt.NDArray[np.float32] | npt.NDArray[np.float64] | npt.NDArray[np.uint8]
_Outputs = _Output | Sequence[_Output]
_Inputs = str | Mapping[str, float | bool] | None
_Value = float | int | bool | str | None

@final
class Program:
    """A compiled program, see ``hyped.compile``. It can be pickled: it is compiled again from the texts that it was
    made of.
    """

    @property
    def path(self) -> str:
        """The path of the main file, ``<text>`` if it was given as text."""
    @property
    def worlds(self) -> list[str]:
        """The names of the worlds."""
    @property
    def entities(self) -> list[str]:
        """The names of the entities."""
    @property
    def sha256(self) -> str:
        """A hash of what the program means, in hexadecimal digits."""
    @property
    def warnings(self) -> str:
        """The warnings of the compiler as text, as on the terminal."""
    @property
    def _findings(self) -> str: ...
    def _check(self) -> tuple[str, str]: ...
    def world(self, name: str | None = None) -> World:
        """A world by name, or the only one."""
    def _with_level(self, level: str | PathLike[str], text: str | None = None) -> Program: ...
    def _with_numbers(self, numbers: Sequence[tuple[str, str]]) -> Program: ...
    def _recipe(self) -> str: ...
    def _asking(
        self, goals: list[str], nevers: list[str], without: str | None = None, world: str | None = None
    ) -> Program: ...

@final
class World:
    """A world of a program."""

    @property
    def program(self) -> Program:
        """The program."""
    @property
    def name(self) -> str:
        """Its name."""
    @property
    def step(self) -> float:
        """The length of a step, s."""
    @property
    def spaces(self) -> list[str]:
        """The names of its spaces."""
    @property
    def instances(self) -> list[str]:
        """The names of the instances that are placed."""
    @property
    def goals(self) -> list[str]:
        """The names of its goals."""
    @property
    def nevers(self) -> list[str]:
        """The names of its ``never``s."""
    @property
    def players(self) -> list[tuple[int, str]]:
        """The number of each player, with the instance that it controls."""
    @property
    def names(self) -> list[str]:
        """All names of parts of a state, but those of the form ``hero in air``.

        ``hero.x``, ``hero.x'`` and ``hero.x''`` are position (px), velocity (px/s) and acceleration (px/s²);
        ``hero.mode`` or ``hero.mode.GROUP`` the innermost active mode, ``hero in air`` whether a mode is active,
        ``hero.timer.air`` for how long (s), ``hero.space`` the space, ``hero.alive`` whether it is there, ``goal.NAME``
        and ``never.NAME`` whether they hold.
        """
    def buttons(self, player: int | None = None) -> list[str]:
        """The buttons of a player, in the order of an action."""
    def axes(self, player: int | None = None) -> list[str]:
        """The axes of a player, in the order of an action, after its buttons."""
    def words(self, name: str) -> list[str] | None:
        """The words that the numbers of a part stand for in observations, in order; None if they are numbers."""
    def tiles(self, space: str | None = None) -> npt.NDArray[np.str_]:
        """The characters of the tiles of a space, the first by default: shape (rows, columns), rows from the top."""
    def svg(self, inputs: str = "", chance: int | None = None) -> str:
        """The picture of a run of an input script, as SVG."""
    def _repr_svg_(self) -> str: ...

@final
class Event:
    """What happened in a step."""

    @property
    def kind(self) -> str:
        """``edge``, ``spawned``, ``destroyed``, ``entered``, ``touched``, ``parted``, ``broken``, ``restored``,
        ``goal``, ``never``.
        """
    @property
    def instance(self) -> str | None:
        """The instance; None of tiles, goals and ``never``s."""
    @property
    def what(self) -> str | None:
        """The mode an edge leads to, the space, the tag that is touched, the place of a tile, the goal or the
        ``never``.
        """

@final
class Simulator:
    """A running world.

    ``simulator["hero.x"]`` reads a part of the state by name, ``simulator["hero.x"] = 64`` writes it as it is; see
    ``World.names``. What inputs leave open is drawn from ``seed``.

    >>> import hyped
    >>> run = hyped.Simulator(hyped.compile(TEXT))
    >>> run.step("up", count=30)
    >>> run.steps, run["ball.mode"], run["ball.y"] > 0
    (30, 'fly', True)
    >>> later = run.copy()
    >>> later.step({"up": False}, count=30)
    >>> later["ball.y"] < run["ball.y"], run.hash() == later.hash()
    (True, False)
    >>> later.restore(run.save(), steps=run.steps)
    >>> run.hash() == later.hash()
    True
    """

    def __new__(cls, program: Program, world: str | None = None, *, seed: int = 0) -> Simulator: ...
    @property
    def program(self) -> Program:
        """The program."""
    @property
    def world(self) -> World:
        """The world."""
    @property
    def steps(self) -> int:
        """Number of steps so far."""
    @property
    def time(self) -> float:
        """The time so far, s."""
    seed: int
    """The seed of what nature draws."""
    def step(self, inputs: _Inputs = None, count: int = 1) -> None:
        """A number of steps with the same input.

        ``inputs`` is None, a step of a script such as ``"right+jump"``, or a dict such as ``{"jump": True, "steer":
        -0.5}``: a button is down unless its number is 0, an axis is from -1 to 1. Names are as in scripts: ``2:jump``
        is of player 2, ``nature:hero.roll`` is what nature draws. Raises ``StepError`` if the program breaks a rule of
        the language.
        """
    def step_with_events(self, inputs: _Inputs = None) -> list[Event]:
        """One step; returns its events: edges in the order in which they were taken, then the others."""
    def run(self, inputs: str) -> None:
        """Runs an input script to its end: ``"right*40 right+jump*12 -*10"``."""
    def reset(self, seed: int | None = None) -> None:
        """Begins anew."""
    def __getitem__(self, name: str, /) -> _Value: ...
    def __setitem__(self, name: str, new: _Value, /) -> None: ...
    def values(self) -> dict[str, _Value]:
        """All parts of the state that have a name; None of absent instances."""
    def modes(self, instance: str) -> list[str]:
        """The innermost active mode of each group of an instance; empty if it is absent."""
    @property
    def instances(self) -> list[str]:
        """The names of the instances that are there."""
    @property
    def goals(self) -> list[str]:
        """The goals that hold."""
    @property
    def nevers(self) -> list[str]:
        """Each ``never`` that holds."""
    @property
    def left(self) -> str | None:
        """The player that has left the bounds of its space, which ends a run; None if none has."""
    def save(self) -> bytes:
        """The state as bytes, for ``restore`` and for files; it has neither the number of steps nor the seed."""
    def restore(self, state: bytes, steps: int = 0) -> None:
        """Puts a saved state in place: also of the same world with other numbers."""
    def copy(self) -> Simulator:
        """A run of its own that goes on from here."""
    def __copy__(self) -> Simulator: ...
    def __deepcopy__(self, _memo: Any, /) -> Simulator: ...
    def hash(self) -> int:
        """A hash of the state, the same on every machine: FNV-1a of 64 bits over its bytes."""
    def state(self) -> bytes:
        """The bytes of the state, in the layout of the world."""
    def picture_shape(self, scale: int | None = None, size: tuple[int, int] | None = None) -> tuple[int, int, int]:
        """Shape of the pictures of ``render``: (height, width, 3)."""
    def render(
        self, scale: int | None = None, size: tuple[int, int] | None = None, dark: bool = False
    ) -> npt.NDArray[np.uint8]:
        """The picture of the state: shape (height, width, 3). ``scale`` is in pixels for each px of the game."""
    def trace_line(self, inputs: _Inputs = None) -> str:
        """The line of ``hypedc sim --trace`` for the state after an input."""
    def _repr_svg_(self) -> str: ...

@final
class Variables:
    """An observation: parts of a state by name, as numbers; shape (names,).

    Truth is 0 or 1, a mode or a space its place among ``World.words``; all parts of an absent instance are 0.
    """

    def __new__(cls, names: Sequence[str]) -> Variables: ...
    @property
    def names(self) -> list[str]:
        """The names."""

@final
class Planes:
    """An observation: a window of tiles around a player as planes of 0 and 1; shape (planes, rows, columns).

    First a plane for each of ``tags``: where there is a tile, not broken, or free-standing geometry with the tag. Then
    one for each of ``entities``: where the colliders of its instances are. A cell is a tile of the map, 16 x 16 px
    without one. The player's position is in the cell ``[rows - 1 - rows // 2, columns // 2]``; row 0 is the top.
    """

    def __new__(
        cls,
        columns: int,
        rows: int,
        tags: Sequence[str] | None = None,
        entities: Sequence[str] | None = None,
        player: int | None = None,
    ) -> Planes: ...
    @property
    def columns(self) -> int:
        """Number of columns."""
    @property
    def rows(self) -> int:
        """Number of rows."""
    @property
    def tags(self) -> list[str] | None:
        """The tags that have a plane; None: those of all tiles and free-standing geometry."""
    @property
    def entities(self) -> list[str] | None:
        """The entities that have a plane; None: all."""
    @property
    def player(self) -> int | None:
        """The player in the middle; None: the first one."""

@final
class Batch:
    """``n`` runs of a world in one block of memory, stepped together on ``threads`` threads: all cores by default.

    ``observe`` is what ``step`` writes: a ``Variables`` or a ``Planes``, or up to four of them. ``goals`` and
    ``nevers`` end a run (all of the world by default), as does a player that leaves the bounds, a run-time error, and
    the step number ``within``. Row ``i`` draws what nature draws from the seed ``seed + i``, and after a reset from one
    that is greater by ``n``. Results are the same for any number of threads, and the same bits as those of single runs.

    >>> import hyped, numpy
    >>> batch = hyped.Batch(hyped.compile(TEXT), 64, observe=hyped.Variables(["ball.x", "ball.y"]), within=100)
    >>> batch.shape, batch.observation_shapes
    ((64, 1, 1), [(64, 2)])
    >>> observations = numpy.zeros((64, 2), numpy.float32)
    >>> actions = numpy.ones(batch.shape, numpy.float32)
    >>> for _ in range(10):
    ...     batch.step(actions, observations)
    >>> bool((observations == observations[0]).all()), batch.status.tolist() == [hyped.RUNNING] * 64
    (True, True)
    """

    def __new__(
        cls,
        program: Program,
        n: int,
        *,
        world: str | None = None,
        observe: Variables | Planes | Sequence[Variables | Planes] | None = None,
        goals: Sequence[str] | None = None,
        nevers: Sequence[str] | None = None,
        within: int | None = None,
        seed: int = 0,
        threads: int | None = None,
    ) -> Batch: ...
    def __len__(self) -> int: ...
    @property
    def program(self) -> Program:
        """The program."""
    @property
    def world(self) -> World:
        """The world."""
    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of actions: (n, players, buttons + axes), of the player with the most; see ``World.buttons``."""
    @property
    def observation_shapes(self) -> list[tuple[int, ...]]:
        """Shape of each observation of all rows: (n, …)."""
    @property
    def threads_used(self) -> int:
        """Number of threads."""
    def step(
        self,
        actions: _Actions,
        observations: _Outputs | None = None,
        status: npt.NDArray[np.uint8] | None = None,
        *,
        reset: bool = False,
    ) -> None:
        """One step of each row that goes on; a row whose run has ended stays as it is, or begins anew with ``reset``.

        ``actions`` has the shape (n, players, buttons + axes), or (n, buttons + axes) for one player: float32, float64,
        uint8, int8 or bool, contiguous. A button is down unless its number is 0, an axis is from -1 to 1.
        ``observations`` are written in place: float32, float64 or uint8 arrays of ``observation_shapes``; ``status`` is
        written as ``Batch.status``.
        """
    def observe(self, observations: _Outputs | None = None, status: npt.NDArray[np.uint8] | None = None) -> None:
        """Writes observations and status, without a step."""
    def reset(self, rows: npt.NDArray[np.bool_] | None = None, *, seed: int | None = None) -> None:
        """Begins anew: all rows, or those of a mask of the shape (n,). ``seed`` is as in the constructor."""
    @property
    def status(self) -> npt.NDArray[np.uint8]:
        """How each run stands: ``RUNNING``, ``GOAL``, ``NEVER``, ``OUTSIDE``, ``FAULT``, ``TIME_UP``; shape (n,)."""
    @property
    def steps(self) -> npt.NDArray[np.uint64]:
        """Number of steps of each run; shape (n,)."""
    @property
    def seeds(self) -> npt.NDArray[np.uint64]:
        """The seed of what nature draws in each row; shape (n,)."""
    def why(self, row: int) -> str | None:
        """What ended the run of a row: the name of the goal or ``never``, or a sentence; None if it goes on."""
    def save(self, row: int) -> bytes:
        """The state of a row, as ``Simulator.save`` gives it."""
    def restore(self, row: int, state: bytes, steps: int = 0) -> None:
        """Puts a saved state in place in a row."""
    def simulator(self, row: int) -> Simulator:
        """The run of a row as a simulator of its own."""
    def hash(self) -> int:
        """A hash of the states of all rows: FNV-1a of 64 bits over their bytes."""

def _compile(
    root: str,
    texts: Mapping[str, str],
    level: str | None,
    legend: str | None,
    tile: tuple[float, float] | None,
    numbers: Sequence[tuple[str, str]],
) -> Program: ...
def _rebuilt(recipe: str, level: str | None = None, text: str | None = None) -> Program: ...
def _question_name(text: str) -> str: ...
def _resumed(program: Program, world: str, seed: int, state: bytes, steps: int) -> Simulator: ...
def _reach(
    program: Program, asked: str, progress: Callable[[int, int, int], Any] | None = None
) -> tuple[str, list[str], bool]: ...
def _explore(
    program: Program, asked: str, progress: Callable[[int, int, int], Any] | None = None
) -> tuple[str, bool]: ...
def _stuck(
    program: Program, asked: str, progress: Callable[[int, int, int], Any] | None = None
) -> tuple[str, bool]: ...
def _bounds(program: Program, world: str | None = None) -> str: ...
def _tune(program: Program, asked: str, progress: Callable[[int, int, int], Any] | None = None) -> str: ...
def _why(
    program: Program,
    inputs: str,
    world: str | None = None,
    instance: str | None = None,
    mode: str | None = None,
    edge: str | None = None,
    never: bool = False,
    at: int | None = None,
    chance: int = 0,
) -> str: ...
def _trace(
    program: Program,
    world: str | None,
    inputs: str,
    names: Sequence[str],
    chance: int | None = None,
    steps: int | None = None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], list[list[str] | None], str | None]: ...
