#!/bin/bash
# A search over many levels by GNU parallel, on this machine or on several with one file system.
# In the folder of the game: bash parallel.sh [SHARDS [OPTIONS OF PARALLEL]], as in bash parallel.sh 16 --sshlogin a,b
set -eu
shards=${1:-8}

# Exit code 1 is an answer: some level has no way. What failed otherwise is tried once more, and goes on from its rows.
parallel --retries 2 --joblog shards.log --workdir "$PWD" "${@:2}" \
  "hypedc reach game.hyped --map levels --goal end --nodes 20000 --quiet \
    --shard {}/$shards --results rows.{}.jsonl >shard.{}.log || [ \$? -eq 1 ]" ::: $(seq "$shards")
hypedc merge $(seq -f 'rows.%g.jsonl' "$shards") -o all.jsonl
