"""The naive methods of the stability plots fail, and Abbe's images stay within their bounds.

pytest tools/tests/test_stability.py
"""

import csv
import json

import numpy as np
import pytest
from stability import command as stability
from stability import geometry, lights, transport
from stability import optics as optics_rows
from stability import scenes as stability_scenes


def test_a_far_ball_is_right_where_the_expanded_formula_is_not():
    plot = geometry.s1(quick=True)
    assert plot.naive.max() > 0.3
    assert plot.abbe.max() < 2.0**-23


def test_an_image_does_not_know_its_units_but_a_fixed_epsilon_does():
    plot = geometry.s6(quick=True)
    assert plot.naive.max() == 1
    assert plot.abbe.max() == 0


def test_a_closed_mesh_leaks_by_moller_and_trumbore_alone():
    plot = geometry.t1(quick=True)
    assert plot.series[1].y[-1] > 0.01, "in f64, aimed at the edges"
    assert plot.naive[0] == 0, "beside the edges nothing leaks"
    assert plot.abbe.max() == 0


@pytest.mark.parametrize("row", ["D5", "D13", "M3", "A1", "L1", "L3", "L4", "G4"])
def test_an_image_stays_within_its_bound_where_the_naive_method_is_100_times_beyond_it(row):
    plot = stability.ROWS[row](quick=True)
    assert plot.abbe.max() <= plot.bound
    assert plot.naive.max() > (10 if row == "D13" else 100) * plot.abbe.max()


def test_rough_metals_give_back_what_single_scattering_loses():
    plot = optics_rows.g6(quick=True)
    assert plot.naive.max() == pytest.approx(0.591, abs=0.005)
    assert plot.abbe.max() <= plot.bound


def test_panes_keep_the_light_that_a_depth_limit_and_a_weight_cut_lose():
    for plot in (transport.w2(quick=True), transport.w4(quick=True)):
        assert plot.naive.max() > 0.15
        assert plot.abbe.max() <= plot.bound
        assert plot.z < 7, "8 seeds, six values: one chance in 700"


def test_a_white_room_keeps_the_light_that_a_depth_limit_loses():
    plot = transport.w6(quick=True)
    assert plot.naive.max() > 0.9
    assert plot.abbe.max() <= plot.bound
    assert plot.z < 7


def test_every_path_through_a_stack_sums_to_the_closed_form():
    for panes in (1, 2, 4):
        assert transport.stack_cut(panes) == pytest.approx(transport.stack_exact(panes), abs=1e-9)
    assert transport.stack_cut(3, depth=6) == pytest.approx((1 - transport.R) ** 6)
    assert transport.stack_cut(3, depth=5) == 0


def test_photons_find_a_caustic_sooner_than_chance():
    plot = lights.a6(quick=True)
    expected, _, ours = (one.y for one in plot.series)
    assert (expected > 10 * ours).all()
    assert expected[-1] > 30 * expected[0], "by chance, cost grows as the lamp shrinks"


def test_the_sum_of_many_floats_stops_growing():
    assert transport.sum_f32(np.float32(1), [2**24, 2**25]) == [0, 0.5]


def test_reference_integrals_meet_their_closed_forms():
    assert stability_scenes.fresnel(1.5, np.array([1, 0.5, 0])) == pytest.approx([0.04, 0.0891867, 1], abs=1e-7)
    assert lights.wall_share(1e-9) == pytest.approx(0.5)
    area = np.sqrt(3) / 4 * 1e-6
    assert lights.triangle_integral(1e-3, 1) == pytest.approx(area, rel=1e-6)
    assert optics_rows.single_scattering(1e-4, 1000) == pytest.approx(1, abs=1e-6)
    points, faces = geometry.ball_mesh()
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert len(faces) == 528 and (np.sum(normals * corners[:, 0], -1) > 0).all(), "closed, and every face outward"


def test_plots_are_kept_as_svg_csv_and_json(tmp_path, capsys):
    stability.main(["--quick", "--row", "L1", "--out", str(tmp_path)])
    stability.main(["--quick", "--row", "D5", "--out", str(tmp_path)])
    printed = capsys.readouterr().out
    book = json.loads((tmp_path / "stability.json").read_text())
    assert [plot["row"] for plot in book["plots"]] == ["D5", "L1"], "runs of single rows add up"
    for plot in book["plots"]:
        assert (tmp_path / plot["svg"]).read_text().lstrip().startswith("<?xml")
        table = list(csv.reader((tmp_path / plot["csv"]).open()))
        assert {line[1] for line in table[1:]} == {"naive", "abbe"}
        assert plot["words"] in printed


def test_the_table_of_rows_is_read_and_other_lines_are_not():
    text = "# Title\n\n| row | what fails | what Abbe does | test |\n|---|:--|---|---|\n"
    text += "| S1 | a \\| b | far | `shapes.rs::s1_far`<br>`b.rs::s1` |\n| broken |\n"
    assert stability.catalog(text) == [
        {"row": "S1", "name": "a | b", "remedy": "far", "test": "shapes.rs::s1_far\nb.rs::s1"}
    ]
