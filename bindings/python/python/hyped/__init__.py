"""Game entities as hybrid automata: compile ``.hyped``, simulate in batches, search what a player can reach.

Lengths are in pixels (px), times in seconds (s), y points up.
"""

from __future__ import annotations

from hyped._ask import bounds, check, compile, explore, reach, stuck, tune, why, with_level
from hyped._errors import CompileError, Diagnostic, HypedError, Place, QuestionError, StepError, UnknownNameError
from hyped._hyped import Batch, Event, Planes, Program, Simulator, Variables, World
from hyped._registration import register as _register
from hyped._results import Answer, Bounds, Explored, Reached, Stuck, Trace, Tuned, Why, Witness, trace
from hyped._status import FAULT, GOAL, NEVER, OUTSIDE, RUNNING, TIME_UP

__all__ = [
    "FAULT",
    "GOAL",
    "NEVER",
    "OUTSIDE",
    "RUNNING",
    "TIME_UP",
    "Answer",
    "Batch",
    "Bounds",
    "CompileError",
    "Diagnostic",
    "Event",
    "Explored",
    "HypedError",
    "Place",
    "Planes",
    "Program",
    "QuestionError",
    "Reached",
    "Simulator",
    "StepError",
    "Stuck",
    "Trace",
    "Tuned",
    "UnknownNameError",
    "Variables",
    "Why",
    "Witness",
    "World",
    "bounds",
    "check",
    "compile",
    "explore",
    "reach",
    "stuck",
    "trace",
    "tune",
    "why",
    "with_level",
]

_register()
