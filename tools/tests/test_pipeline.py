"""A program drives the renderer and reads only its JSON.

    pytest tools/tests/test_pipeline.py
"""

import contextlib
import json
import os
import subprocess
import sys

import jsonschema
import numpy as np
import pytest
import render

SCHEMA = json.loads((render.ROOT / "tools/events.schema.json").read_text("utf-8"))
TURNTABLE = render.ROOT / "examples/turntable.toml"
SMALL = ("--set", "film.width=24", "--set", "film.height=16", "--samples", "2")


def events(*arguments, code=0):
    """Returns the events that the command prints with --json, after checking each line against the schema."""
    command = [str(render.binary()), "--json", *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert (run.returncode, run.stderr) == (code, "")
    said = [json.loads(line) for line in run.stdout.splitlines()]
    for event in said:
        jsonschema.validate(event, SCHEMA)
    return said


def kinds(said):
    return list(dict.fromkeys(event["kind"] for event in said))


def test_the_schema_is_a_schema_and_refuses_what_it_does_not_know():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate({"kind": "written", "path": "a.exr"}, SCHEMA)
    for wrong in (
        {},
        {"kind": "gift"},
        {"kind": "written"},
        {"kind": "written", "path": 3},
        {"kind": "written", "path": "a.exr", "size": 3},
        {"kind": "progress", "done": -1, "total": 3, "seconds": 0.1, "seconds_left": None},
        {"kind": "error", "message": "no", "file": None, "line": 0, "column": 1, "help": None},
    ):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, SCHEMA)


def test_each_of_several_frames_is_told_before_all_that_is_said_of_it(tmp_path):
    said = events(TURNTABLE, "--exr", tmp_path / "a%d.exr", "--frame", "3-7x4", *SMALL)
    frames = [event for event in said if event["kind"] == "frame"]
    assert frames == [{"kind": "frame", "frame": frame, "number": n, "count": 2} for n, frame in ((1, 3), (2, 7))]
    told = [event["kind"] for event in said if event["kind"] in ("frame", "plan", "report", "written")]
    assert told == ["frame", "plan", "report", "written"] * 2
    one = events(TURNTABLE, "--exr", tmp_path / "a%d.exr", "--frame", "3", *SMALL)
    assert "frame" not in kinds(one)


def test_all_that_is_said_of_a_render_is_in_the_schema(tmp_path):
    exr, png = tmp_path / "a.exr", tmp_path / "a.png"
    said = events(TURNTABLE, "--exr", exr, "--png", png, "--spectral", *SMALL, "--set", "set.spare=1")
    assert kinds(said) == ["warning", "plan", "progress", "report", "written"]
    (plan,) = (event for event in said if event["kind"] == "plan")
    (report,) = (event for event in said if event["kind"] == "report")
    assert plan["samples"] == 2 and report["samples"] == 24 * 16 * 2
    written = [event["path"] for event in said if event["kind"] == "written"]
    assert written == [str(exr), str(exr.with_suffix(".spectral.exr")), str(png)]
    assert render.read(exr).rgb.shape == (16, 24, 3)


def test_an_error_that_is_asked_for_is_told_and_the_report_keeps_all(tmp_path):
    exr, kept = tmp_path / "a.exr", tmp_path / "a.json"
    small = ("--set", "film.width=24", "--set", "film.height=16")
    said = events(TURNTABLE, "--exr", exr, "--error", "0.2", "--report", kept, *small)
    (plan,) = (event for event in said if event["kind"] == "plan")
    (report,) = (event for event in said if event["kind"] == "report")
    assert plan["samples"] == 65536 and plan["photons"] is None and plan["processor_seconds"] is None
    error = report["error"]
    assert error["is_reached"] and error["stopped_by"] == "error" and error["at_most"] <= 0.2
    assert error["samples_per_pixel"] * 24 * 16 == report["samples"]
    assert report["peak_memory_bytes"] > 1e6 and report["processor_seconds"] > 0
    account = json.loads(kept.read_text("utf-8"))
    for event in (account["plan"], account["report"]):
        jsonschema.validate(event, SCHEMA)
    assert account["written"] == [str(exr)] and account["report"]["error"] == error
    header = render.read(exr).header
    assert header["render/stoppedBy"] == "error" and header["render/samples"] == error["samples_per_pixel"]
    assert header["render/errorAtMost"] == pytest.approx(error["at_most"], rel=1e-12)


