"""The examples in docstrings and in the stubs of the extension module."""

from __future__ import annotations

import ast
import doctest
import os
import re
from pathlib import Path

import pytest

import hyped
from conftest import ROOT

FOLDER = os.path.dirname(hyped.__file__)
TEXT = """entity Ball {
    button up
    x' = 60
    initial mode fall { y' = -30; when held(up) -> fly }
    mode fly { y' = 30; when not held(up) -> fall }
}
world Sky {
    space main { place ball: Ball at (0, 0) }
    player 1: ball
    goal high: ball.y > 20
}"""


def docstrings(name: str) -> list[doctest.DocTest]:
    """The examples of all docstrings of a file."""
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        tree = ast.parse(file.read())
    parser, found = doctest.DocTestParser(), []
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
            names = {
                "TEXT": TEXT,
                "hyped": hyped,
                "compile": hyped.compile,
                "reach": hyped.reach,
                "explore": hyped.explore,
                "bounds": hyped.bounds,
                "CompileError": hyped.CompileError,
            }
            where = f"{name} {getattr(node, 'name', '')}"
            found.append(parser.get_doctest(ast.get_docstring(node) or "", names, where, name, 0))
    return [test for test in found if test.examples]


@pytest.mark.parametrize("name", sorted(of for of in os.listdir(FOLDER) if of.endswith((".py", ".pyi"))))
def test_examples(name: str) -> None:
    runner = doctest.DocTestRunner()
    for test in docstrings(name):
        assert runner.run(test).failed == 0, test.name


def test_there_are_examples() -> None:
    assert sum(len(test.examples) for name in ("_ask.py", "env.py", "_hyped.pyi") for test in docstrings(name)) >= 20


def test_everything_public_is_described() -> None:
    for name in hyped.__all__:
        of = getattr(hyped, name)
        assert isinstance(of, int) or of.__doc__, name


def test_the_page_of_the_book_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) >= 6
    # What a block writes stays here.
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    names = {"levels": ["examples/smb/mario-1-1.txt"]}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert names["found"][0]["end"].verdict == "reached" and names["answer"].verdict == "reached"
