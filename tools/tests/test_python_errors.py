"""Mistakes in scenes that are dicts: an exception with the key of each mistake and what to do, never a panic.

pytest tools/tests/test_python_errors.py
ABBE_FUZZ_CASES=100000 pytest tools/tests/test_python_errors.py -k distorted
"""

import copy
import math
import os
import random
import re
import tomllib
from decimal import Decimal
from fractions import Fraction
from pathlib import Path, PurePosixPath

import numpy as np
import pytest
import render

abbe = pytest.importorskip("abbe", reason="the package is not installed: python3 tools/test.py --only wheel")

MESSAGES = render.ROOT / "tests/messages"
BASE = (MESSAGES / "base.toml").read_text("utf-8").splitlines()
# The largest number of mistakes that the command prints about a scene.
MOST_SHOWN = 20


class Case:
    """A case of tests/messages, parsed as in tests/messages.rs."""

    def __init__(self, text):
        self.title, rest = text.split("\n", 1)
        patch, self.expected = rest.split("\n\n", 1)
        taken, put, self.files, self.settings = [], [], {}, []
        for mark, line in ((line[0], line[1:].removeprefix(" ")) for line in patch.splitlines()):
            match mark:
                case "-":
                    taken.append(line)
                case "+":
                    put.append(line)
                case "=":
                    self.settings.append(line)
                case "@":
                    name = line
                    self.files[name] = ""
                case ">":
                    self.files[name] += line + "\n"
        at = next((i for i in range(len(BASE)) if taken and BASE[i : i + len(taken)] == taken), len(BASE))
        self.scene = "\n".join(BASE[:at] + put + BASE[at + len(taken) :]) + "\n"

    def write(self, folder):
        for name, text in self.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, "utf-8")

    def set(self):
        """Returns the settings as written in Python: values that are not TOML are texts."""
        given = {}
        for setting in self.settings:
            key, equals, value = setting.partition("=")
            if not (key and equals and value):
                pytest.skip("this is no setting, and so no item of a dict")
            try:
                given[key] = tomllib.loads(f"value = {value}")["value"]
            except tomllib.TOMLDecodeError:
                if value.startswith(("[", "{", '"', "'", ".")):
                    pytest.skip("this is no TOML, and so no value")
                given[key] = value
        return given

    def told(self):
        """Returns the command's messages, each with its help."""
        told = []
        for line in self.expected.splitlines():
            if line.startswith("error: "):
                told.append([line.removeprefix("error: "), None])
            elif found := re.match(r" *= help: (.*)", line):
                told[-1][1] = found[1]
        return [tuple(one) for one in told]


def cases(name):
    text = "\n" + (MESSAGES / name).read_text("utf-8")
    return [Case(case) for case in text.split("\n## ")[1:]]


TABLES = sorted(path.name for path in MESSAGES.glob("*.txt") if path.name not in ("syntax.txt", "warnings.txt"))
ALL = [pytest.param(case, id=f"{table}: {case.title}") for table in TABLES for case in cases(table)]


def has(scene, path):
    """Whether a path such as `object[2].shape` leads to a value in a scene."""
    value = scene
    for key, number in re.findall(r"([^.\[\]]+)|\[(\d+)\]", path):
        try:
            value = value[key or int(number)]
        except (KeyError, IndexError, TypeError):
            return False
    return True


def plain(message):
    """Returns a message without the forms of numbers, quotes and lines of the file, which differ in Python."""

    def number(found):
        try:
            return f"{float(found[0].replace('_', '')):.12g}"
        except ValueError:
            return found[0]

    message = message and re.sub(r"at scene.toml:\d+:\d+", "in the scene itself", message)
    return message and re.sub(r"[-+]?(\d[\d_]*\.?\d*(e[-+]?\d+)?|inf|nan)", number, re.sub("['\"]", "", message))


