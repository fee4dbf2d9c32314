"""Compiling: sources, levels, numbers, errors."""

from __future__ import annotations

import copy
import pickle
import subprocess

import numpy as np
import pytest

import hyped
from conftest import BALL


def test_a_path_and_its_text_are_the_same_program() -> None:
    path = "examples/balloon.hyped"
    with open(path, encoding="utf-8") as file:
        text = file.read()
    assert hyped.compile(path).sha256 == hyped.compile(text, folder="examples").sha256


def test_errors_print_as_on_the_terminal(hypedc: str, tmp_path: object) -> None:
    path = f"{tmp_path}/wrong.hyped"
    text = BALL.replace("-> fly", "-> flies").replace("ball.x > 200", "ball.q > 200")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    shown = subprocess.run([hypedc, "check", path], capture_output=True, text=True, check=False)
    with pytest.raises(hyped.CompileError) as caught:
        hyped.compile(path)
    error = caught.value
    assert str(error) and str(error) in shown.stdout + shown.stderr
    assert len(error.diagnostics) >= 2
    first = error.diagnostics[0]
    assert (first.severity, first.file) == ("error", path)
    assert first.line is not None and "flies" in text.splitlines()[first.line - 1]
    assert first.labels[0].line == first.line and first.column == first.labels[0].column
    assert first.code.startswith("E") and first.message and first.help
    assert "\x1b[" in error.colored and "\x1b[" not in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.diagnostics) == (str(error), error.diagnostics)


def test_numbers_are_set() -> None:
    slow, fast = (
        hyped.Simulator(hyped.compile("examples/balloon.hyped", params={"Balloon.drift": v})) for v in (20, 80)
    )
    slow.step(count=60)
    fast.step(count=60)
    assert slow["balloon.x"] == pytest.approx(20) and fast["balloon.x"] == pytest.approx(80)
    with pytest.raises(hyped.CompileError, match="Balloon.drift"):
        hyped.compile("examples/balloon.hyped", params={"Balloon.drif": 20})


def test_levels_are_paths_texts_rows_and_arrays() -> None:
    path = "examples/smb/mario-1-1.txt"
    of_path = hyped.compile("examples/smb/smb.hyped", level=path)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    tiles = of_path.world().tiles()
    assert ["".join(row) for row in tiles] == text.split()
    rows = text.split()
    for level in (text, rows, np.array([list(row) for row in rows])):
        assert hyped.compile("examples/smb/smb.hyped", level=level).sha256 == of_path.sha256
    other = hyped.with_level(of_path, [row.replace("E", "-") for row in rows])
    assert other.sha256 != of_path.sha256


def test_a_program_can_be_pickled() -> None:
    program = hyped.compile("examples/paper/test1.hyped")
    again = pickle.loads(pickle.dumps(program))
    assert again.sha256 == program.sha256 and again.path == program.path
    run = hyped.Simulator(program, seed=3)
    run.step("right", count=7)
    for other in (pickle.loads(pickle.dumps(run)), copy.copy(run), copy.deepcopy(run)):
        assert (other.hash(), other.steps, other.seed) == (run.hash(), 7, 3)


def test_findings_of_the_analysis() -> None:
    program = hyped.compile(BALL)
    assert program.warnings == ""
    assert all(isinstance(of, hyped.Diagnostic) for of in hyped.check(program))


@pytest.mark.parametrize("source", ["", "no/such.hyped", "examples", "/dev/zero"])
def test_unreadable_programs(source: str) -> None:
    with pytest.raises(hyped.CompileError):
        hyped.compile(source)
