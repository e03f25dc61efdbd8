"""The report in a real headless Chromium: it requests nothing, fits, is legible, and its charts show their figures.

    pytest tools/tests/test_report.py       # screenshots in target/report/

Skipped, with the reason, if no Chromium can be installed.
"""

import json
import re
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest
import render
from browser import command as browser
from report import command as report
from report import parts as report_parts
from stability import command as stability
from stability.plot import Plot, Series

# Contrast (WCAG 2.2, 1.4.3) and font size of every element with text of its own.
LEGIBLE = """() => {
  const channel = (c) => (c /= 255, c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const luminance = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
  const color = (text) => text.match(/[\\d.]+/g).map(Number);
  const ground = (e) => {
    for (; e; e = e.parentElement) {
      const c = color(getComputedStyle(e).backgroundColor);
      if (c.length === 3 || c[3] > 0) return c;
    }
    return [255, 255, 255];
  };
  let smallest = 99, contrast = 99, worst = "";
  for (const e of document.querySelectorAll("body *")) {
    if (e.closest("script, [hidden]") || ![...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim())) continue;
    const style = getComputedStyle(e);
    smallest = Math.min(smallest, parseFloat(style.fontSize));
    const svg = e.namespaceURI.includes("svg");
    const [a, b] = [luminance(color(svg ? style.fill : style.color)), luminance(ground(e))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < contrast) [contrast, worst] = [ratio, e.textContent.slice(0, 60)];
  }
  return { smallest, contrast, worst };
}"""


def plot(row):
    x = 10.0 ** np.arange(5)
    series = [
        Series("a method that\nfails", x, x * 1e-6),
        Series("Abbe, rendered", x, np.array([0, 1e-8, 1e-8, 2e-8, 0]), True),
    ]
    return Plot(row, f"Something hard of row {row}", "how hard", "error", series, f"It fails & <fails> by row {row}.")


def sample_results(folder):
    """Writes made-up results of the tools."""
    random = np.random.default_rng(1)
    rows = []
    for i in range(130):
        z = random.standard_normal(3)
        verdict = "fail: 5 standard errors off" if i == 7 else "pass"
        rows.append(
            {
                "group": ("energy", "optics", "transport", "color")[i % 4],
                "name": f"row {i}: glass sphere of index 1.{i} under an even sky, seen from {i} degrees",
                "formula": "T = (1 - r) / (1 + r), r of Fresnel <1823>",
                "expected": [1 / 3, 0.5, 0.7] if i % 2 else 0.25,
                "measured": [1 / 3 + 1e-4, 0.5, 0.7] if i % 2 else 0.2501,
                "standard_error": [1e-4, 1e-4, 1e-4] if i % 2 else 0.0,
                "z": z.tolist() if i % 2 else None,
                "guards_against": "Schlick for Fresnel",
                "effect": 0.01,
                "verdict": verdict,
            }
        )
    book = {"version": "render 0.1.0", "made_by": "python tools/validate.py", "rows": rows}
    kinds = [
        ("Abbe, bands 8", "abbe", 1.0),
        ("Abbe, hero", "abbe", 2.0),
        ("Mitsuba 3, LLVM", "other", 0.8),
        ("smallpt", "other", 5.0),
    ]
    series = [
        {
            "label": label,
            "kind": kind,
            "points": [
                {"samples": n, "cpu_seconds": 0.05 * cost * n, "error": 0.3 / np.sqrt(n)} for n in (1, 4, 16, 64)
            ],
        }
        for label, kind, cost in kinds
    ]
    scenes = [
        {
            "name": name,
            "title": f"Spheres of {name}",
            "words": ["To 1 % Abbe needs 0.8 x the time of smallpt."],
            "series": series,
            "svg": "",
            "png": "",
        }
        for name in ("cornell", "smallpt")
    ]
    for tool, value in (("validate", book), ("chart", {"versions": {"Mitsuba": "3.7"}, "scenes": scenes})):
        (folder / tool).mkdir()
        (folder / tool / report.FILES[tool]).write_text(json.dumps(value))
    (folder / "stability").mkdir()
    plots = [stability.keep(plot(row), folder / "stability") for row in ("S1", "W2")]
    table = [
        {
            "row": f"S{i}",
            "name": "what fails",
            "remedy": "what helps",
            "test": f"shapes.rs::s{i}_a_very_long_test_name_without_a_break",
        }
        for i in range(30)
    ]
    (folder / "stability/stability.json").write_text(json.dumps({"plots": plots, "rows": table}))


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    sample_results(folder)
    report.write(folder, folder / "index.html")
    return folder / "index.html"


