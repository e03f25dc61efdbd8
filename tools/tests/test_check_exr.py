"""The EXR checker passes good files and names what is wrong with bad ones.

pytest tools/tests/test_check_exr.py
"""

import check_exr
import numpy as np
import OpenEXR
import pytest

HEIGHT, WIDTH = 8, 12
STAMP = {"capDate": "2026:02:28 23:59:59", "utcOffset": 0.0, "render/renderTime": 1.5, "render/threads": 2}
# A sensor of 36 mm behind a screen window of 1.5, and a lens that is in focus 3 m away.
OPTICS = {
    "sensorOverallDimensions": (36.0, 24.0),
    "pinholeFocalLength": 24.0,
    "effectiveFocalLength": 1 / (1 / 24 + 1 / 3000),
    "aperture": 2.8,
    "focus": 3.0,
}


def world_to_ndc(world_to_camera, center, width, rows, columns, orthographic):
    """Returns the matrix to 0 at the top left and 1 at the bottom right of a window that is `width` wide."""
    size = np.array([width, width * rows / columns])
    (x, y), (left, top) = (1, -1) / size, 0.5 - (1, -1) * np.asarray(center) / size
    if orthographic:
        rows = [(x, 0, 0, 0), (0, y, 0, 0), (0, 0, 1, 0), (left, top, 0, 1)]
    else:
        rows = [(x, 0, 0, 0), (0, y, 0, 0), (left, top, 1, 1), (0, 0, -1, 0)]
    return (np.asarray(world_to_camera, np.float64) @ np.array(rows)).astype(np.float32)


def header(**changes):
    """Returns a good header with changes; None leaves an attribute out. worldToNDC follows from the others."""
    good = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "colorInteropID": "lin_rec709_scene",
        "chromaticities": check_exr.CHROMATICITIES["lin_rec709_scene"],
        "software": "Abbe 0.1.0",
        "worldToCamera": np.diag([1, 1, -1, 1]).astype(np.float32),
        "screenWindowWidth": 1.5,
        "render/version": "0.1.0",
        "render/sceneHash": "0f" * 32,
        "render/seed": "18446744073709551615",
        "render/samples": 4,
        "render/filter": "box",
        "render/projection": "perspective",
        "render/model": "rgb",
        "render/transport": "deterministic",
        "render/nonFinite": 0,
    }
    all = {**good, **changes}
    columns, rows = all.get("displayWindow", WINDOW)[1] + 1
    if "worldToNDC" not in changes and all["render/projection"] != "equirectangular":
        matrix, width = (good[name] if all[name] is None else all[name] for name in ("worldToCamera", "screenWindowWidth"))
        center = all.get("screenWindowCenter", (0, 0))
        orthographic = all["render/projection"] == "orthographic"
        all["worldToNDC"] = world_to_ndc(matrix, center, width or 1, rows, columns, orthographic)
    return {name: value for name, value in all.items() if value is not None}


def plane(value, dtype=np.float32):
    return np.full((HEIGHT, WIDTH), value, dtype)


def channels(**changes):
    good = {"R": plane(0.5), "G": plane(7e4), "B": plane(0), "A": plane(1), "Z": plane(2.5)}
    return {name: value for name, value in {**good, **changes}.items() if value is not None}


@pytest.fixture
def found(tmp_path):
    """Returns the violations of a file that is good except for the given changes."""

    def write_and_check(header, channels):
        path = tmp_path / "image.exr"
        OpenEXR.File(header, channels).write(str(path))
        return check_exr.violations(path)

    return write_and_check


def test_a_good_file_breaks_no_rule(found):
    assert found(header(), channels()) == []


def test_every_color_space_passes_with_its_own_chromaticities(found):
    for space, chromaticities in check_exr.CHROMATICITIES.items():
        assert found(header(colorInteropID=space, chromaticities=chromaticities), channels()) == []


def test_the_table_of_chromaticities_agrees_with_openexr():
    for space, chromaticities in check_exr.CHROMATICITIES.items():
        known = OpenEXR.colorInteropIDToChromaticities(space)
        if space == "lin_ciexyzd65_scene":
            # OpenEXR has no chromaticities for XYZ. Those of the axes X, Y and Z say what the channels are.
            assert known is None
        else:
            assert known == pytest.approx(chromaticities, abs=1e-7)


def mirrored():
    return np.eye(4, dtype=np.float32)


def stretched():
    return np.diag([1, 1.00001, -1, 1]).astype(np.float32)


def far_away():
    """Returns the matrix of a camera that is rotated, and far from the origin."""
    sine, cosine = np.sin(0.3), np.cos(0.3)
    turn = np.array([(cosine, 0, sine), (0, 1, 0), (sine, 0, -cosine)])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[3, :3] = turn, -np.array([123.4, -5678.9, 43.21]) @ turn
    return matrix.astype(np.float32)


