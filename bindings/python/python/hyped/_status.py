"""How the run of a row of a batch stands: the numbers of ``Batch.status``."""

from __future__ import annotations

RUNNING = 0
"""It goes on."""
GOAL = 1
"""A goal holds."""
NEVER = 2
"""A ``never`` holds."""
OUTSIDE = 3
"""A player has left the bounds of its space."""
FAULT = 4
"""The program broke a rule of the language in a step; the state is that before the step."""
TIME_UP = 5
"""All steps that it may take are taken."""
