"""The parts of the report as HTML: scenes, charts, the validation book, stability plots, how all was made.

Each function takes results that report.py has collected and returns a piece of the page; page/page.js draws the charts.
"""

import base64
import csv
import html
import math
from pathlib import Path

OURS = ("--a0", "--a1", "--a2", "--a3", "--a4")
OTHERS = ("--n0", "--n1", "--n2", "--n3", "--n4", "--n5")
DASHES = ("none", "7 4", "2 3")  # used in turn, once all colors have been used
BORDERS = {"none": "solid", "7 4": "dashed", "2 3": "dotted"}


def text(value) -> str:
    """Escapes a value for use in an element or an attribute."""
    return html.escape(str(value), quote=True)


def missing(what: str, command: str) -> str:
    return f'<p class="missing">{text(what)}: run <code>{text(command)}</code> and make this page again.</p>'


def table(label: str, heads: tuple, rows: list[str], tall=False, identity="") -> str:
    """Returns a table in a box that scrolls, with the mouse or the keyboard."""
    head = "".join(f'<th scope="col">{text(name)}</th>' for name in heads)
    box = f'<div class="scroll{" tall" if tall else ""}" tabindex="0" role="region" aria-label="{text(label)}">'
    named = f' id="{identity}"' if identity else ""
    return f"{box}<table{named}><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"


def picture(path: Path) -> str:
    """Returns a PNG as a data URI."""
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def duration(seconds: float) -> str:
    return "less than a second" if seconds < 0.5 else f"about {max(1, round(seconds))} s"


def card(scene: dict) -> str:
    """Returns one scene: picture, what to look for, command, time, the words of the plan."""
    parts = []
    if scene["picture"]:
        parts.append(f'<img src="{picture(scene["picture"])}" alt="{text(scene["line"])}">')
    parts.append(f'<div class="text"><h3>{text(scene["name"])}</h3><p>{text(scene["line"])}</p>')
    parts.append(f"<pre><code>{text(scene['command'])}</code></pre>")
    if scene["seconds"] is not None:
        parts.append(f'<p class="small">{duration(scene["seconds"]).capitalize()} on two cores.</p>')
    if scene["plan"]:
        first, rest = scene["plan"][0], scene["plan"][1:]
        parts.append(f'<p class="small">{text(first)}</p>')
        if rest:
            lines = "".join(f"<p>{text(line)}</p>" for line in rest)
            parts.append(f'<details class="small"><summary>The rest of the plan</summary>{lines}</details>')
    return f'<li class="card">{"".join(parts)}</div></li>'


def scenes(found: list[dict]) -> str:
    words = "What to look for, the line that renders it, how long that takes, and what <code>render --plan</code> says."
    return f"<p>{words}</p>" + f'<ul class="cards">{"".join(map(card, found))}</ul>'


def colored(series: list[dict]) -> list[dict]:
    """Colors our series in cool colors and the others in warm ones, in turn; then dashes the lines."""
    counts = {True: 0, False: 0}
    for one in series:
        palette = OURS if one["ours"] else OTHERS
        turn, place = divmod(counts[one["ours"]], len(palette))
        one["color"], one["dash"] = palette[place], DASHES[turn % len(DASHES)]
        counts[one["ours"]] += 1
    return series


def drawable(value) -> bool:
    """Whether a value has a place on a logarithmic axis."""
    return value is not None and math.isfinite(value) and value > 0


def speed_chart(scene: dict) -> dict:
    """Converts a scene of chart.json for page.js."""
    series = []
    for one in scene["series"]:
        points = [
            {
                "x": point["cpu_seconds"],
                "y": point["error"],
                "words": f"{point['samples']} samples: error {point['error']:.3g} in {point['cpu_seconds']:.3g} s",
            }
            for point in one["points"]
            if drawable(point["cpu_seconds"]) and drawable(point["error"])
        ]
        if points:
            series.append({"label": one["label"], "ours": one["kind"] == "abbe", "points": points})
    axes = {"xlabel": "CPU seconds", "ylabel": "error", "linear": False, "least": 0}
    return {"title": scene["title"], "series": colored(series), **axes}


