"""The report on `--error` agrees with the measured figures.

    pytest tools/tests/test_stopping.py
"""

from concurrent.futures import ThreadPoolExecutor

import stopping


def test_a_smooth_scene_keeps_its_word():
    with ThreadPoolExecutor(2) as pool:
        row = stopping.judged("smooth", 4, pool)
    assert row["reference"] < 0.1 * row["asked"]
    assert row["reached"] == row["kept"] == 1
    assert row["median"] > 0.4 and row["worst"] < 1 and row["cost"] <= 2
    assert stopping.faults({"smooth": row}, 4) == []


def test_a_broken_word_is_told():
    good = {"kept": 1.0, "median": 0.6, "reached": 1.0}
    for wrong in ({"kept": 0.9}, {"median": 0.3}, {"reached": 0.5}):
        assert stopping.faults({"smooth": good, "lamp": {**good, **wrong}}, 40)
    # Each scene may keep its promise just often enough, while all together do not.
    assert stopping.faults({name: {**good, "kept": 0.925} for name in stopping.SCENES}, 40)
