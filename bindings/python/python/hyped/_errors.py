"""Exceptions. Their text is what the command line prints."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Place:
    """A stretch of text.

    Lines and columns count from 1, columns in characters; ``end_line`` and ``end_column`` are behind the stretch.
    """

    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    label: str


@dataclass(frozen=True)
class Diagnostic:
    """A finding of the compiler.

    ``severity`` is ``"error"`` or ``"warning"``; ``file``, ``line`` and ``column`` are those of the place that it is
    about, None if it is about no place. ``labels`` are all places, that one first. ``help`` are the ways out.
    """

    code: str
    severity: str
    message: str
    file: str | None
    line: int | None
    column: int | None
    labels: tuple[Place, ...]
    help: tuple[str, ...]
    notes: tuple[str, ...]


def _place(record: dict[str, Any]) -> Place:
    start, end = record["start"], record["end"]
    return Place(record["file"], start["line"], start["column"], end["line"], end["column"], record["label"])


def diagnostics(findings: str) -> tuple[Diagnostic, ...]:
    """The findings of a record as ``hypedc check --format json`` writes it."""
    found = []
    for record in json.loads(findings)["findings"]:
        primary = record["primary"]
        labels = [_place(of) for of in ([primary] if primary else []) + record["related"]]
        first = labels[0] if primary else None
        found.append(
            Diagnostic(
                code=record["code"],
                severity=record["severity"],
                message=record["message"],
                file=first.file if first else None,
                line=first.line if first else None,
                column=first.column if first else None,
                labels=tuple(labels),
                help=tuple(record["helps"]),
                notes=tuple(record["notes"]),
            )
        )
    return tuple(found)


class HypedError(Exception):
    """The base of all exceptions of this package."""


class CompileError(HypedError):
    """A program has errors. ``str`` of it is what the terminal shows; ``diagnostics`` are the findings."""

    def __init__(self, text: str, colored: str = "", findings: str = '{"findings": []}') -> None:
        super().__init__(text, colored, findings)
        self.colored = colored
        self.diagnostics = diagnostics(findings)

    def __str__(self) -> str:
        return str(self.args[0]).rstrip()


class QuestionError(HypedError, ValueError):
    """Something cannot be asked or done: an unknown name, a value out of its range. The text says what there is."""


class StepError(HypedError, ArithmeticError):
    """A program broke a rule of the language in a step: the text names the place. The state is that before the step."""


class UnknownNameError(QuestionError, KeyError):
    """A name that there is not, as in ``run["hero.z"]``. The text says which there are."""

    # KeyError shows the representation of its text: line breaks as \n.
    __str__ = Exception.__str__