def projective():
    matrix = np.diag([1, 1, -1, 1]).astype(np.float32)
    matrix[2, 3] = 1
    return matrix


WINDOW = (np.array([0, 0], np.int32), np.array([WIDTH - 1, HEIGHT - 1], np.int32))
SHIFTED = (np.array([1, 1], np.int32), np.array([WIDTH, HEIGHT], np.int32))
LARGER = (np.array([0, 0], np.int32), np.array([WIDTH, HEIGHT], np.int32))
BEFORE = (np.array([-1, -1], np.int32), np.array([WIDTH - 2, HEIGHT - 2], np.int32))
SMALLER = (np.array([0, 0], np.int32), np.array([WIDTH - 1, HEIGHT - 2], np.int32))
ALL_AROUND = {"render/projection": "equirectangular", "screenWindowWidth": 1.0}
SEEN = world_to_ndc(np.diag([1, 1, -1, 1]), (0, 0), 1.5, HEIGHT, WIDTH, orthographic=False)


@pytest.mark.parametrize(
    "changes",
    [
        {"dataWindow": WINDOW, "displayWindow": LARGER},
        {"dataWindow": SHIFTED, "displayWindow": LARGER},
        {"dataWindow": WINDOW, "displayWindow": SMALLER},
        {"dataWindow": BEFORE, "displayWindow": SMALLER},
        {"screenWindowCenter": np.array([0.1, -0.4], np.float32)},
        {"render/filter": "gaussian sigma 0.5"},
        {"render/filter": "blackman-harris radius 1.5"},
        {"render/filter": "mitchell b 0 c 0.5"},
        {"render/projection": "orthographic"},
        {"render/projection": "orthographic", "screenWindowCenter": np.array([0.1, -0.4], np.float32)},
        {"worldToCamera": far_away()},
        {"worldToCamera": far_away(), "render/projection": "orthographic"},
        {**ALL_AROUND, "envmap": OpenEXR.ENVMAP_LATLONG},
        {"compression": OpenEXR.PIZ_COMPRESSION, "owner": "Émilie", "comments": "shot 12"},
        {"whiteLuminance": 100.0, **STAMP, **OPTICS},
        {**OPTICS, "focus": np.inf, "effectiveFocalLength": 24.0},
        {"focus": 3.0, "near": 0.5},
    ],
)
def test_crops_overscan_shifts_filters_and_projections_break_no_rule(found, changes):
    assert found(header(**changes), channels()) == []


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}, "not a scanline image"),
        ({"compression": OpenEXR.B44_COMPRESSION}, "not one of none, rle, zips, zip, piz, pxr24, dwaa, dwab"),
        ({"lineOrder": OpenEXR.DECREASING_Y}, "not increasing y"),
        ({**ALL_AROUND, "envmap": OpenEXR.ENVMAP_LATLONG, "dataWindow": SHIFTED, "displayWindow": WINDOW}, "of an environment"),
        ({"dataWindow": SHIFTED, "displayWindow": SHIFTED}, "not at the origin"),
        ({"pixelAspectRatio": 2.0}, "pixel aspect ratio"),
        ({"colorInteropID": None}, "colorInteropID is None"),
        ({"colorInteropID": "unknown"}, "colorInteropID is 'unknown'"),
        ({"chromaticities": None}, "chromaticities are missing"),
        ({"chromaticities": check_exr.CHROMATICITIES["lin_ap1_scene"]}, "not those of lin_rec709_scene"),
        ({"acesImageContainerFlag": 1}, "OpenEXR warns of the color metadata"),
        ({"screenWindowWidth": 0.0}, "screenWindowWidth"),
        ({"screenWindowCenter": np.array([np.nan, 0], np.float32)}, "screenWindowCenter"),
        ({"render/projection": "equirectangular"}, "screenWindowCenter and screenWindowWidth"),
        ({"envmap": OpenEXR.ENVMAP_LATLONG}, "envmap is"),
        ({"render/projection": "fisheye"}, "render/projection"),
        ({"worldToCamera": None}, "worldToCamera is missing"),
        ({"worldToCamera": mirrored()}, "left-handed"),
        ({"worldToCamera": stretched()}, "orthonormal"),
        ({"worldToCamera": projective()}, "affine"),
        ({"worldToNDC": None}, "worldToNDC is missing"),
        ({"worldToNDC": SEEN @ np.diag([1, -1, 1, 1]).astype(np.float32)}, "worldToNDC is off by"),
        ({"worldToNDC": SEEN @ np.diag([1.000003, 1, 1, 1]).astype(np.float32)}, "worldToNDC is off by"),
        ({"worldToNDC": SEEN, "screenWindowCenter": np.array([0.1, 0], np.float32)}, "worldToNDC is off by"),
        ({"worldToNDC": SEEN, "render/projection": "orthographic"}, "worldToNDC is off by"),
        ({"worldToNDC": SEEN @ np.diag([-1, -1, -1, -1]).astype(np.float32)}, "before the camera behind it"),
        ({"worldToNDC": SEEN @ np.diag([1, 1, -1, 1]).astype(np.float32)}, "farther points at a larger z"),
        ({"worldToNDC": SEEN, **ALL_AROUND}, "a view all around"),
        ({"software": None}, "software is missing"),
        ({"capDate": "2026:01:01 00:00:00"}, "some are there, and not all"),
        ({**STAMP, "capDate": "2026:13:01 00:00:00"}, "not a time in UTC"),
        ({**STAMP, "utcOffset": 3600.0}, "not a time in UTC"),
        ({**STAMP, "render/threads": 0}, "no number of threads"),
        ({"whiteLuminance": -1.0}, "whiteLuminance is -1.0, not positive"),
        ({"focus": 0.0}, "focus is 0.0, not positive"),
        ({"pinholeFocalLength": 24.0}, "one is there without the other"),
        ({**OPTICS, "pinholeFocalLength": 25.0, "effectiveFocalLength": None}, "pinholeFocalLength is 25.0, not that of a sensor"),
        ({**OPTICS, "sensorOverallDimensions": (36.0, 20.0)}, "not as the image"),
        ({**OPTICS, "effectiveFocalLength": 24.0}, "effectiveFocalLength is 24.0, not that of"),
        ({**OPTICS, "aperture": None}, "some are there without the others"),
        ({"render/version": None}, "render/version is missing"),
        ({"render/sceneHash": "0f" * 31}, "render/sceneHash"),
        ({"render/seed": "-1"}, "render/seed"),
        ({"render/samples": 0}, "render/samples"),
        ({"render/samples": "4"}, "render/samples"),
        ({"render/filter": "gaussian"}, "render/filter"),
        ({"render/filter": "tent radius -1"}, "render/filter"),
        ({"render/model": " "}, "render/model"),
        ({"render/transport": None}, "render/transport is missing"),
        ({"render/nonFinite": -1}, "render/nonFinite"),
    ],
)
def test_a_bad_header_fails_for_its_own_reason(found, changes, reason):
    violations = found(header(**changes), channels())
    assert any(reason in violation for violation in violations), violations
    assert len(violations) <= 2, violations


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"Z": None}, "'Z': missing"),
        ({"A": None}, "'A': missing"),
        ({"R": plane(0.5, np.float16)}, "'R': float16, not 32-bit float"),
        ({"Z": plane(2, np.uint32)}, "'Z': uint32, not 32-bit float"),
        ({"G": plane(np.nan)}, "'G': 96 values not finite"),
        ({"B": plane(-np.inf)}, "'B': 96 values not finite"),
        ({"A": plane(1.0000001)}, "'A': from"),
        ({"A": plane(-0.1)}, "'A': from"),
        ({"Z": plane(0)}, "depths not positive"),
        ({"A": plane(0)}, "not at the miss depth"),
        ({"a_very_long_layer_name_indeed.RED": plane(0)}, "not 1 to 31 printable"),
        ({"two words.R": plane(0)}, "not LAYER.CHANNEL"),
        ({"1st.R": plane(0)}, "not LAYER.CHANNEL"),
        ({"a.b.R": plane(0)}, "not LAYER.CHANNEL"),
    ],
)
def test_a_bad_channel_fails_for_its_own_reason(found, changes, reason):
    violations = found(header(), channels(**changes))
    assert any(reason in violation for violation in violations), violations
    assert len(violations) <= 2, violations


