"""The chart of speed against accuracy: its words for curves with known answers, and a tiny chart of Abbe and smallpt.

    python -m pytest tools/tests/test_chart.py      # 4 seconds of one core
"""

import csv
import json
import shutil
import subprocess

import numpy as np
import pytest
import render
from chart import command, curves, draw, findings, measure, scenes
from peers import povray
from peers import scene as peers_scene


def unbiased(seconds_at_one: float, times=(1, 4, 16, 64)):
    """Returns a curve whose error is the square root of seconds_at_one over the time."""
    return [(seconds_at_one * t, t**-0.5) for t in times]


def test_between_the_points_time_is_read_off_in_log_log():
    curve = [(1.0, 0.4), (100.0, 0.04)]
    assert curves.seconds_to(0.4 / 10**0.5, curve) == (pytest.approx(10), "measured")
    assert curves.seconds_to(0.04, curve) == (100, "measured")


def test_beyond_the_points_half_the_error_takes_four_times_the_time():
    assert curves.seconds_to(0.02, [(1.0, 0.4), (100.0, 0.04)]) == (pytest.approx(400), "extrapolated")
    assert curves.seconds_to(0.8, [(1.0, 0.4), (100.0, 0.04)]) == (pytest.approx(0.25), "extrapolated")


def test_a_biased_curve_is_compared_no_further_down_than_it_comes():
    ours, stuck = unbiased(0.01, (1, 16, 256, 4096)), [(1.0, 0.3), (4.0, 0.12), (16.0, 0.121)]
    assert curves.falling(stuck) == stuck[:2]
    assert curves.compare("A", ours, "B", stuck).startswith(
        "To 20 % A takes 0.14 x the CPU time of B (0.25 s for 1.8 s)"
    )


def test_a_curve_twice_as_slow_is_said_to_take_twice_the_time_at_both_ends():
    words = curves.compare("A", unbiased(2), "B", unbiased(1))
    assert words == "To 20 % A takes 2 x the CPU time of B (50 s for 25 s): behind; to 50 % 2 x."
    assert curves.compare("B", unbiased(1), "A", unbiased(2)).startswith("To 20 % B takes 0.5 x")


def test_curves_that_do_not_meet_in_error_are_extrapolated_and_say_so():
    words = curves.compare("A", [(1.0, 0.02), (4.0, 0.01)], "B", [(1.0, 0.4), (4.0, 0.2)])
    assert words == "To 2 % A takes 0.0025 x the CPU time of B (1 s for 4e+02 s, extrapolated): ahead."


def test_a_crossing_is_found_where_two_power_laws_meet():
    slow, fast = [(t, t**-0.5) for t in (1, 4, 16, 64)], [(t, 2 * t**-1.0) for t in (1.5, 4, 16, 64)]
    ((error, seconds),) = curves.crossings(slow, fast)
    assert (error, seconds) == (pytest.approx(0.5), pytest.approx(4))
    words = curves.compare("Slow", slow, "Fast", fast)
    assert "They cross at 50 % and 4 s; below that error Fast is faster." in words


def test_lines_that_weave_within_a_tie_do_not_cross():
    weaving = [(t * factor, t**-0.5) for t, factor in zip((1, 4, 16, 64), (1.1, 0.9, 1.1, 0.9), strict=True)]
    assert curves.crossings(weaving, unbiased(1)) == []
    assert curves.compare("A", unbiased(1), "B", weaving).count("a tie") == 1


def test_an_error_that_rare_paths_decide_is_not_steady():
    assert curves.steady(unbiased(1)) and curves.steady([(1.0, 0.5), (16.0, 0.2)])
    assert not curves.steady([(1.0, 0.071), (4.0, 0.085), (16.0, 0.076)])


def test_the_start_is_found_from_runs_of_two_lengths():
    assert measure.start_of([4, 16, 64], [0.5 + 4 * 0.1, 2.1, 0.5 + 64 * 0.1]) == pytest.approx(0.5)
    assert measure.start_of([4, 16], [0.4, 1.7]) == 0


def test_the_noise_of_the_reference_does_not_raise_the_error():
    random = np.random.default_rng(1)
    truth = np.ones((200, 200, 3))
    noisy = lambda sigma: truth + random.normal(0, sigma, truth.shape)  # noqa: E731
    reference = measure.Reference(noisy(0.03), noisy(0.03))
    _, rms = measure.error(noisy(0.2), reference)
    assert rms == pytest.approx(0.2, rel=0.02)  # 120 000 samples: one standard error is 0.3 %
    shared = noisy(0.03) - truth  # as if both used equal seeds
    brighter = measure.Reference(reference.first + 0.05 + shared, noisy(0.03) + 0.05)
    difference, unseen = measure.difference(brighter, reference)
    assert difference == pytest.approx(0.05 / 1.01**0.5, rel=0.05) and unseen < 0.01
    difference, unseen = measure.difference(measure.Reference(noisy(0.3), noisy(0.3)), reference)
    assert difference < 1.5 * unseen < 0.06  # 0.3^2 over the root of 120 000 values, twice, under a root: 2 %


