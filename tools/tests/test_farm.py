"""Open Job Description renders an image in parts, and a model says how many make sense: tools/farm.

pytest tools/tests/test_farm.py
"""

import json
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import render
from farm.model import Work, fastest, forecast, most, slowest

TEMPLATE = render.ROOT / "tools/farm/frame.yaml"
OPENJD = Path(sys.executable).with_name("openjd")

SCENE = """
camera = { position = [0, 1.5, 6], look_at = [0, 0.7, 0], vertical_fov = 35 }
film = { width = 70, height = 50 }
render = { samples = 8, seed = 3 }
[material]
floor.diffuse.reflectance = 0.6
glass.dielectric.index = 1.5
lamp.emissive.radiance = 800
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
name = "ball"
shape.sphere = { center = [0, 0.8, 0], radius = 0.8 }
material = "glass"
[[object]]
shape.sphere = { center = [-1, 2.5, 1], radius = 0.02 }
material = "lamp"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "s.toml").write_text(SCENE, "utf-8")
    return tmp_path


def whole(folder, **flags):
    """Returns the bytes of the image from a single render."""
    render.write(folder / "s.toml", folder / "whole.exr", **flags)
    return (folder / "whole.exr").read_bytes()


def command(folder, **parameters):
    given = {"Scene": folder / "s.toml", "OutDir": folder / "out", "Render": render.binary(), **parameters}
    words = [word for name, value in given.items() for word in ("-p", f"{name}={value}")]
    return [str(OPENJD), "run", str(TEMPLATE), "--step", "Merge", "--run-dependencies", *words]


def run(folder, code=0, **parameters):
    """Returns the output of `openjd run`."""
    done = subprocess.run(command(folder, **parameters), capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout


def listing(folder):
    return sorted(path.name for path in (folder / "out").iterdir())


def test_the_template_is_one():
    checked = subprocess.run([str(OPENJD), "check", str(TEMPLATE)], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_eight_parts_are_together_the_bytes_of_one_render(folder):
    expected = whole(folder, samples=4, set="object.ball.shape.sphere.radius=0.7")
    setting = json.dumps(["object.ball.shape.sphere.radius=0.7"])
    said = run(folder, Name="ball of glass", Shards=8, Samples=4, Threads=1, Set=setting)
    assert (folder / "out/ball of glass.exr").read_bytes() == expected
    assert listing(folder) == ["ball of glass.exr"]
    assert said.count("Running Task") == 9
    told = [float(share) for share in re.findall(r"\topenjd_progress: (.+)", said)]
    assert min(told) == 0 and told.count(100) == 8
    for shard in range(1, 9):
        assert f"openjd_status: wrote {folder}/out/ball of glass.{shard}-of-8.part\n" in said


def test_a_part_that_fails_stops_the_job_and_those_that_are_there_are_not_made_again(folder):
    expected = whole(folder)
    in_the_way = folder / "out/frame.3-of-4.part"
    in_the_way.mkdir(parents=True)
    said = run(folder, code=1, Shards=4)
    assert re.search(r"\topenjd_fail: cannot write .*/frame\.3-of-4\.part: ", said), said
    assert "Running step 'Merge'" not in said
    made = [name for name in listing(folder) if name.endswith(".part")]
    assert made == ["frame.1-of-4.part", "frame.2-of-4.part", "frame.3-of-4.part"]
    in_the_way.rmdir()
    said = run(folder, Shards=4, KeepParts="true")
    assert said.count("and the image is written: nothing is left to do") == 2
    assert said.count("openjd_progress: 100.0") == 2
    assert (folder / "out/frame.exr").read_bytes() == expected
    kept = [f"frame.{part}-of-4.{kind}" for part in range(1, 5) for kind in ("checkpoint", "part")]
    assert listing(folder) == [*kept, "frame.exr"]


def test_a_canceled_task_keeps_what_is_done_and_goes_on_from_there(folder):
    expected = whole(folder, samples=1000)
    started = subprocess.Popen(command(folder, Shards=2, Samples=1000, Threads=1), stdout=subprocess.PIPE, text=True)
    # Ends a task that hangs, which would report nothing.
    timer = threading.Timer(300, started.kill)
    timer.start()
    said = ""
    for line in started.stdout:
        said += line
        # The second report comes a second after the first. A busy machine may still be tracing its first photons. It
        # finishes them, so that something is kept.
        if said.count("\topenjd_progress: ") == 2:
            started.send_signal(signal.SIGINT)
            break
    said += started.stdout.read()
    timer.cancel()
    assert started.wait(timeout=60) != 0, said
    assert "frame.1-of-2.checkpoint keeps what is done" in said and "Running step 'Merge'" not in said, said
    assert listing(folder) == ["frame.1-of-2.checkpoint"]
    said = run(folder, Shards=2, Samples=1000)
    assert re.search(r"openjd_status: going on from .*frame\.1-of-2\.checkpoint, which has [1-9]", said), said
    assert (folder / "out/frame.exr").read_bytes() == expected


# Ten seconds that every part repeats, and a thousand of tiles.
WORK = Work(start=1, load=2, plan=3, photons=4, tiles=1000, merge=5, merge_part=0.1, count=400)


def test_one_render_is_no_more_than_its_work():
    assert forecast(WORK, 1) == (1, 1010, 1010, pytest.approx(10 / 1010))


def test_parts_repeat_what_they_do_alike_and_share_their_tiles():
    parts, processor, time, overhead = forecast(WORK, 100)
    assert (parts, processor, time) == (100, 1000 + 1000 + 5 + 10, pytest.approx(10 + 10 + 5 + 10))
    assert overhead == pytest.approx(1 - 1000 / processor)


def test_parts_without_tiles_make_nothing_faster():
    assert slowest(WORK, 400) == 1 and slowest(WORK, 800) == 2
    assert forecast(WORK, 800).time > forecast(WORK, 400).time


def test_the_slowest_part_is_farther_from_the_mean_the_fewer_tiles_it_has():
    varied = WORK._replace(variation=0.5)
    ratios = [slowest(varied, parts) for parts in (1, 10, 100, 400)]
    assert ratios[0] == 1 and ratios == sorted(ratios)


def test_the_best_numbers_of_parts_are_those_beside_which_all_are_worse():
    for overhead in (0.1, 0.5, 0.9):
        count = most(WORK, overhead)
        assert forecast(WORK, count).overhead <= overhead < forecast(WORK, count + 1).overhead
    best = fastest(WORK, 10_000)
    assert best == 100  # where tiles / n^2 = merge_part
    assert [most(WORK._replace(tiles=tiles), 0.5) for tiles in (9, 11)] == [0, 1]


def test_a_forecast_is_made_of_what_is_measured_and_compared(tmp_path):
    scene = tmp_path / "s.toml"
    scene.write_text(
        """
camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
film = { width = 64, height = 48 }
material.matte.diffuse.reflectance = 0.6
light = [{ environment = { radiance = 1 } }]
[[object]]
shape.sphere = { center = [0, 0, 0], radius = 1 }
material = "matte"
""",
        "utf-8",
    )
    chart = tmp_path / "farm.png"
    words = [scene, "--samples", 16, "--verify", 1, 3, "--chart", chart]
    tool = [sys.executable, render.ROOT / "tools/farm.py", *words]
    run = subprocess.run(list(map(str, tool)), capture_output=True, text=True, check=False, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
    assert re.search(r"^12 tiles +[\d.]+ m?s$", run.stdout, re.MULTILINE), run.stdout
    assert re.search(r"^ 10000 +[\d.]+ (s|min) .* %$", run.stdout, re.MULTILINE), run.stdout
    assert "the image is there first with " in run.stdout
    assert chart.stat().st_size > 1000