@pytest.mark.parametrize("case", ALL)
def test_each_mistake_of_a_dict_is_told_in_the_words_of_its_file(case, tmp_path, monkeypatch):
    try:
        scene = tomllib.loads(case.scene)
    except tomllib.TOMLDecodeError:
        pytest.skip("this is no TOML, and so no dict")
    if "includes itself" in case.expected:
        pytest.skip("a dict is no file, so that no file includes it")
    if "a hexadecimal number" in case.title:
        pytest.skip("a number of a dict is written in no way")
    if "list of 3 numbers" in case.expected and "as the decimal point" in case.expected:
        pytest.skip("a list of a dict has no spaces that tell which commas are decimal")
    monkeypatch.chdir(tmp_path)
    case.write(tmp_path)
    (tmp_path / "scene.toml").write_text(case.scene, "utf-8")
    with pytest.raises(abbe.SceneError) as caught:
        abbe.render(scene, set=case.set())
    mistakes, expected = caught.value.mistakes, case.told()
    assert len(mistakes) == len(expected) or len(expected) == MOST_SHOWN < len(mistakes)
    said = sorted((plain(mistake.message), plain(mistake.help) or "") for mistake in mistakes)
    missing = [one for one in expected if (plain(one[0]), plain(one[1]) or "") not in said]
    assert not missing, said
    for mistake in mistakes:
        if mistake.file.endswith("scene.toml"):
            assert mistake.key is not None and (mistake.key == "" or has(scene, mistake.key)), mistake
            assert str(caught.value).count(mistake.message) and mistake.key in str(caught.value)


def test_the_cases_are_those_of_the_command():
    assert len(ALL) > 600


class Odd:
    """A value that no scene can hold: `tolist` returns the value itself."""

    def tolist(self):
        return self


class Raises:
    def tolist(self):
        raise ZeroDivisionError


@pytest.mark.parametrize(
    "value, said",
    [
        (None, "a scene cannot hold None (leave the key out)"),
        (3j, "a scene cannot hold a value of the type complex"),
        (b"gold", "a scene cannot hold a value of the type bytes"),
        ({1, 2}, "a scene cannot hold a value of the type set"),
        (Odd(), "a scene cannot hold a value of the type Odd"),
        (10**30, "`width` is a whole number from 1 to 65536, not 1" + 30 * "0"),
        pytest.param(10**40, "this number is too large", id="bits"),
        pytest.param(10**5000, "this number is too large", id="digits"),
        pytest.param("\ud800", "this string is not valid Unicode", id="surrogate"),
        ({3: 4}, "a key is a string, not 3"),
        (math.nan, "film.width: `width` is a whole number from 1 to 65536, not nan"),
        (True, "film.width: `width` is a whole number from 1 to 65536, not true"),
    ],
)
def test_what_python_has_and_no_scene_is_told_by_its_key(value, said):
    with pytest.raises(abbe.SceneError) as caught:
        abbe.Scene({"camera": {}, "film": {"width": value}})
    assert "film.width" in str(caught.value) and said in str(caught.value)


def test_a_dict_within_itself_is_told():
    film = {"width": 3}
    film["film"] = film
    with pytest.raises(abbe.SceneError, match="dicts and lists are nested more than 64 deep"):
        abbe.Scene({"film": film})


def test_what_a_value_raises_is_raised():
    with pytest.raises(ZeroDivisionError):
        abbe.Scene({"film": Raises()})


def test_arrays_that_fill_all_memory_are_told_by_numpy():
    endless = np.broadcast_to(np.zeros(3), (2**50, 3))
    with pytest.raises((MemoryError, ValueError)):
        abbe.Scene({"object": [{"shape": {"mesh": {"points": endless}}}]})


def test_all_that_is_wrong_is_told_at_once():
    with pytest.raises(abbe.SceneError) as caught:
        abbe.Scene({"a": None, "b": [1, {"c": None}], "d": 3j})
    assert [mistake.key for mistake in caught.value.mistakes] == ["a", "b[1].c", "d"]


