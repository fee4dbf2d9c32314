"""Levels judged for a generator: what can be reached in them, and how.

``evaluate`` asks the same goals of many levels of one program, in any executor of ``concurrent.futures`` (a pool of
processes, Dask, Ray), and keeps answers by the hash of what was asked.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, MutableMapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, Iterator, Union

import numpy as np
import numpy.typing as npt

from hyped import _hyped
from hyped._ask import Level, _names, level_file, reach
from hyped._errors import CompileError, HypedError, QuestionError

__all__ = ["Cache", "Features", "FolderCache", "evaluate"]

Cache = Union[MutableMapping[str, str], str, "os.PathLike[str]", None]
"""A mapping from hashes to JSON, or the path of a folder."""

VERSION = 1
"""Of what is kept: it grows when features change their meaning."""


class FolderCache(MutableMapping[str, str]):
    """Answers as files in a folder, which several processes can share."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)
        os.makedirs(self.folder, exist_ok=True)

    def _path(self, key: str) -> str:
        return os.path.join(self.folder, f"{key}.json")

    def __getitem__(self, key: str) -> str:
        try:
            with open(self._path(key), encoding="utf-8") as file:
                return file.read()
        except FileNotFoundError:
            raise KeyError(key) from None

    def __setitem__(self, key: str, value: str) -> None:
        written = f"{self._path(key)}.{os.getpid()}"
        with open(written, "w", encoding="utf-8") as file:
            file.write(value)
        os.replace(written, self._path(key))

    def __delitem__(self, key: str) -> None:
        try:
            os.remove(self._path(key))
        except FileNotFoundError:
            raise KeyError(key) from None

    def __iter__(self) -> Iterator[str]:
        return (name[:-5] for name in sorted(os.listdir(self.folder)) if name.endswith(".json"))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@dataclass(frozen=True)
class Features:
    """What is known of one goal in one level.

    ``verdict`` is that of ``hyped.Answer``, ``"error"`` if the level cannot be compiled: ``error`` says why. ``steps``
    is the length of the shortest known way, ``is_shortest`` whether it is proven so; ``places`` are 16-px squares and
    ``modes`` combinations of modes that the search came to; ``success`` is the share of plays with timing errors that
    succeed (None without ``sigma``, or without a way); ``presses`` is the number of changes of inputs on the way.
    """

    goal: str
    verdict: str
    steps: int | None
    is_shortest: bool
    places: int
    modes: int
    nodes: int
    success: float | None
    presses: int | None
    inputs: str | None
    error: str | None = None

    NAMES = ("reached", "impossible", "steps", "places", "modes", "nodes", "success", "presses")

    def array(self) -> npt.NDArray[np.float64]:
        """The features as numbers, in the order of ``NAMES``; NaN for what is not known."""

        def number(of: float | None) -> float:
            return float("nan") if of is None else float(of)

        reached, impossible = self.verdict == "reached", self.verdict == "proven-unreachable"
        known = (self.steps, self.places, self.modes, self.nodes, self.success, self.presses)
        return np.array([reached, impossible, *map(number, known)], np.float64)


def _failed(goals: Sequence[str], why: HypedError) -> list[dict[str, Any]]:
    text = str(why)
    blank = dict(steps=None, is_shortest=False, places=0, modes=0, nodes=0, success=None, presses=None, inputs=None)
    return [{"goal": goal, "verdict": "error", **blank, "error": text} for goal in goals or ["?"]]


def _judged(task: str) -> str:
    """Judges one level, in whatever process; task and answer are JSON."""
    asked = json.loads(task)
    path, text = asked["level"]
    try:
        program = _hyped._rebuilt(asked["recipe"], path, text)
        found = reach(program, asked["goals"], world=asked["world"], **asked["options"])
    except (CompileError, QuestionError) as why:
        return json.dumps(_failed(asked["goals"], why))
    features = []
    for answer in found.answers:
        record, script = answer.record, answer.record["inputs"]
        robust = record.get("robust")
        features.append(
            {
                "goal": answer.name,
                "verdict": answer.verdict,
                "steps": answer.steps,
                "is_shortest": bool(answer.is_shortest),
                "places": record["coverage"]["places"],
                "modes": record["coverage"]["mode_combinations"],
                "nodes": answer.nodes,
                "success": None if robust is None else robust["success"],
                "presses": None if script is None else len(script.split()),
                "inputs": script,
                "error": None,
            }
        )
    return json.dumps(features)


def evaluate(
    program: _hyped.Program,
    levels: Iterable[Level],
    goals: str | Sequence[str] | None = None,
    *,
    world: str | None = None,
    executor: Executor | None = None,
    cache: Cache = None,
    **options: Any,
) -> list[dict[str, Features]]:
    """Judges levels: for each of them, the features of each goal by its name.

    ``program`` leaves the map of a world open: each of ``levels`` fills it, see ``hyped.compile``. ``options`` are
    those of ``hyped.reach``: ``nodes``, ``seed``, ``within``, ``sigma`` and so on. Levels that are equal are judged
    once. With ``executor`` each level is a task; ``cache`` keeps answers by a hash of program, level and options. A
    level that cannot be compiled has the verdict ``"error"``; no exception is raised for it.

    Limits of ``nodes`` give the same features on every machine; those of ``seconds`` do not.
    """
    if not isinstance(program, _hyped.Program):
        raise QuestionError(f"`program` is a Program, not {type(program).__name__}")
    names = _names("goals", goals)
    kept: MutableMapping[str, str]
    if isinstance(cache, (str, os.PathLike)):
        kept = FolderCache(cache)
    else:
        kept = {} if cache is None else cache
    recipe, version = program._recipe(), f"{VERSION} {_hyped.VERSION}"
    keys: list[str] = []
    tasks: dict[str, str] = {}
    for level in levels:
        path, text = level_file(level)
        if text is None:
            with open(path, "rb") as file:
                content = hashlib.sha256(file.read()).hexdigest()
        else:
            content = text
        task = {"recipe": recipe, "goals": names, "world": world, "level": (path, text), "options": options}
        try:
            asked = json.dumps(task, sort_keys=True, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise QuestionError(f"`options` are those of `reach`, without `progress`: {error}") from None
        key = hashlib.sha256(f"{version}\n{content}\n{asked}".encode()).hexdigest()
        keys.append(key)
        if key not in kept:
            tasks.setdefault(key, asked)
    waiting = list(tasks.items())
    judged = map(_judged, tasks.values()) if executor is None else executor.map(_judged, tasks.values())
    for (key, _), found in zip(waiting, judged):
        kept[key] = found
    return [{of["goal"]: Features(**of) for of in json.loads(kept[key])} for key in keys]
