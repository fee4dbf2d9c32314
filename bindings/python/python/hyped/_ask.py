"""The functions of the package: compile, check, reach, explore, why, stuck, bounds, tune."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, Callable, Union

import numpy as np
import numpy.typing as npt

from hyped import _hyped
from hyped._errors import Diagnostic, QuestionError, diagnostics
from hyped._results import Bounds, Explored, Reached, Stuck, Tuned, Why, Witness, answers

Source = Union[str, "os.PathLike[str]"]
"""A path, or a text: a ``str`` with a line break or a brace in it is a text."""
Level = Union[Source, Sequence[str], "npt.NDArray[Any]"]
"""A path, a text, rows of text from the top, or an array of characters of the shape (rows, columns)."""
Progress = Union[Callable[[int, int, int], Any], bool, None]
"""Called with nodes, their limit and places covered; True shows a bar by ``tqdm`` if that is installed."""


LEVEL = "<level>.txt"


def _is_text(source: object) -> bool:
    return isinstance(source, str) and any(mark in source for mark in "\n\r{")


def _level_text(level: Level) -> str | None:
    """The text of a level that is not a path."""
    if isinstance(level, str):
        return level if _is_text(level) or "\n" in level else None
    if isinstance(level, os.PathLike):
        return None
    if isinstance(level, np.ndarray):
        if level.ndim != 2 or level.dtype.kind not in "US":
            raise QuestionError(
                f"a level is an array of characters of two dimensions, not {level.dtype} of {level.ndim}"
            )
        level = ["".join(row) for row in level.astype(str).tolist()]
    if isinstance(level, Sequence) and all(isinstance(row, str) for row in level):
        return "\n".join(level) + "\n"
    raise QuestionError("a level is a path, a text, rows of text or an array of characters")


def level_file(level: Level) -> tuple[str, str | None]:
    """The path of a level, and its text if it is not on the disk."""
    text = _level_text(level)
    return (_path(level, "`level`"), None) if text is None else (LEVEL, text)


def _path(path: object, what: str) -> str:
    if not isinstance(path, (str, os.PathLike)):
        raise QuestionError(f"{what} is a path, not {type(path).__name__}")
    text = os.fspath(path)
    if not isinstance(text, str) or "\0" in text:
        raise QuestionError(f"{what} is a path as text, not {text!r}")
    return text


def compile(
    source: Source,
    *,
    level: Level | None = None,
    legend: Source | None = None,
    tile: tuple[float, float] | None = None,
    params: Mapping[str, float | str] | None = None,
    folder: str | os.PathLike[str] | None = None,
) -> _hyped.Program:
    """Compiles a program.

    ``source`` is a path, or the text of a program: a ``str`` with a line break or a brace. ``folder`` is where a text
    looks for what it imports. ``level`` fills the open map of a world: a path, a text, rows of text or an array of
    characters; ``legend`` is the path of its legend, ``tile`` width and height of its tiles in px. ``params`` sets
    numbers of the program: ``{"Hero.speed": 120}``; a number has the unit that is written in the program.

    Raises ``CompileError`` if the program has errors.

    >>> program = compile("entity Ball { y' = 60 }; world Sky { space main { place ball: Ball at (0, 0) } }")
    >>> program.worlds
    ['Sky']
    >>> try:
    ...     compile("entity Ball { y' = fast }")
    ... except CompileError as error:
    ...     print(error.diagnostics[0].severity, error.diagnostics[0].line)
    error 1
    """
    texts: dict[str, str] = {}
    beside = "" if folder is None else _path(folder, "`folder`")
    if isinstance(source, str) and _is_text(source):
        root = os.path.join(beside, "<text>")
        texts[root] = source
    else:
        root = os.path.join(beside, _path(source, "a program"))
    map_path: str | None = None
    if level is not None:
        map_path, text = level_file(level)
        if text is not None:
            texts[map_path] = text
    numbers = []
    for name, value in (params or {}).items():
        if isinstance(value, bool) or not isinstance(value, (int, float, str, np.integer, np.floating)):
            raise QuestionError(f"`params`: {name!r} is a number or an expression as text, not {value!r}")
        numbers.append((name, value if isinstance(value, str) else repr(float(value))))
    legend_path = None if legend is None else _path(legend, "`legend`")
    return _hyped._compile(root, texts, map_path, legend_path, tile, numbers)


def with_level(program: _hyped.Program, level: Level) -> _hyped.Program:
    """The same program with another level, see ``compile``."""
    path, text = level_file(level)
    return program._with_level(path, text)


def check(program: _hyped.Program) -> tuple[Diagnostic, ...]:
    """All findings about a program, with those of the analysis: as ``hypedc check`` shows them."""
    return diagnostics(program._check()[1])


def _names(what: str, names: str | Sequence[str] | None) -> list[str]:
    if names is None:
        return []
    chosen = [names] if isinstance(names, str) else list(names)
    if not all(isinstance(name, str) for name in chosen):
        raise QuestionError(f"`{what}` is a name or a predicate as text, or several")
    return chosen


class _Bar:
    """A bar by tqdm."""

    def __init__(self) -> None:
        from tqdm.auto import tqdm

        self.bar = tqdm(unit=" nodes")

    def __call__(self, nodes: int, budget: int, places: int) -> None:
        if budget < 1 << 62:
            self.bar.total = budget
        self.bar.n = nodes
        self.bar.set_postfix(places=places)


def _teller(progress: Progress) -> Callable[[int, int, int], Any] | None:
    if progress is True:
        try:
            return _Bar()
        except ImportError:
            return None
    if progress is None or progress is False:
        return None
    if not callable(progress):
        raise QuestionError("`progress` is called with three numbers, or True")
    return progress


def reach(
    program: _hyped.Program,
    goals: str | Sequence[str] | None = None,
    *,
    world: str | None = None,
    nevers: str | Sequence[str] | None = None,
    without: str | None = None,
    within: int | None = None,
    min_hold: int | None = None,
    after: str | Sequence[str] | None = None,
    planner: str = "auto",
    nodes: int | None = None,
    seconds: float | None = None,
    memory: int | None = None,
    seed: int = 1,
    trees: int = 1,
    threads: int = 1,
    style: str | None = None,
    chance: int | None = None,
    exhaust: bool = False,
    sigma: float | None = None,
    trials: int = 1000,
    svg: bool = False,
    progress: Progress = None,
) -> Reached:
    """Searches for inputs that reach goals, or proves that there are none: as ``hypedc reach``.

    ``goals`` and ``nevers`` are names or predicates such as ``"hero.x > 300"``; without any, all goals of the world are
    asked for. ``within`` limits the steps of a path, ``min_hold`` is the number of steps for which each input is held
    at least, ``after`` are input scripts in whose last states paths begin. ``nodes`` and ``seconds`` limit the search
    for each of them, ``memory`` is in bytes. The same ``seed`` gives the same answers for any number of ``threads``, if
    ``seconds`` did not end the search. ``style`` makes paths better: ``fast``, ``calm`` or ``few-inputs``. ``exhaust``
    visits all states where the search finds nothing. ``sigma`` asks for paths that withstand timing errors of this
    standard deviation, in steps, and measures by ``trials`` plays how often they succeed.

    ``KeyboardInterrupt`` stops the search, which returns what it has; ``interrupted`` is set then. ``progress`` is
    called with nodes, their limit and places covered, about twenty times a second; True shows a bar if ``tqdm`` is
    installed.

    >>> program = compile(TEXT)
    >>> answer = reach(program)["high"]
    >>> answer.verdict, answer.witness.simulator()["ball.y"] > 20
    ('reached', True)
    """
    asked = {
        "world": world,
        "goals": _names("goals", goals),
        "nevers": _names("nevers", nevers),
        "without": without,
        "within": within,
        "min_hold": min_hold,
        "after": _names("after", after),
        "planner": planner,
        "nodes": nodes,
        "seconds": None if seconds is None else float(seconds),
        "memory": memory,
        "seed": seed,
        "trees": trees,
        "threads": threads,
        "style": style,
        "chance": chance,
        "exhaust": exhaust,
        "sigma": None if sigma is None else float(sigma),
        "trials": trials,
        "svg": svg,
    }
    found, pictures, interrupted = _hyped._reach(program, _question(asked), _teller(progress))
    return answers(program, json.loads(found), pictures, interrupted, chance)


def explore(
    program: _hyped.Program,
    *,
    world: str | None = None,
    without: str | None = None,
    within: int | None = None,
    min_hold: int | None = None,
    after: str | Sequence[str] | None = None,
    planner: str = "auto",
    nodes: int | None = None,
    seconds: float | None = None,
    memory: int | None = None,
    seed: int = 1,
    trees: int = 1,
    threads: int = 1,
    chance: int | None = None,
    progress: Progress = None,
) -> Explored:
    """Goes wherever it can, and tells what was covered: as ``hypedc reach --explore``. The options are those of
    ``reach``; what was not found may still be reachable.

    >>> found = explore(compile(TEXT), nodes=500)
    >>> found.modes[("Ball", "fly")]
    True
    """
    asked = {
        "world": world,
        # What nothing reaches.
        "goals": ["false"],
        "nevers": [],
        "without": without,
        "within": within,
        "min_hold": min_hold,
        "after": _names("after", after),
        "planner": planner,
        "nodes": nodes,
        "seconds": None if seconds is None else float(seconds),
        "memory": memory,
        "seed": seed,
        "trees": trees,
        "threads": threads,
        "style": None,
        "chance": chance,
        "exhaust": False,
        "sigma": None,
        "trials": 1,
        "svg": False,
    }
    found, interrupted = _hyped._explore(program, _question(asked), _teller(progress))
    record = json.loads(found)
    broken = {
        of["never"]: Witness(program, record["world"], of["inputs"], of["steps"], chance) for of in record["violations"]
    }
    return Explored(
        world=record["world"],
        spaces={of["name"]: of["entered"] for of in record["spaces"]},
        cells=(sum(of["cells_entered"] for of in record["spaces"]), sum(of["cells"] for of in record["spaces"])),
        floors=(sum(of["tops_stood_on"] for of in record["spaces"]), sum(of["tops"] for of in record["spaces"])),
        modes={(of["entity"], of["mode"]): of["entered"] for of in record["modes"]},
        broken=broken,
        nodes=record["nodes"],
        interrupted=interrupted,
        record=record,
    )


def why(
    program: _hyped.Program,
    inputs: str,
    *,
    world: str | None = None,
    instance: str | None = None,
    mode: str | None = None,
    edge: str | None = None,
    never: bool = False,
    at: int | None = None,
    chance: int = 0,
) -> Why:
    """Why an instance did what it did in a step of the run of an input script: as ``hypedc why``.

    ``instance`` is that of player 1 by default, ``at`` the step, by default the last one. ``mode`` or ``edge`` (a line)
    choose edges; with ``never=True`` the question is why none of them was taken in the whole run, and how near it came.
    """
    found = json.loads(_hyped._why(program, inputs, world, instance, mode, edge, never, at, chance))
    return Why(found["world"], found["why"], found["nearly"])


def _question(asked: dict[str, Any]) -> str:
    try:
        return json.dumps(asked, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise QuestionError(f"not a question: {error}") from None


def stuck(
    program: _hyped.Program,
    goal: str | None = None,
    *,
    world: str | None = None,
    states: int = 300_000,
    nodes: int = 400_000,
    seconds: float | None = None,
    memory: int = 2 << 30,
    seed: int = 1,
    progress: Progress = None,
) -> Stuck:
    """Looks for places from which a goal cannot be reached any more: as ``hypedc stuck``.

    It is proven where all states can be visited, at most ``states``; elsewhere places are candidates, from which a
    search of ``nodes`` did not arrive. ``memory`` is in bytes. ``KeyboardInterrupt`` stops it.
    """
    asked = {
        "world": world,
        "goal": goal,
        "states": states,
        "nodes": nodes,
        "seconds": None if seconds is None else float(seconds),
        "memory": memory,
        "seed": seed,
    }
    found, interrupted = _hyped._stuck(program, _question(asked), _teller(progress))
    record = json.loads(found)
    ways = tuple(Witness(program, record["world"], of["inputs"], of["steps"]) for of in record["ways"])
    return Stuck(record["verdict"], ways, record["places"], interrupted, record)


def bounds(program: _hyped.Program, *, world: str | None = None) -> Bounds:
    """The values that each part of a world can have, in whatever run: as ``hypedc bounds``.

    >>> found = bounds(compile(TEXT))
    >>> found.interval("ball.y'"), found.impossible
    ((-30.0, 30.0), {})
    """
    record = json.loads(_hyped._bounds(program, world))
    proven = {of["goal"]: of["argument"] for of in record["goals"] if of["argument"] is not None}
    return Bounds(record["world"], proven, record)


def tune(
    program: _hyped.Program,
    vary: Mapping[str, tuple[float, float] | tuple[float, float, float]],
    goal: str | None = None,
    *,
    world: str | None = None,
    prevent: bool = False,
    nevers: str | Sequence[str] | None = None,
    within: int | None = None,
    min_hold: int | None = None,
    samples: int = 8,
    nodes: int = 50_000,
    seconds: float | None = None,
    memory: int = 2 << 30,
    seed: int = 1,
    chance: int | None = None,
    progress: Progress = None,
) -> Tuned:
    """Finds the smallest change of numbers with which a goal is reached, or with ``prevent`` cannot be: as ``hypedc
    tune``.

    ``vary`` gives up to four numbers with their ranges, and perhaps the step between two values:
    ``{"Hero.jump_speed": (100, 400), "Door.locks": (1, 5, 1)}``. ``nevers`` must not be broken. ``nodes``, ``seconds``
    and ``memory`` (bytes) limit the search at each value.
    """
    numbers = []
    for name, of in dict(vary).items():
        if not isinstance(of, (tuple, list)) or len(of) not in (2, 3):
            raise QuestionError(
                f"`vary`: {name!r} has a range such as (100, 400), or (1, 5, 1) with a step, not {of!r}"
            )
        numbers.append((name, (of[0], of[1]), of[2] if len(of) == 3 else None))
    asked = {
        "vary": numbers,
        "goal": goal,
        "world": world,
        "prevent": prevent,
        "nevers": _names("nevers", nevers),
        "within": within,
        "min_hold": min_hold,
        "samples": samples,
        "nodes": nodes,
        "seconds": None if seconds is None else float(seconds),
        "memory": memory,
        "seed": seed,
        "chance": chance,
    }
    record = json.loads(_hyped._tune(program, _question(asked), _teller(progress)))
    trials, change, names = record["trials"], record["change"], [axis["name"] for axis in record["axes"]]
    found, way = None, None
    if change is not None:
        trial = trials[change["trial"]]
        pairs = zip(names, trial["values"], record["axes"])
        found = {name: value for name, value, axis in pairs if value != axis["base"]}
        if trial["inputs"] is not None:
            changed = program._with_numbers([(name, repr(value)) for name, value in found.items()])
            name = changed.world(world).name
            way = Witness(changed, name, trial["inputs"], trial["steps"], chance)
    return Tuned(
        change=found,
        is_wanted_already=record["is_wanted_already"],
        is_proven_smallest=change is not None and change["is_proven_smallest"],
        witness=way,
        values=np.array([of["values"] for of in trials], np.float64).reshape(len(trials), len(names)),
        verdicts=tuple(of["verdict"] for of in trials),
        interrupted=record["is_stopped"],
        record=record,
    )