def test_what_is_no_error_and_no_time_is_refused(tmp_path):
    for flag, value in (("--error", "0"), ("--error", "-1"), ("--error", "nan"), ("--error", "2"), ("--time", "5"), ("--time", "0s")):
        (mistake,) = events(TURNTABLE, flag, value, "--exr", tmp_path / "a.exr", code=2)
        assert mistake["kind"] == "error"
    (tmp_path / "file").write_text("")
    (mistake,) = events(TURNTABLE, "--exr", tmp_path / "a.exr", "--report", tmp_path / "file/a.json", code=1)
    assert mistake["kind"] == "error" and not (tmp_path / "a.exr").exists()


def test_checks_plans_and_mistakes_are_in_the_schema(tmp_path):
    assert kinds(events(TURNTABLE, "--check")) == ["checked"]
    assert kinds(events(TURNTABLE, "--plan", *SMALL)) == ["plan"]
    assert kinds(events(TURNTABLE, "--set", "film.width=x", code=2)) == ["error"]
    assert kinds(events(tmp_path / "no.toml", code=2)) == ["error"]
    assert kinds(events(TURNTABLE, "--sampels", "3", code=2)) == ["error"]
    (tmp_path / "file").write_text("")
    assert kinds(events(TURNTABLE, "--exr", tmp_path / "file/a.exr", code=1)) == ["error"]


def test_a_turntable_of_eight_frames_is_driven_by_twenty_lines(tmp_path):
    driver = render.ROOT / "examples/turntable.py"
    assert len(driver.read_text("utf-8").splitlines()) <= 20
    environment = {**os.environ, "RENDER": str(render.binary())}
    command = [sys.executable, str(driver), str(tmp_path), *SMALL]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600, env=environment)
    assert (run.returncode, run.stderr) == (0, "")
    names = [f"turntable.{frame:04}.exr" for frame in range(1, 9)]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    frames = [render.read(tmp_path / name) for name in names]
    # Noise is the same in each frame, so frames differ only by the rotation.
    for frame, other in zip(frames, frames[1:] + frames[:1], strict=True):
        assert np.mean(np.abs(frame.channels["Z"] - other.channels["Z"]) > 0.01) > 0.05
    assert all(f"written {tmp_path / name}" in run.stdout for name in names)


def test_a_driver_without_a_folder_says_how_it_is_called():
    for driver in ("turntable.py", "python/turntable.py"):
        command = [sys.executable, str(render.ROOT / "examples" / driver)]
        run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        if "No module named 'abbe'" not in run.stderr:
            assert run.returncode == 1 and "turntable.py FOLDER" in run.stderr and "Traceback" not in run.stderr


def test_a_driver_stops_at_a_mistake_and_says_it(tmp_path):
    environment = {**os.environ, "RENDER": str(render.binary())}
    command = [sys.executable, str(render.ROOT / "examples/turntable.py"), str(tmp_path), "--set", "film.widht=3"]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600, env=environment)
    assert (run.returncode, run.stdout) == (2, "frame 1: error unknown key `widht`\n")


@pytest.mark.skipif(os.name == "nt", reason="there are no pseudo-terminals")
def test_on_a_terminal_a_render_says_what_matters_of_its_plan_and_elsewhere_all(tmp_path):
    import pty

    command = [str(render.binary()), str(TURNTABLE), *SMALL, "--exr", str(tmp_path / "a.exr")]
    all_of_it = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600).stderr.splitlines()
    ours, theirs = pty.openpty()
    with subprocess.Popen(command, stderr=theirs) as run:
        os.close(theirs)
        said = b""
        # Reading from a terminal that has been closed raises an error.
        with contextlib.suppress(OSError):
            while more := os.read(ours, 4096):
                said += more
    os.close(ours)
    assert run.returncode == 0
    lines = [line.strip() for line in said.decode("utf-8").splitlines()]
    end = lines.index("(--plan explains how and why)")
    assert lines[0].startswith("cost: ") and lines[1:end] == all_of_it[1:end] and end < 5
    assert all_of_it[end].startswith("model ") and not any(line.startswith("model ") for line in lines)
