# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest
from made_maps import faulty_quality, key, made_of, map_of, marker_quality
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sextant.mapping.label_placement import place_labels
from sextant.mapping.map_drawing import ANCHOR, CONFLICTING, WEAK, MapPlan
from sextant.mapping.map_links import Cut
from sextant.mapping.map_plots import BLUE, RED, plan_view, residual_boxes


def decoded(png):
    assert png.startswith(b"\x89PNG")
    return cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)


def pixels_of(picture, colour):
    bgr = [int(colour[i : i + 2], 16) for i in (5, 3, 1)]
    return int(np.all(picture == bgr, axis=2).sum())


def drawn(quality, made):
    """The plan on axes, and their texts by content."""
    plan = MapPlan(made, quality)
    figure = Figure(figsize=plan.figure_size)
    FigureCanvasAgg(figure)
    axes = figure.add_axes(plan.axes_place)
    plan.draw(axes)
    return axes, {text.get_text(): text for text in axes.texts}


def legend_of(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def row(count):
    return map_of([marker_quality(0, is_anchor=True), *(marker_quality(id) for id in range(1, count))])


def test_what_the_plan_shows():
    faulty = decoded(plan_view(made_of(faulty_quality()), faulty_quality()))
    assert pixels_of(faulty, ANCHOR) > 50
    assert pixels_of(faulty, CONFLICTING) > 50
    plain = decoded(plan_view(made_of(row(3)), row(3)))
    assert pixels_of(plain, CONFLICTING) == 0


def test_every_marker_has_its_name_and_the_named_ones_are_bold():
    axes, texts = drawn(faulty_quality(), made_of(faulty_quality()))
    assert {str(id) for id in range(13)} <= set(texts)
    assert texts["9"].get_weight() == "bold" and texts["0"].get_weight() == "normal"
    assert axes.get_aspect() == 1.0


def test_weak_links_are_dashed():
    quality = map_of(
        [marker_quality(id) for id in range(3)],
        links={(key(0), key(1)): 40, (key(1), key(2)): 2},
        weak=[Cut(frozenset([key(2)]), 2, ((key(2), key(1)),))],
    )
    axes, _ = drawn(quality, made_of(quality))
    firm, loose = axes.collections[:2]
    assert [line.tolist() for line in loose.get_segments()] == [[[1.0, 0.0], [2.0, 0.0]]]
    assert [line.tolist() for line in firm.get_segments()] == [[[0.0, 0.0], [1.0, 0.0]]]
    assert firm.get_linewidths()[0] > loose.get_linewidths()[0]
    assert loose.get_linestyle()[0][1] is not None and firm.get_linestyle()[0][1] is None
    assert pixels_of(decoded(plan_view(made_of(quality), quality)), WEAK) > 20


@pytest.mark.parametrize("sigma, label", [(0.002, "3 sigma, drawn 20 times as large"), (0.5, "3 sigma")])
def test_the_factor_on_the_ellipses_is_in_the_legend(sigma, label):
    quality = map_of([marker_quality(id, position_sigma=sigma) for id in range(5)])
    axes, _ = drawn(quality, made_of(quality))  # 4 m and 0.5 m on either side: at most 0.15 m
    assert label in legend_of(axes)
    times = 20 if sigma < 0.1 else 1
    ellipses = axes.collections[2]
    assert 2 * ellipses._widths == pytest.approx(6 * times * sigma)  # matplotlib keeps half of them


def test_one_wild_pose_does_not_change_the_scale():
    made, wild = made_of(row(4)), made_of(row(4))
    wild.T_map_base[5] = np.eye(4)
    wild.T_map_base[5][0, 3] = 1e6
    assert MapPlan(made, row(4)).figure_size == MapPlan(wild, row(4)).figure_size


@pytest.mark.parametrize("count, spacing", [(1, 1.0), (5, 1.0), (80, 1.0), (80, 0.05)])
def test_a_map_of_any_size_is_a_picture_of_a_sensible_size(count, spacing):
    plan = MapPlan(made_of(row(count), spacing), row(count))
    width, height = plan.figure_size
    assert 6.0 < width < 14.0 and 3.0 < height < 11.0


def test_markers_that_lie_flat_are_squares():
    made = made_of(row(1))
    flat = made.map.markers[0].T_map_marker.copy()
    flat[:3, :3] = np.eye(3)
    made.map = type(made.map)()
    made.map.add(type(made_of(row(1)).map.markers[0])(*key(0), 0.2, flat))
    axes, _ = drawn(row(1), made)
    assert "s" in [line.get_marker() for line in axes.lines]


def test_names_keep_clear_of_one_another():
    figure = Figure(figsize=(5, 5))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, 360), ylim=(0, 360))  # a unit is a point
    up = np.array([0.0, 1.0])
    wanted = {id: (np.array([100.0 + 6 * id, 100.0]), up) for id in range(5)}
    points = np.array([at for at, _ in wanted.values()])
    offsets = place_labels(axes, wanted, dict.fromkeys(wanted, "100"), 9, points)
    middles = np.array([wanted[id][0] + offsets[id] for id in wanted])
    assert offsets[0] == pytest.approx([0.0, 11.25])
    for i, a in enumerate(middles):
        for b in middles[i + 1 :]:
            assert abs(a[0] - b[0]) >= 16.7 or abs(a[1] - b[1]) >= 8.9


def test_residuals():
    few = decoded(residual_boxes(row(5)))
    assert pixels_of(few, RED) < 50  # the legend's
    spread = marker_quality(1, used_rms=np.linspace(0.1, 1.0, 50), left_out_rms=np.full(40, 20.0))
    left_out = decoded(residual_boxes(map_of([spread, marker_quality(2, used_rms=np.zeros(0))])))
    assert pixels_of(left_out, RED) > 50
    half_blue = tuple(round(255 - 0.5 * (255 - int(BLUE[i : i + 2], 16))) for i in (5, 3, 1))
    assert np.all(np.abs(left_out.astype(int) - half_blue) <= 1, axis=2).sum() > 500


@pytest.mark.slow
def test_many_markers_take_more_rows():
    heights = [decoded(residual_boxes(row(count))).shape[0] for count in (50, 51, 101)]
    assert heights[0] < heights[1] < heights[2]
