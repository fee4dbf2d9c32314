#!/bin/bash
# A search over many levels as a Slurm job array, one shard a task. In the folder of the game: sbatch slurm.sh
#SBATCH --job-name=levels
#SBATCH --array=1-8
#SBATCH --cpus-per-task=1
#SBATCH --mem=3G
#SBATCH --time=02:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=shard.%a.log

# A task that was killed, or had to give way, comes again and goes on from its rows. Exit code 1 is an answer: some
# level has no way.
shard=$SLURM_ARRAY_TASK_ID
hypedc reach game.hyped --map levels --goal end --nodes 20000 --threads "$SLURM_CPUS_PER_TASK" \
  --shard "$shard/8" --results "rows.$shard.jsonl" || [ $? -eq 1 ]