def test_numbers_and_texts_of_all_kinds_are_values():
    kinds = {
        "position": (Fraction(1, 2), Decimal("1.5"), np.float64(5)),
        "look_at": np.array([0, 0, 0], dtype=np.int8),
        "vertical_fov": np.array(40.0),
    }
    film = {"width": np.uint16(8), "height": True + 3, "layers": np.array(["albedo"])}
    scene = abbe.Scene({"camera": kinds, "film": film, "light": ({"environment": {"radiance": 1}},)})
    assert "8 x 4 pixels" in repr(scene)
    path = PurePosixPath("tiles.png")
    textured = {"diffuse": {"reflectance": {"image": path}}}
    with pytest.raises(abbe.SceneError, match="tiles.png"):
        abbe.Scene({"camera": kinds, "film": film, "material": {"a": textured}})


STRANGE = [
    None, True, -1, 0, "\0rows 0", 1e308, -1e-308, math.nan, math.inf, 2**63,
    -(2**70), "", "$", "$x", "gold", "N-BK7", "\0", "\x7f\u2028",
    "\"'''\\", "\ud800", [], {}, [[]], [None], {"": 0}, {"a b": {"é": 1}}, b"x", 3j, {1},
    object(), Odd(), print, np.array(3),
    np.zeros((2, 3)), np.array([], dtype=np.float32), np.array([None, "x"], dtype=object),
    np.float32("nan"), np.datetime64("2024-01-01"),
    np.str_("rgb"), np.bool_(True), Decimal("NaN"), Fraction(1, 3), Path("x.png"), range(3), (1, (2, (3,))), [1] * 300,
]  # fmt: skip


OPTIONS = [
    "samples", "error", "time", "seed", "overscan", "crop", "layers", "spectral", "threads", "stamp", "progress",
    "checkpoint", "every", "resume",
]  # fmt: skip


@pytest.mark.parametrize("option", OPTIONS)
def test_options_of_any_kind_are_taken_or_told(option, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    camera = {"position": [0, 0, 5], "look_at": [0, 0, 0], "vertical_fov": 40}
    light = [{"environment": {"radiance": 1}}]
    scene = abbe.Scene({"camera": camera, "film": {"width": 3, "height": 2}, "light": light})

    class Enough(Exception):
        pass

    def stop(so_far):
        raise Enough

    for value in STRANGE:
        try:
            abbe.render(scene, **{"samples": 1, "progress": stop, option: value})
        except abbe.RenderError as error:
            assert error.message and "defect" not in error.message, value
        except (Enough, TypeError, ValueError, OSError):
            pass


def places(value, found):
    """Returns every container of a scene with each of its keys."""
    keys = value.keys() if isinstance(value, dict) else range(len(value))
    for key in keys:
        found.append((value, key))
        if isinstance(value[key], dict | list):
            places(value[key], found)
    return found


def distorted(scene, choose):
    for _ in range(choose.choice((1, 1, 2, 5))):
        found = places(scene, [])
        if not found:
            return scene
        into, key = choose.choice(found)
        match choose.randrange(6):
            case 0 | 1:
                into[key] = copy.deepcopy(choose.choice(STRANGE))
            case 2:
                del into[key]
            case 3:
                other, name = choose.choice(found)
                into[key] = copy.deepcopy(other[name]) if isinstance(other, dict) and name in other else {}
            case 4 if isinstance(into, dict):
                into[choose.choice((str(key)[:-1], str(key) + "s", "", "rgb", 3, None))] = into[key]
            case _ if isinstance(into[key], int | float):
                into[key] = choose.choice((-1, 0, 1e-300, 1e300, 2**62)) * into[key]
    return scene


def test_distorted_dicts_are_scenes_or_told(tmp_path):
    cases = int(os.environ.get("ABBE_FUZZ_CASES", "500"))
    scene = tomllib.loads((MESSAGES / "everything.toml").read_text("utf-8"))
    choose, right = random.Random(cases), 0
    for number in range(cases):
        try:
            # Files that the scene names are looked for beside it, as by the command.
            abbe.Scene(distorted(copy.deepcopy(scene), choose), folder=MESSAGES)
            right += 1
        except abbe.SceneError as error:
            assert error.mistakes and all(mistake.message for mistake in error.mistakes), number
    assert 0 < right < cases