def measured_with(fails_at: dict[str, int]) -> dict:
    """Measures a chart of Abbe, LuxCore, Cycles and Mitsuba, made of noise; each fails at the seed given for it."""

    class Noise:
        def __init__(self, label: str):
            self.label = label

        def run(self, samples: int, seed: int):
            if seed == fails_at.get(self.label):
                raise RuntimeError(f"{self.label} failed: Traceback\n  in a file\nout of memory")
            random = np.random.default_rng(100 * seed + samples)
            return 1 + random.normal(0, samples**-0.5, (8, 8, 3)), 0.1 * samples

    series = (
        scenes.abbe("Abbe", 4, 16),
        scenes.luxcore(4, 16),
        scenes.cycles(4, 16),
        scenes.mitsuba("scalar_rgb", 4, 16),
    )
    one = scenes.Chart("noise", "Noise", None, (8, 8), series)
    return measure.measure({s.label: Noise(s.label) for s in series}, one, scenes.QUICK)


@pytest.mark.parametrize("seed", [1, 3, *measure.HALVES, 1000])
def test_a_renderer_that_fails_in_the_middle_is_told_in_a_line_and_the_others_go_on(seed, capsys):
    label = "Mitsuba scalar, rgb" if seed == 1000 else "LuxCore"
    whole, found = measured_with({}), measured_with({label: seed})
    assert capsys.readouterr().out == f"{label} is left out, as it failed: out of memory\n"
    assert list(found) == [name for name in whole if name != label]
    assert [one.points for one in found.values()] == [whole[name].points for name in found]


def test_the_line_of_a_failure_is_the_one_that_says_why():
    assert measure.reason("loaded\nTraceback\nValueError: no such shape\n") == "ValueError: no such shape"
    assert measure.reason("error: no scene\nhelp: a scene is a file") == "error: no scene"
    assert measure.reason("error 1\nits process was ended by signal 9") == "its process was ended by signal 9"
    assert measure.reason("") == "it said nothing"


def test_a_chart_whose_first_series_fails_is_still_made_and_one_without_any_is_empty(capsys):
    assert list(measured_with({"Abbe": 2})) == ["LuxCore", "Blender Cycles", "Mitsuba scalar, rgb"]
    labels = ("Abbe", "LuxCore", "Blender Cycles", "Mitsuba scalar, rgb")
    assert measured_with(dict.fromkeys(labels, 10_000)) == {}
    assert capsys.readouterr().out.count("\n") == 5


def measured_as(points, start: float = 0.0):
    points = [measure.Point(1, seconds, error, error, error) for seconds, error in points]
    return measure.Measured(points, start, None, 0.0, 0.01, 1.0)


def test_of_an_error_that_rare_paths_decide_only_what_was_met_is_told():
    ours, theirs = measured_as([(0.1, 0.08), (0.4, 0.04)]), measured_as([(0.1, 0.5), (0.4, 0.3), (1.6, 0.6)])
    said = findings.unsteady_words("A", ours, "B", theirs)
    assert said.endswith("no ratio is told. Its best is 30 % in 0.4 s; A has 8 % in 0.1 s.")
    assert findings.unsteady_words("B", theirs, "A", ours).endswith("so that nothing is said of B and A.")


def test_a_row_of_the_table_says_what_the_words_say():
    one = scenes.CHARTS[2]._replace(common=None)
    found = {"A": measured_as(unbiased(2)), "B": measured_as(unbiased(1)), "C": measured_as([(1, 0.6), (4, 0.7)])}
    first, second = findings.table_rows(one, found)
    assert first == "| Cornell box | B | 2 x to 20 %, 2 x to 50 %: behind | less than 1 % |"
    assert second == "|  | C | no ratio: rare bright paths | less than 1 % |"


def test_a_biased_model_that_does_not_come_to_an_error_is_not_extrapolated():
    one = scenes.CHARTS[2]._replace(common="A")
    found = {"A": measured_as([(1, 0.15), (4, 0.07)]), "B": measured_as([(1, 0.19), (4, 0.16)])}
    assert findings.words_for(one, found)[0] == "B does not come to 15 %, where A begins."
    assert "it does not come to 15 %: ahead" in findings.table_rows(one, found)[0]


def test_the_time_before_the_first_sample_is_told_where_it_changes_the_ratio():
    slow, fast = measured_as(unbiased(2), 10.0), measured_as(unbiased(1), 5.0)
    assert findings.start_words("A", slow, fast) == ""
    slow = measured_as(unbiased(2), 50.0)
    assert findings.start_words("A", slow, fast) == " With the start of both A takes 3.3 x (1e+02 s for 30 s)."


def test_labels_keep_their_order_and_their_distance_inside_of_the_axes():
    heights = draw.spread([0.5, 0.52, 0.51, 0.0], 0.1, 0.05, 0.95)
    assert np.argsort(heights).tolist() == [3, 0, 2, 1]
    assert (np.diff(np.sort(heights)) > 0.099).all() and min(heights) >= 0.05


