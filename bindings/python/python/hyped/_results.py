"""Answers as dataclasses. Their fields are those of the JSON results of the command line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from hyped import _hyped
from hyped._errors import UnknownNameError

if TYPE_CHECKING:
    import pandas
    import pyarrow


class Trace(Mapping[str, "npt.NDArray[Any]"]):
    """The run of an input script: a column for each part of the state, as an array of the shape (steps + 1,).

    Row 0 is the initial state. Numbers are float64, positions in px, velocities in px/s; modes, spaces and values of
    sets are arrays of text. ``inputs`` is what the players did: shape (steps, players, buttons + axes), float64;
    ``end`` says why the run ended early, if it did.
    """

    def __init__(self, columns: dict[str, npt.NDArray[Any]], inputs: npt.NDArray[np.float64], end: str | None) -> None:
        self._columns = columns
        self.inputs = inputs
        self.end = end

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self._columns[name]

    def __iter__(self) -> Any:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"<hyped.Trace of {len(self.inputs)} steps, {len(self)} columns>"

    def to_pandas(self) -> pandas.DataFrame:
        """As a data frame with a row for each step; needs ``pandas``."""
        import pandas

        return pandas.DataFrame(self._columns)

    def to_arrow(self) -> pyarrow.Table:
        """As a table with a row for each step; needs ``pyarrow``."""
        import pyarrow

        return pyarrow.table(self._columns)


def trace(
    program: _hyped.Program,
    inputs: str,
    *,
    world: str | None = None,
    names: list[str] | None = None,
    steps: int | None = None,
    chance: int | None = None,
) -> Trace:
    """Runs an input script, and keeps parts of the state of each step.

    ``names`` are the parts, see ``World.names``; all if none are given. ``steps`` is the number of steps, by default
    those of the script; ``chance`` is the seed of what nature draws.
    """
    chosen = program.world(world).names if names is None else list(names)
    values, taken, words, end = _hyped._trace(program, world, inputs, chosen, chance, steps)
    columns: dict[str, npt.NDArray[Any]] = {}
    for at, (name, known) in enumerate(zip(chosen, words)):
        numbers = np.ascontiguousarray(values[:, at])
        columns[name] = numbers if known is None else np.array(known, dtype=np.str_)[numbers.astype(np.intp)]
    return Trace(columns, taken, end)


@dataclass(frozen=True)
class Witness:
    """Inputs that were found, and replayed before they were shown."""

    program: _hyped.Program = field(repr=False)
    world: str
    script: str
    """The inputs as a script, for ``Simulator.run`` and ``hypedc sim --inputs``."""
    steps: int
    chance: int | None = None

    @property
    def actions(self) -> npt.NDArray[np.float64]:
        """The inputs of each step: shape (steps, players, buttons + axes), as ``Batch.step`` takes them."""
        return self.trace(names=[]).inputs

    def trace(self, names: list[str] | None = None) -> Trace:
        """The run as arrays, see ``hyped.trace``."""
        return trace(self.program, self.script, world=self.world, names=names, chance=self.chance)

    def simulator(self) -> _hyped.Simulator:
        """A simulator at the end of the run."""
        simulator = _hyped.Simulator(self.program, self.world, seed=self.chance or 0)
        simulator.run(self.script)
        return simulator

    def _repr_svg_(self) -> str:
        return self.program.world(self.world).svg(self.script, self.chance)


@dataclass(frozen=True)
class Answer:
    """The answer to one question; see ``docs/formats/results.md`` for all fields of ``record``."""

    kind: str
    """``goal`` or ``never``."""
    name: str
    verdict: str
    """``reached``, ``violated``, ``not-found``, ``not-answered``, ``exhausted``, ``proven-unreachable``."""
    is_expected: bool
    """Whether the author wants this: a goal reached, a ``never`` proven."""
    reasons: tuple[str, ...]
    steps: int | None
    seconds_of_play: float | None
    is_shortest: bool | None
    nodes: int
    seconds: float
    """How long the search took, s."""
    witness: Witness | None = field(repr=False)
    record: dict[str, Any] = field(repr=False)
    svg: str | None = field(default=None, repr=False)
    """The picture of the search, where ``svg=True`` asked for it."""

    def __bool__(self) -> bool:
        return self.is_expected

    def _repr_svg_(self) -> str | None:
        return self.svg if self.svg is not None else self.witness._repr_svg_() if self.witness else None


@dataclass(frozen=True)
class Reached(Mapping[str, Answer]):
    """The answers of a search by name, in the order of the questions."""

    world: str
    answers: tuple[Answer, ...]
    interrupted: bool
    """Whether ``KeyboardInterrupt`` stopped it: there are fewer answers then, or less in them."""
    record: dict[str, Any] = field(repr=False)

    def __getitem__(self, name: str) -> Answer:
        for answer in self.answers:
            if answer.name == name:
                return answer
        known = ", ".join(answer.name for answer in self.answers) or "none"
        raise UnknownNameError(f"no answer to {name!r}; there is {known}")

    def __iter__(self) -> Any:
        return iter([answer.name for answer in self.answers])

    def __len__(self) -> int:
        return len(self.answers)

    def __bool__(self) -> bool:
        return bool(self.answers) and all(self.answers)


def answers(
    program: _hyped.Program, record: dict[str, Any], pictures: list[str], interrupted: bool, chance: int | None
) -> Reached:
    """The answers of a record as ``hypedc reach --format json`` writes it."""
    found = []
    for at, of in enumerate(record["goals"]):
        script = of["inputs"]
        way = None if script is None else Witness(program, record["world"], script, of["steps"], chance)
        found.append(
            Answer(
                kind=of["kind"],
                name=of["goal"],
                verdict=of["verdict"],
                is_expected=of["is_expected"],
                reasons=tuple(of["reasons"]),
                steps=of["steps"],
                seconds_of_play=of["seconds_of_play"],
                is_shortest=of["is_shortest"],
                nodes=of["nodes"],
                seconds=of["seconds"],
                witness=way,
                record=of,
                svg=pictures[at] if at < len(pictures) else None,
            )
        )
    return Reached(record["world"], tuple(found), interrupted, record)


@dataclass(frozen=True)
class Explored:
    """What a search without a question covered; ``docs/formats/results.md`` explains the fields of ``record``."""

    world: str
    spaces: dict[str, bool]
    """Whether a player was in each space."""
    cells: tuple[int, int]
    """Cells of the maps that a player was in, and all that are open to players."""
    floors: tuple[int, int]
    """Upper sides of tiles that a player stood on, and all on which players can stand."""
    modes: dict[tuple[str, str], bool]
    """Whether an instance was in each mode, by entity and path of the mode."""
    broken: dict[str, Witness] = field(repr=False)
    """A way to break each ``never`` that was met."""
    nodes: int
    interrupted: bool
    record: dict[str, Any] = field(repr=False)


@dataclass(frozen=True)
class Why:
    """Why an instance did what it did in a step, or how near it came; ``docs/commands/why.md`` explains the fields."""

    world: str
    step: dict[str, Any] | None
    nearly: dict[str, Any] | None


@dataclass(frozen=True)
class Stuck:
    """Where a player gets stuck; ``docs/formats/stuck.md`` explains the fields of ``record``."""

    verdict: str
    """``none``, ``stuck``, ``candidates``, ``none-found``, ``unreachable`` or ``unknown``."""
    ways: tuple[Witness, ...] = field(repr=False)
    """The ways into stuck places, at most 100."""
    places: int
    interrupted: bool
    record: dict[str, Any] = field(repr=False)


@dataclass(frozen=True)
class Bounds:
    """What each part of a world can be; ``docs/formats/bounds.md`` explains the fields of ``record``."""

    world: str
    impossible: dict[str, str]
    """The goals that are proven unreachable, each with the reason."""
    record: dict[str, Any] = field(repr=False)

    def interval(self, name: str) -> tuple[float, float]:
        """The least and the greatest value of a variable such as ``hero.x`` or ``hero.x'``, in whatever mode."""
        instance, _, part = name.partition(".")
        plain = part.rstrip("'")
        degree = ("value", "velocity", "acceleration")[min(2, len(part) - len(plain))]
        for slot in self.record["slots"]:
            if slot["slot"] != instance:
                continue
            if slot["combinations"] is None:
                return (float("-inf"), float("inf"))
            ends = [
                end
                for combination in slot["combinations"]
                for variable in combination["variables"]
                if variable["name"] == plain
                for end in variable[degree]
            ]
            if ends:
                lows = [float("-inf") if low is None else low for low, _ in ends]
                highs = [float("inf") if high is None else high for _, high in ends]
                return (min(lows), max(highs))
        raise UnknownNameError(f"no variable {name!r}")


@dataclass(frozen=True)
class Tuned:
    """The smallest change of numbers that turns an answer; ``docs/formats/tune.md`` explains ``record``."""

    change: dict[str, float] | None
    """What to set; None if no change was found, or if none is needed."""
    is_wanted_already: bool
    is_proven_smallest: bool
    """Whether no smaller change of one number alone does it."""
    witness: Witness | None = field(repr=False)
    """The way to the goal with the change."""
    values: npt.NDArray[np.float64] = field(repr=False)
    """The values that were tried: shape (trials, numbers), in the units of the program."""
    verdicts: tuple[str, ...] = field(repr=False)
    """The verdict of each trial."""
    interrupted: bool
    record: dict[str, Any] = field(repr=False)
