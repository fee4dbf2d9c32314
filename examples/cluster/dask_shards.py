"""A search over many levels by Dask, one shard a task. The workers have `hypedc` and the folder of the game.

In that folder: python dask_shards.py [SCHEDULER], where SCHEDULER is an address such as tcp://10.0.0.1:8786. Without
it, the workers are processes of this machine.
"""

import subprocess
import sys
from pathlib import Path

from dask.distributed import Client, as_completed

SHARDS = 8


def shard(index: int, folder: str) -> str:
    """Runs a shard in the folder of the game; returns the file of its rows."""
    rows = f"rows.{index}.jsonl"
    command = "hypedc reach game.hyped --map levels --goal end --nodes 20000".split()
    done = subprocess.run(
        [*command, "--shard", f"{index}/{SHARDS}", "--results", rows], cwd=folder, capture_output=True, text=True
    )
    # Exit code 1 is an answer: some level has no way.
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr)
    return rows


def main() -> int:
    """Runs all shards and joins their rows."""
    client = Client(sys.argv[1]) if len(sys.argv) > 1 else Client(threads_per_worker=1, dashboard_address=None)
    with client:
        # A task whose worker is lost is given to another one, which goes on from its rows.
        tasks = client.map(shard, range(1, SHARDS + 1), folder=str(Path.cwd()), pure=False, retries=1)
        for task in as_completed(tasks):
            print(f"{task.result()} is done", file=sys.stderr)
        files = client.gather(tasks)
    return subprocess.run(["hypedc", "merge", *files, "-o", "all.jsonl"]).returncode


if __name__ == "__main__":
    sys.exit(main())
