"""The examples: the notebook's cells run and show pictures, the generator finds a level that needs the wall jump."""

from __future__ import annotations

import ast
import json
import runpy
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def test_the_notebook_shows_levels_and_ways() -> None:
    notebook = json.loads((EXAMPLES / "levels.ipynb").read_text(encoding="utf-8"))
    names: dict[str, Any] = {}
    pictures = 0
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, "cell", "exec"), names)
        if last is not None:
            shown = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
            if hasattr(shown, "_repr_svg_"):
                assert shown._repr_svg_().startswith("<svg")
                pictures += 1
    assert pictures >= 4


def test_map_elites_finds_a_level_that_needs_the_wall_jump(capsys: pytest.CaptureFixture[str]) -> None:
    example = runpy.run_path(str(EXAMPLES / "map_elites.py"))
    archive = example["evolve"](40)
    assert archive.stats.obj_max == 2.0 and archive.stats.num_elites >= 2
    assert "best 2.00" in capsys.readouterr().out