def stability_chart(plot: dict, folder: Path) -> dict:
    """Converts a plot of stability.json and its CSV for page.js."""
    series: dict = {}
    with (folder / plot["csv"]).open(newline="", encoding="utf-8") as file:
        xlabel, ylabel = next(csv.reader([next(file)]))[2:4]
        for label, kind, x, y in csv.reader(file):
            one = series.setdefault(label, {"label": label, "ours": kind == "abbe", "points": []})
            if drawable(float(x)) and math.isfinite(float(y)):
                one["points"].append({"x": float(x), "y": float(y)})
    for one in series.values():
        one["points"].sort(key=lambda point: point["x"])
    axes = {"xlabel": xlabel, "ylabel": ylabel, "linear": plot.get("linear", False), "least": plot.get("least", 0)}
    return {"title": plot["title"], "series": colored(list(series.values())), **axes}


def figure(chart: dict, key: str) -> str:
    """Returns the place of a chart, and its legend."""
    names = ""
    for one in chart["series"]:
        line = f"border-top-color:var({one['color']});border-top-style:{BORDERS[one['dash']]}"
        names += f'<li class="{"ours" if one["ours"] else "other"}"><i style="{line}"></i>{text(one["label"])}</li>'
    name = f'tabindex="0" role="group" aria-label="Chart: {text(chart["title"])}"'
    tip = '<div class="tip" role="status" hidden></div>'
    return f'<div class="chart" data-chart="{text(key)}" {name}>{tip}</div><ul class="legend">{names}</ul>'


def points_table(chart: dict, heads: tuple[str, str]) -> str:
    rows = [
        f'<tr><th scope="row">{text(one["label"])}</th><td class="number">{point["x"]:.3g}</td>'
        f'<td class="number">{point["y"]:.3g}</td></tr>'
        for one in chart["series"]
        for point in one["points"]
    ]
    found = table(f"Figures of the chart: {chart['title']}", ("series", *heads), rows)
    return f'<details class="small"><summary>The figures as a table</summary>{found}</details>'


def told(words: list[str], most=8) -> str:
    """Returns sentences as a list; those beyond `most` are folded away."""
    first, rest = (
        f'<ul class="told">{"".join(f"<li>{text(line)}</li>" for line in lines)}</ul>'
        for lines in (words[:most], words[most:])
    )
    return first + (
        f'<details class="small"><summary>What else is to be said</summary>{rest}</details>' if words[most:] else ""
    )


def speed(found: list[dict], charts: dict) -> str:
    parts = [
        "<p>Error against a converged reference, over processor time; both axes are logarithmic, and lower and "
        "further left is "
        "better. Point at a chart, touch it, or use the arrow keys.</p>"
    ]
    for scene in found:
        chart = charts[f"chart {scene['name']}"]
        figures = points_table(chart, ("CPU seconds", "error"))
        drawn = figure(chart, f"chart {scene['name']}")
        parts.append(f"<h3>{text(scene['title'])}</h3>{drawn}{told(scene['words'])}{figures}")
    return "".join(parts)


def numbers(value) -> list[float]:
    """Returns the numbers of a value that is a number, a list of numbers, or None."""
    listed = value if isinstance(value, (list, tuple)) else [value]
    return [float(one) for one in listed if one is not None]


def shown(value) -> str:
    """Returns a number or a list of numbers as text: equal ones once, a long list as its range."""
    if isinstance(value, str):
        return text(value)
    values = numbers(value)
    if len(values) > 4 and len(set(values)) > 1:
        return f"<span>{min(values):.5g}</span> to <span>{max(values):.5g}</span> ({len(values)} values)"
    words = list(dict.fromkeys(f"{one:.5g}" for one in values)) if len(values) > 4 else [f"{one:.5g}" for one in values]
    words = words[:1] if len(set(words)) == 1 else words
    return ", ".join(f"<span>{text(word)}</span>" for word in words) or "-"


def z_bar(value, limit: float) -> str:
    """Returns the z that is furthest from 0, as a bar to the left or right of the middle."""
    values = [one for one in numbers(value) if one == one] if not isinstance(value, str) else []
    if not values:
        return '<span class="small">exact</span>'
    z = round(max(values, key=abs), 2)
    width = min(abs(z) / limit, 1) * 50
    left = 50 if z >= 0 else 50 - width
    bar = f'<span class="bar" aria-hidden="true"><i style="left:{left:.1f}%;width:{width:.1f}%"></i></span>'
    return f'<span class="z">{bar}<span>{z + 0:.2f}</span></span>'


