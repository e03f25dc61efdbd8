#!/bin/sh
#SBATCH --job-name=shard
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#
# One of the parts of an image, as a task of a Slurm array. After N, SCENE and IMAGE it takes what else `render` takes:
#
#     sbatch --array=1-N tools/farm/shard.sh N SCENE.toml IMAGE.exr [--samples 64 ..]
#
# Two minutes before the time limit it keeps what is done in a checkpoint, and the task goes on in another turn: the limit
# has to be longer than two minutes and the plan together. A task that is preempted, or whose node fails, goes on as well.
#
# RENDER is the command, if it is not called `render`.

set -u
count=$1 scene=$2 image=$3
shift 3

"${RENDER:-render}" "$scene" --exr "$image" --shard "$SLURM_ARRAY_TASK_ID/$count" --threads "$SLURM_CPUS_ON_NODE" \
    --checkpoint 60s --resume "$@" &
render=$!
late=
trap 'late=yes; kill -TERM $render' USR1
# Slurm sends this to all processes of the task.
trap : TERM

# A signal ends the waiting, not what is waited for.
wait $render
code=$?
while kill -0 $render 2> /dev/null; do
    wait $render
    code=$?
done

# 130 says that it was stopped and can go on.
if [ "$late" ] && [ $code -eq 130 ]; then
    # The number of the job is, for one of the tasks, that of the whole array.
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit $code