@pytest.fixture(scope="module")
def chromium():
    try:
        browser.program()
    except browser.NoBrowser as reason:
        pytest.skip(str(reason))
    with browser.chromium() as running:
        yield running


@pytest.fixture
def opened(chromium, samples):
    """Opens the page at a width in a color scheme; checks that nothing was written to the console or requested."""
    contexts, complaints, requests = [], [], []

    def open_page(width, scheme="light", **settings):
        context = chromium.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, **settings)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: requests.append(request.url))
        page.goto(samples.as_uri())
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert not complaints
    assert {url for url in requests if not url.startswith("data:")} == {samples.as_uri()}


def keep(page, name, **settings):
    """Takes a screenshot to look at. Chromium sometimes cannot make one of a long page, which fails no test."""
    from playwright.sync_api import Error

    folder = render.ROOT / "target/report"
    folder.mkdir(parents=True, exist_ok=True)
    try:
        page.screenshot(path=folder / name, **settings)
    except Error as error:
        warnings.warn(f"no {name}: {error.message}", stacklevel=2)


@pytest.mark.parametrize(("width", "scheme"), [(1440, "light"), (390, "light"), (1440, "dark"), (390, "dark")])
def test_the_page_fits_its_window_and_can_be_read(opened, width, scheme):
    page = opened(width, scheme)
    for _ in range(2):
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.evaluate("document.querySelectorAll('details').forEach((one) => (one.open = true))")
    found = page.evaluate(LEGIBLE)
    assert found["smallest"] >= 12
    assert found["contrast"] >= 4.5, found["worst"]
    broken = page.evaluate("[...document.images].filter((i) => !i.complete || i.naturalWidth === 0 || !i.alt).length")
    assert broken == 0
    assert page.evaluate("document.images.length") >= 10
    page.evaluate("document.querySelectorAll('details').forEach((one) => (one.open = false))")
    keep(page, f"{width}-{scheme}.png", full_page=True)


def test_headings_go_down_by_single_steps_and_every_table_scrolls_in_its_own_box(opened):
    page = opened(390)
    levels = page.evaluate("[...document.querySelectorAll('h1,h2,h3,h4')].map((one) => +one.tagName[1])")
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(below - above <= 1 for above, below in zip(levels, levels[1:], strict=False))
    assert page.evaluate("[...document.querySelectorAll('table')].every((one) => one.closest('.scroll'))")
    for landmark in ("header", "nav", "main"):
        assert page.locator(landmark).count() == 1


def test_a_point_of_a_chart_tells_its_figures_to_mouse_touch_and_keyboard(opened):
    page = opened(1440)
    chart = page.locator(".chart").first
    chart.scroll_into_view_if_needed()
    point = chart.locator(".point").nth(6).bounding_box()
    page.mouse.move(point["x"] + point["width"] / 2, point["y"] + point["height"] / 2)
    tip = chart.locator(".tip")
    assert tip.is_visible()
    assert tip.inner_text().split("\n") == ["Abbe, hero", "16 samples: error 0.075 in 1.6 s"]
    keep(page, "hover.png")
    page.mouse.move(0, 0)
    assert not tip.is_visible()
    chart.focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowDown"):
        page.keyboard.press(key)
    assert tip.inner_text().split("\n") == ["Abbe, hero", "4 samples: error 0.15 in 0.4 s"]
    page.keyboard.press("Escape")
    assert not tip.is_visible()
    phone = opened(390, has_touch=True)
    chart = phone.locator("#stability .chart").first
    chart.scroll_into_view_if_needed()
    point = chart.locator(".point").nth(2).bounding_box()
    phone.touchscreen.tap(point["x"] + point["width"] / 2, point["y"] + point["height"] / 2)
    assert "how hard 100" in chart.locator(".tip").inner_text()


