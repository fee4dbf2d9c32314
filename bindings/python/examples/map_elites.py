"""Evolves levels by MAP-Elites until some can be solved only with a wall jump.

    pip install 'hyped[generate]'
    python bindings/python/examples/map_elites.py [GENERATIONS]

Two climbers play each level, one of which can jump off rock. A level is good where the able one gets out and the other
one does not, or needs longer; levels are told apart by the length of the way and by the share of rock. `ribs` keeps the
best of each kind, and `hyped.generate.evaluate` judges each level once, on all cores.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import numpy.typing as npt
from ribs.archives import GridArchive
from ribs.emitters import GaussianEmitter
from ribs.schedulers import Scheduler

import hyped
from hyped.generate import Features, evaluate

COLUMNS, ROWS = 10, 12
NODES = 6_000

CLIMBER = """
entity Climber {
    param kick = 0
    axis walk
    button jump
    collider body: rect(0, 0, 12, 14)

    clamp y' >= -240

    envelope x' by walk {
        attack accel 900
        sustain 90
        release accel 900
    }
    initial mode air {
        y'' = -600
        when touching(body, solid, below) and y' <= 0 -> ground
        when pressed(jump) and kick > 0 and (touching(body, rock, left) or touching(body, rock, right)) { y' := kick }
    }
    mode ground {
        y' = 0
        when pressed(jump) -> air { y' := 200 }
        when not touching(body, solid, below) -> air
    }
}
world Shaft {
    collide body with solid: block
    tiles stone 16 x 16 { '.': empty; '#': solid, rock; '|': solid }
    space main {
        bounds rect(0, 0, 160, 400)
        map level stone
        place climber: Climber at (18, 16)
    }
    player 1: climber
    goal out: climber.y > 150
}
"""


def level(genes: npt.NDArray[np.float64]) -> list[str]:
    """Rows of a level: rock where a gene is great, in a frame of glass, off which nobody jumps."""
    rock = genes.reshape(ROWS - 2, COLUMNS - 2) > 1.3
    rows = ["|" + "".join("#" if is_rock else "." for is_rock in row) + "|" for row in rock]
    start = list(rows[-1])
    start[1:3] = ".."
    return ["|" + "." * (COLUMNS - 2) + "|", *rows[:-1], "".join(start), "|" * COLUMNS]


def score(able: Features, other: Features) -> float:
    """How much a level needs the wall jump: 2 where only that leads out."""
    if able.verdict != "reached" or able.steps is None:
        return -1.0
    if other.verdict == "reached" and other.steps is not None:
        return (other.steps - able.steps) / max(other.steps, able.steps)
    return 2.0 if other.verdict in ("proven-unreachable", "exhausted") else 1.0


def evolve(generations: int, batch: int = 12, seed: int = 1) -> GridArchive:
    """Runs MAP-Elites; the archive holds the best level of each kind."""
    able = hyped.compile(CLIMBER, params={"Climber.kick": 200})
    other = hyped.compile(CLIMBER)
    size = (ROWS - 2) * (COLUMNS - 2)
    archive = GridArchive(solution_dim=size, dims=(8, 6), ranges=[(40, 400), (0.0, 0.5)], seed=seed)
    emitter = GaussianEmitter(archive, sigma=0.6, x0=np.zeros(size), batch_size=batch, seed=seed)
    scheduler = Scheduler(archive, [emitter])
    kept: dict[str, str] = {}
    with ProcessPoolExecutor(os.cpu_count()) as executor:
        for generation in range(generations):
            solutions = scheduler.ask()
            levels = [level(genes) for genes in solutions]
            ours = evaluate(able, levels, "out", executor=executor, cache=kept, nodes=NODES)
            theirs = evaluate(other, levels, "out", executor=executor, cache=kept, nodes=NODES)
            objectives = [score(a["out"], b["out"]) for a, b in zip(ours, theirs)]
            rock = [sum(row.count("#") for row in rows[1:-1]) / size - 0.25 for rows in levels]
            measures = [[a["out"].steps or 0, share] for a, share in zip(ours, rock)]
            scheduler.tell(np.array(objectives), np.array(measures))
            best = archive.stats.obj_max
            print(f"generation {generation}: {archive.stats.num_elites} kinds, best {best:.2f}", flush=True)
            if best is not None and best >= 2.0:
                break
    return archive


def main() -> None:
    archive = evolve(int(sys.argv[1]) if len(sys.argv) > 1 else 40)
    best = archive.best_elite
    rows = level(best["solution"])
    print("\n".join(rows))
    for name, kick in (("with a wall jump", 200), ("without", 0)):
        program = hyped.compile(CLIMBER, level=rows, params={"Climber.kick": kick})
        answer = hyped.reach(program, "out", nodes=NODES)["out"]
        print(f"{name}: {answer.verdict}, {answer.witness.script if answer.witness else '; '.join(answer.reasons)}")


if __name__ == "__main__":
    main()