@pytest.mark.parametrize("one", scenes.CHARTS, ids=lambda one: one.name)
def test_every_series_of_ours_is_a_scene_that_the_renderer_accepts(one, tmp_path):
    for number, series in enumerate(series for series in one.series if series.renderer == "abbe"):
        scene = scenes.write_scene(one._replace(bumps=one.bumps and (6, 6)), series, tmp_path / f"{number}.toml")
        size = peers_scene.read(scene)["film"]
        assert (size["width"], size["height"]) == one.size
        run = subprocess.run([render.binary(), "--check", scene], capture_output=True, text=True, check=False)
        assert run.returncode == 0, f"{series.label}: {run.stderr}"


def test_the_lamp_of_pov_ray_sends_what_ours_sends():
    """By the formula of POV-Ray's manual, the irradiance below a small lamp is color x 2 / (1 + (d / fade)^2)."""
    text = povray.lamp_text({"center": [0, 2, 0], "u": [0.01, 0, 0], "v": [0, 0, 0.01]}, [5, 5, 5], 4)
    color = float(text.split("rgb <")[1].split(",")[0])
    fade = float(text.split("fade_distance ")[1].split()[0])
    assert color * 2 / (1 + (2 / fade) ** 2) == pytest.approx(5 * 0.02**2 / 2**2 / np.pi, rel=1e-3)


def test_a_tiny_chart_is_measured_drawn_and_written(tmp_path, monkeypatch, capsys):
    (whole,) = (one for one in scenes.CHARTS if one.name == "smallpt")
    series = tuple(one._replace(samples=one.samples[:2]) for one in whole.series if one.renderer in ("abbe", "smallpt"))
    names = [one.label for one in series if one.renderer == "abbe" or shutil.which("g++")]
    monkeypatch.setattr(scenes, "CHARTS", (whole._replace(size=(24, 18), series=series),))
    monkeypatch.setattr(scenes, "QUICK", scenes.Profile(1, 0, 4, 3))
    monkeypatch.setattr("sys.argv", ["chart.py", "--quick", "--out", str(tmp_path)])
    command.main()
    said = capsys.readouterr().out
    data = json.loads((tmp_path / "chart.json").read_text())
    (scene,) = data["scenes"]
    assert [one["label"] for one in scene["series"]] == names and data["versions"]["Abbe"].startswith("render")
    for one in scene["series"]:
        errors = [point["error"] for point in one["points"]]
        assert errors[0] > errors[1] > 0 and all(point["cpu_seconds"] > 0 for point in one["points"])
        assert one["kind"] == ("abbe" if one["label"] == "Abbe" else "other")
    assert all(words in said for words in scene["words"]) and len(scene["words"]) == 2 * (len(names) - 1)
    with (tmp_path / "chart.csv").open() as file:
        assert len(list(csv.DictReader(file))) == sum(len(one.samples) for one in series if one.label in names)
    assert (tmp_path / scene["png"]).read_bytes().startswith(b"\x89PNG")
    monkeypatch.setattr("sys.argv", ["chart.py", "--redraw", "--out", str(tmp_path)])
    command.main()
    assert json.loads((tmp_path / "chart.json").read_text()) == data
    assert "Abbe" in (tmp_path / scene["svg"]).read_text() and (tmp_path / "overview.png").is_file()
    kept = {**scene, "name": "cornell", "title": "kept"}
    (tmp_path / "chart.json").write_text(json.dumps({**data, "scenes": [kept]}))
    monkeypatch.setattr(scenes, "CHARTS", (whole._replace(name="cornell"), *scenes.CHARTS))
    monkeypatch.setattr(
        "sys.argv", ["chart.py", "--scene", "smallpt", "--side", "12", "--quick", "--out", str(tmp_path)]
    )
    command.main()
    first, second = json.loads((tmp_path / "chart.json").read_text())["scenes"]
    assert first["series"] == kept["series"] and (second["name"], second["size"]) == ("smallpt", [12, 9])
    table = (tmp_path / "table.md").read_text().splitlines()[2:]
    table = table[: len(table) // 2]
    assert len(table) == len(names) - 1 and all(row.count("|") == 5 for row in table)


@pytest.mark.parametrize(
    ("words", "said"),
    [(["--redraw"], "chart.json holds no chart to draw"), (["--side", "0"], "at least 4 pixels along a side")],
)
def test_what_cannot_be_drawn_is_refused_in_a_line(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["chart.py", *words, "--out", str(tmp_path)])
    with pytest.raises(SystemExit):
        command.main()
    assert said in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_chart_of_which_nothing_is_left_ends_without_pictures(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "run", lambda *_: {})
    monkeypatch.setattr("sys.argv", ["chart.py", "--scene", "smallpt", "--quick", "--out", str(tmp_path)])
    command.main()
    assert "wrote 0 charts" in capsys.readouterr().out and not list(tmp_path.glob("*.png"))
