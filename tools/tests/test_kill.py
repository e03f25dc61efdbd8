"""Renders that are killed at any moment, or run out of disk space: every file on disk is complete, and nothing is lost.

    KILLS=50 python -m pytest tools/tests/test_kill.py        # 10 by default
"""

import os
import random
import signal
import subprocess
import sys
import time

import pytest
from render import binary, read

KILLS = int(os.environ.get("KILLS", "10"))

SCENE = """
camera = { position = [0, 1.5, 6], look_at = [0, 0.7, 0], vertical_fov = 35 }
film = { width = 150, height = 90, layers = ["N", "lights", "CryptoObject"] }
render = { samples = 150, seed = 3, caustics = "off" }
[material]
floor.diffuse.reflectance = 0.6
glass.dielectric.index = 1.5
lamp.emissive.radiance = 8
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0, 0.8, 0], radius = 0.8 }
material = "glass"
[[object]]
shape.sphere = { center = [-1, 2.5, 1], radius = 0.2 }
material = "lamp"
"""

KEEP = ["--checkpoint", "30ms", "--snapshot", "30ms", "--resume"]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "s.toml").write_text(SCENE, "utf-8")
    return tmp_path


def start(folder, *flags):
    command = [str(binary()), "s.toml", *flags]
    return subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True)


def finished(folder, *flags):
    run = start(folder, *flags)
    said = run.communicate(timeout=600)[1]
    assert run.returncode == 0, said
    return said


def test_a_render_that_is_killed_again_and_again_loses_nothing(folder):
    began = time.monotonic()
    finished(folder, "--exr", "whole.exr")
    longest = 1.2 * (time.monotonic() - began)
    chance = random.Random(7)
    killed, snapshots, resumed = 0, 0, 0
    while killed < KILLS:
        run = start(folder, *KEEP)
        time.sleep(chance.uniform(0.0, longest))
        run.send_signal(signal.SIGKILL)
        said = run.communicate(timeout=600)[1]
        assert "panicked" not in said and "error:" not in said, said
        resumed += "going on from s.checkpoint" in said
        if run.returncode == 0:
            (folder / "s.checkpoint").unlink()
            (folder / "s.exr").unlink()
            continue
        killed += 1
        if (folder / "s.exr").exists():
            snapshots += 1
            assert read(folder / "s.exr").rgb.shape == (90, 150, 3)
    finished(folder, *KEEP)
    assert (folder / "s.exr").read_bytes() == (folder / "whole.exr").read_bytes()
    print(f"{killed} kills, {snapshots} times with a snapshot, {resumed} times resumed")
    assert resumed > KILLS / 4 and snapshots > 0


@pytest.mark.skipif(os.geteuid() != 0, reason="a small disk needs root")
def test_a_full_disk_loses_no_old_image_and_is_told(folder):
    disk = folder / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(disk)], check=False)
    if mounted.returncode:
        pytest.skip("no disk can be mounted here")
    try:
        for number in range(10):
            (disk / "s.exr").write_text("an image of last week", "utf-8")
            run = start(folder, "--exr", "disk/s.exr", "--samples", str(30 + number), "--checkpoint", "10ms")
            said = run.communicate(timeout=600)[1]
            assert run.returncode == 1 and "cannot write disk/s.exr: the disk is full" in said, said
            assert (disk / "s.exr").read_text("utf-8") == "an image of last week"
            assert [path.name for path in disk.iterdir()] == ["s.exr"]
    finally:
        subprocess.run(["umount", str(disk)], check=True)


@pytest.fixture
def unwritable(folder, request):
    """Makes a name in the folder under which nothing can be written, and yields the message about it."""
    place = folder / "place"
    if request.param == "file":
        place.write_text("no folder", "utf-8")
        yield "there is a file where its folder should be"
        return
    place.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "ro", "tmpfs", str(place)], check=False)
    if mounted.returncode:
        pytest.skip("no disk can be mounted here")
    try:
        yield "that disk is read-only"
    finally:
        subprocess.run(["umount", str(place)], check=True)


ROOT = pytest.mark.skipif(os.geteuid() != 0, reason="a disk that is mounted needs root")


@pytest.mark.parametrize("unwritable", ["file", pytest.param("disk", marks=ROOT)], indirect=True)
@pytest.mark.parametrize(
    "flags",
    [
        ["--exr", "place/s.exr"],
        ["--exr", "place/below/s.exr", "--snapshot", "1s"],
        ["--exr", "place/s.exr", "--shard", "1/2"],
        ["--exr", "s.exr", "--png", "place/s.png"],
        ["--plan", "--plan-file", "place/s.plan"],
    ],
    ids=lambda flags: flags[-2],
)
def test_a_place_that_cannot_be_written_to_is_told_before_the_render(folder, flags, unwritable):
    run = start(folder, *flags)
    said = run.communicate(timeout=600)[1]
    assert run.returncode == 1 and said.count("\n") == 1 and unwritable in said, said
    assert sorted(path.name for path in folder.iterdir()) == ["place", "s.toml"]


@pytest.mark.skipif(sys.platform == "win32", reason="there are no hangups")
@pytest.mark.parametrize("ignored", [True, False])
def test_a_render_outlives_its_terminal_where_nohup_asks_for_it(folder, ignored):
    action = signal.SIG_IGN if ignored else signal.SIG_DFL
    command = [str(binary()), "s.toml", "--samples", "100", "--checkpoint", "30ms"]
    prepare = lambda: signal.signal(signal.SIGHUP, action)
    run = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True, preexec_fn=prepare)
    while run.poll() is None and not list(folder.glob("*.checkpoint")):
        time.sleep(0.01)
    run.send_signal(signal.SIGHUP)
    said = run.communicate(timeout=600)[1]
    assert (run.returncode, (folder / "s.exr").is_file()) == ((0, True) if ignored else (130, False)), said