def test_the_book_can_be_searched_by_words_group_and_verdict(opened):
    page = opened(1440)
    rows = page.locator("#book tbody tr:visible")
    assert rows.count() == 130
    page.get_by_label("Group").select_option("color")
    assert rows.count() == 32
    page.get_by_label("Verdict").select_option("fail")
    assert rows.count() == 1 and page.locator("#count").inner_text() == "1 of 130 rows"
    page.get_by_label("Verdict").select_option("")
    page.get_by_label("Group").select_option("")
    page.get_by_label("Search").fill("row 119: sphere")
    assert rows.count() == 1


def test_a_part_that_was_not_made_is_said_with_its_command(tmp_path, capsys):
    out = tmp_path / "page.html"
    assert report.main(["--results", str(tmp_path), "--out", str(out)]) == 0
    text, printed = out.read_text("utf-8"), capsys.readouterr().out
    for tool in report.TOOLS:
        assert f"<code>python tools/{tool}.py</code> and make this page again" in text
        assert f"python tools/{tool}.py" in printed


def test_the_page_holds_no_address_and_no_mark_of_the_template(samples):
    text = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", samples.read_text("utf-8"))
    assert set(re.findall(r"https?://[^\"' <]+", text)) <= {"http://www.w3.org/2000/svg"}
    assert "@@" not in text and "<fails>" not in text


def test_tools_are_run_first_and_those_that_fail_are_named(monkeypatch, tmp_path, capsys):
    commands = []

    def run(command, **_):
        commands.append(command[1:])
        return subprocess.CompletedProcess(command, int("chart" in command[1]))

    monkeypatch.setattr(report, "write", lambda folder, out: out.write_text("page") and [])
    monkeypatch.setattr(report.subprocess, "run", run)
    assert report.main(["--quick", "--out", str(tmp_path / "page.html")]) == 1
    assert [(Path(script).name, *flags) for script, *flags in commands] == [
        (f"{t}.py", "--quick") for t in report.TOOLS
    ]
    assert "failed: python tools/chart.py" in capsys.readouterr().out


def test_what_is_broken_is_said_in_one_sentence(tmp_path):
    (tmp_path / "chart").mkdir()
    (tmp_path / "chart/chart.json").write_text("{")
    with pytest.raises(SystemExit, match="run `python tools/chart.py` again"):
        report.write(tmp_path, tmp_path / "index.html")


def test_the_bar_of_a_row_shows_the_z_that_is_furthest_from_0():
    assert "-3.00" in report_parts.z_bar([1, -3, 2], 4) and "left:12.5%;width:37.5%" in report_parts.z_bar(
        [1, -3, 2], 4
    )
    assert "exact" in report_parts.z_bar(None, 4)


def test_points_without_a_place_on_the_axes_are_left_out():
    nowhere = [(0, 1.0), (1.0, None), (1.0, 0.0), (1.0, float("inf"))]
    points = [{"samples": 1, "cpu_seconds": x, "error": y} for x, y in [*nowhere, (2.0, 0.1)]]
    series = [
        {"label": "one", "kind": "abbe", "points": points},
        {"label": "none", "kind": "other", "points": points[:4]},
    ]
    chart = report_parts.speed_chart({"title": "t", "series": series})
    assert [[(point["x"], point["y"]) for point in one["points"]] for one in chart["series"]] == [[(2.0, 0.1)]]


def test_colors_come_back_dashed():
    series = report_parts.colored([{"ours": False} for _ in range(8)])
    looks = [(one["color"], one["dash"]) for one in series]
    assert len(set(looks)) == 8 and looks[7][1] != "none"


def test_a_verdict_with_a_reason_fails():
    assert report_parts.passes({"verdict": "pass"}) and report_parts.passes({"verdict": "ok"})
    assert not report_parts.passes({"verdict": "fail: too noisy to pass"})