def passes(row: dict) -> bool:
    return str(row["verdict"]).lower().split()[:1] in (["pass"], ["passes"], ["passed"], ["ok"], ["true"])


def book_row(row: dict) -> str:
    good = "pass" if passes(row) else "fail"
    word, _, reason = str(row["verdict"]).partition(": ")
    why = [row.get("formula"), reason, row.get("guards_against") and f"guards against {row['guards_against']}"]
    why = "".join(f'<span class="why">{text(line)}</span>' for line in why if line)
    figures = "".join(
        f'<td class="number">{shown(row[name])}</td>' for name in ("expected", "measured", "standard_error")
    )
    return (
        f'<tr data-group="{text(row["group"])}" data-verdict="{good}"><th scope="row">{text(row["name"])}{why}</th>'
        f'<td><span class="{good}">{text(word)}</span></td><td>{z_bar(row.get("z"), 4)}</td>{figures}'
        f"<td>{text(row['group'])}</td></tr>"
    )


FILTERS = """<form class="filters" aria-label="Choose rows">
<label>Search<input type="search" name="words" autocomplete="off"></label>
<label>Group<select name="group"><option value="">all</option>GROUPS</select></label>
<label>Verdict<select name="verdict"><option value="">all</option><option value="pass">passes</option>
<option value="fail">fails</option></select></label>
<p id="count" role="status"></p></form>"""


def validation(book: dict) -> str:
    """Returns the book as a table that can be searched."""
    rows = book["rows"]
    groups = dict.fromkeys(row["group"] for row in rows)
    options = "".join(f"<option>{text(group)}</option>" for group in groups)
    heads = ("row", "verdict", "z", "expected", "measured", "standard error", "group")
    good = sum(map(passes, rows))
    return (
        f"<p>Scenes whose answer is known, rendered and judged: {good} of {len(rows)} rows pass. z is the miss in "
        "standard errors, of several the largest; the bar is full at 4.</p>"
        + FILTERS.replace("GROUPS", options)
        + table("Validation rows", heads, list(map(book_row, rows)), tall=True, identity="book")
    )


def test_names(names: str) -> str:
    """Returns each test's name as lines of its own, broken between words."""
    lines = (text(name).replace("_", "_<wbr>").replace("::", "::<wbr>") for name in names.splitlines())
    return "".join(f"<code>{line}</code>" for line in lines)


def stability(book: dict, charts: dict) -> str:
    """Returns plots with their words, and a table of which test covers which row."""
    cards = []
    for plot in book["plots"]:
        key = f"stability {plot['row']}"
        source = f'<p class="small">After {text(plot["source"])}.</p>' if plot.get("source") else ""
        cards.append(
            f'<li class="card"><div class="text"><h3>{text(plot["row"])}: {text(plot["title"])}</h3>'
            f"<p>{text(plot['words'])}</p>{figure(charts[key], key)}{source}</div></li>"
        )
    parts = [
        "<p>Where methods fail: common ways of computing beside Abbe, as what is hard about a scene grows. The failing "
        "ones are small programs or closed forms; Abbe's values are measured on images that it rendered. An open mark "
        f'is a value of 0, or below the axis.</p><ul class="cards plots">{"".join(cards)}</ul>'
    ]
    if book.get("rows"):
        lines = [
            f'<tr><td>{text(row["row"])}</td><th scope="row">{text(row["name"])}'
            f'<span class="why">{text(row.get("remedy", ""))}</span></th><td>{test_names(row["test"])}</td></tr>'
            for row in book["rows"]
        ]
        parts.append("<h3>Which test holds which row</h3>")
        parts.append(table("Rows and tests", ("row", "what fails, and what Abbe does", "test"), lines, tall=True))
    return "".join(parts)


def making(made: list[tuple[str, str, str]], versions: dict) -> str:
    """Returns tables of commands and versions."""
    rows = [
        f'<tr><th scope="row">{text(name)}</th><td><code>{text(command)}</code></td><td>{text(when)}</td></tr>'
        for name, command, when in made
    ]
    commands = table("Commands", ("part", "command", "made"), rows)
    listed = "".join(f"<dt>{text(name)}</dt><dd>{text(value)}</dd>" for name, value in versions.items())
    return f"<p>Each part by itself, with what made it:</p>{commands}<h3>Versions</h3><dl>{listed}</dl>"
