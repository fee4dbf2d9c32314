"""What tests share: the examples of the repository, and a small program."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
os.chdir(ROOT)

BALL = """
entity Ball {
    button up
    x' = 60
    collider body: rect(0, 0, 16, 16)
    mode fly {
        y' = 30
        when not held(up) -> fall
    }
    initial mode fall {
        y' = -30
        when held(up) -> fly
    }
}
world Sky {
    collide body with rock: block
    tiles land 16 x 16 { '.': empty; '#': rock }
    space main {
        bounds rect(0, 0, 320, 64)
        map land "
            ..........#.........
            ....................
            ....................
            ####................
        "
        place ball: Ball at (0, 24)
    }
    player 1: ball
    goal far: ball.x > 200
    never low: ball.y < 4
}
"""


def programs() -> list[Path]:
    """All programs of the examples."""
    found = sorted((ROOT / "examples").rglob("*.hyped"))
    assert len(found) > 20
    return [path.relative_to(ROOT) for path in found]


@pytest.fixture(scope="session")
def hypedc() -> str:
    """The command line, to compare with."""
    path = os.environ.get("HYPEDC") or shutil.which("hypedc") or str(ROOT / "target/release/hypedc")
    assert os.access(path, os.X_OK), "HYPEDC is the path of the command line: cargo build --release"
    return path