def test_a_perceptually_linear_channel_fails(found):
    marked = OpenEXR.Channel("R", plane(0.5), 1, 1, True)
    assert found(header(), channels(R=marked)) == ["channel 'R': marked as perceptually linear"]


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_a_truncated_file_fails_as_unreadable(tmp_path, share):
    whole, cut = tmp_path / "whole.exr", tmp_path / "cut.exr"
    noise = 1 - np.random.default_rng(1).random((5, HEIGHT, WIDTH), np.float32)
    OpenEXR.File(header(), dict(zip("RGBAZ", noise, strict=True))).write(str(whole))
    assert check_exr.violations(whole) == []
    content = whole.read_bytes()
    cut.write_bytes(content[: int(share * len(content))])
    (violation,) = check_exr.violations(cut)
    assert violation.startswith("unreadable: ")


def test_the_command_names_each_file_and_exits_with_1_on_any_violation(tmp_path, capsys):
    good, bad = str(tmp_path / "good.exr"), str(tmp_path / "bad.exr")
    OpenEXR.File(header(), channels()).write(good)
    OpenEXR.File(header(capDate="2026:01:01 00:00:00"), channels()).write(bad)
    assert check_exr.main([good]) == 0
    assert check_exr.main([good, bad]) == 1
    assert f"FAIL {bad}\n      capDate, utcOffset, render/renderTime, render/threads: some are there" in capsys.readouterr().out
