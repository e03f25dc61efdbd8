"""Slurm renders an image in parts: tools/farm/shard.sh, on a controller and a node that the test starts.

pytest tools/tests/test_slurm.py
"""

import getpass
import os
import shutil
import socket
import subprocess
import time
from contextlib import ExitStack

import pytest
import render
from test_farm import folder, whole  # noqa: F401

COMMANDS = ["slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol", "sinfo"]
SHARD = render.ROOT / "tools/farm/shard.sh"
SECONDS = 120

# The minimum that a cluster needs. The node has no keys, because it serves only this test.
CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
KillWait=10
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def until(found, what):
    end = time.monotonic() + SECONDS
    while not found():
        assert time.monotonic() < end, f"{what} after {SECONDS} s"
        time.sleep(0.1)


class Cluster:
    """The commands of a Slurm that runs in a folder."""

    def __init__(self, folder):
        self.configuration = folder / "slurm.conf"
        inherited = {name: value for name, value in os.environ.items() if not name.startswith(("SLURM", "SBATCH"))}
        self.environment = inherited | {"SLURM_CONF": str(self.configuration), "RENDER": str(render.binary())}

    def run(self, *words, folder=None):
        command = list(map(str, words))
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=60, env=self.environment, cwd=folder
        )
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
        return done.stdout.strip()

    def submit(self, folder, shards, *flags, tasks=None):
        """Submits an array of parts, and the job that merges them; returns the numbers of both jobs."""
        array = ["--parsable", f"--array={tasks or f'1-{shards}'}", "--output=%a.log", SHARD]
        job = self.run("sbatch", *array, shards, "s.toml", "out/s.exr", *flags, folder=folder)
        merge = f'"$RENDER" merge --delete out/s.exr out/s.*-of-{shards}.part'
        after = ["--parsable", f"--dependency=afterok:{job}", "--kill-on-invalid-dep=yes", "--output=merge.log"]
        return job, self.run("sbatch", *after, "--wrap", merge, folder=folder)

    def state(self, job):
        return self.run("scontrol", "show", "job", job, "--oneliner").split("JobState=")[1].split()[0]

    def wait(self, job):
        until(lambda: self.state(job) not in ("PENDING", "RUNNING", "COMPLETING"), f"job {job} is not done")
        return self.state(job)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    missing = [name for name in COMMANDS if shutil.which(name) is None]
    if missing:
        pytest.skip(f"Slurm is not installed: there is no {missing[0]} (Debian: slurm-wlm)")
    folder = tmp_path_factory.mktemp("slurm")
    for name in ("state", "spool"):
        (folder / name).mkdir()
    found = Cluster(folder)
    host, user, processors = socket.gethostname().split(".")[0], getpass.getuser(), os.cpu_count()
    text = CONFIGURATION.format(host=host, user=user, processors=processors, ports=free_ports(2), folder=folder)
    found.configuration.write_text(text, "utf-8")
    with ExitStack() as stack:
        for name in ("slurmctld", "slurmd"):
            log = stack.enter_context((folder / f"{name}.log").open("w"))
            command = [name, "-D", "-f", str(found.configuration)]
            daemon = subprocess.Popen(command, stdout=log, stderr=log, env=found.environment)
            stack.callback(daemon.wait, 60)
            stack.callback(daemon.terminate)
        idle = ["sinfo", "--noheader", "--format=%t"]
        ask = dict(capture_output=True, text=True, check=False, env=found.environment)
        until(lambda: subprocess.run(idle, **ask).stdout.strip() == "idle", "the node is not idle")
        yield found
        found.run("scancel", "--user", user)


def logs(folder):
    return "".join(f"{path.name}: {path.read_text('utf-8')}" for path in sorted(folder.glob("*.log")))


def test_an_array_of_eight_makes_the_bytes_of_one_render(cluster, folder):
    expected = whole(folder, samples=4)
    _, merge = cluster.submit(folder, 8, "--samples", "4")
    assert cluster.wait(merge) == "COMPLETED", logs(folder)
    assert (folder / "out/s.exr").read_bytes() == expected
    assert [path.name for path in (folder / "out").iterdir()] == ["s.exr"]


def test_a_task_that_runs_out_of_time_goes_on_in_another_turn(cluster, folder):
    expected = whole(folder, samples=2000)
    array, merge = cluster.submit(folder, 2, "--samples", "2000")
    log = folder / "2.log"
    until(lambda: log.exists() and "the render starts" in log.read_text("utf-8"), "the task has not begun")
    time.sleep(1)
    # Slurm sends this signal before the time limit. The last task has the number of the array.
    cluster.run("scancel", "--batch", "--signal=USR1", f"{array}_2")
    assert cluster.wait(merge) == "COMPLETED", logs(folder)
    said = log.read_text("utf-8")
    assert "out/s.2-of-2.checkpoint keeps what is done" in said and "going on from out/s.2-of-2.checkpoint" in said, said
    assert logs(folder).count("the render starts") == 2, logs(folder)
    assert (folder / "out/s.exr").read_bytes() == expected


def test_a_task_that_is_canceled_keeps_what_is_done_and_the_merge_is_canceled(cluster, folder):
    array, merge = cluster.submit(folder, 2, "--samples", "100000")
    until(lambda: "the render starts" in logs(folder), "no task has begun")
    cluster.run("scancel", array)
    assert cluster.wait(merge) == "CANCELLED", logs(folder)
    until(lambda: "keeps what is done" in logs(folder), "no checkpoint was told")
    assert (folder / "out/s.1-of-2.checkpoint").exists() and not (folder / "out/s.exr").exists()


def test_a_part_that_fails_stops_the_merge_and_is_rendered_alone_later(cluster, folder):
    expected = whole(folder)
    in_the_way = folder / "out/s.2-of-3.part"
    in_the_way.mkdir(parents=True)
    array, merge = cluster.submit(folder, 3)
    assert cluster.wait(merge) == "CANCELLED", logs(folder)
    assert [cluster.wait(f"{array}_{task}") for task in (1, 2, 3)] == ["COMPLETED", "FAILED", "COMPLETED"]
    in_the_way.rmdir()
    _, merge = cluster.submit(folder, 3, tasks="2")
    assert cluster.wait(merge) == "COMPLETED", logs(folder)
    assert (folder / "out/s.exr").read_bytes() == expected
