# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which places are right answers to pictures whose truth is known."""

from pathlib import Path

import numpy as np
import pytest

from sextant.place_maps.place_clusters import clustered
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, Photo, PlaceMap
from sextant.places.place_queries import (
    Query,
    default_distances,
    default_tolerance,
    leave_one_out_queries,
    places_near,
    queries_in_clusters,
    queries_of_map,
    queries_of_photos,
    queries_of_table,
)

OVERVIEW = Overview("park.png", 1000, 500)


def row_of_places(folder, *x, georeference=None):
    photos = tuple(Photo(i, f"{i}.png", float(at), 50.0) for i, at in enumerate(x))
    return PlaceMap(folder, OVERVIEW, photos, georeference)


def test_the_tolerance_is_in_metres_where_the_map_has_a_scale(tmp_path):
    pixels = row_of_places(tmp_path, 0, 10, 20, 40)
    metric = pixels._replace(georeference=MetricFrame("map", 0.5, (3.0, 4.0, 1.0)))
    assert (default_tolerance(pixels), default_tolerance(metric)) == (20.0, 10.0)
    assert places_near(pixels, (10.0, 50.0), 10.0) == {(0.0, 50.0), (10.0, 50.0), (20.0, 50.0)}
    assert places_near(metric, (10.0, 50.0), 10.0) == {(0.0, 50.0), (10.0, 50.0), (20.0, 50.0)}
    assert places_near(metric, (10.0, 50.0), 15.0) == {(x, 50.0) for x in (0.0, 10.0, 20.0, 40.0)}
    assert places_near(metric, (10.0, 56.0), 3.0) == {(10.0, 50.0)}


def test_distances_are_spacings_in_metres_where_the_map_has_a_scale(tmp_path):
    pixels = row_of_places(tmp_path, 0, 10, 20, 40)
    metric = pixels._replace(georeference=MetricFrame("map", 0.5, (3.0, 4.0, 1.0)))
    assert default_distances(pixels, False) == [10, 20, 40]
    assert default_distances(metric, True) == [0, 5, 10]


def test_a_distance_is_that_from_the_query_or_from_the_nearest_right_place():
    places, pixels = frozenset([(10.0, 50.0), (30.0, 50.0)]), np.array([0.5, 2.0])
    assert Query(Path("a"), places, (13.0, 54.0)).distance((19.0, 50.0), pixels) == pytest.approx(
        np.hypot(3, 8)
    )
    assert Query(Path("a"), places).distance((26.0, 50.0), pixels) == pytest.approx(2.0)
    assert np.isnan(Query(Path("a"), frozenset()).distance((26.0, 50.0), pixels))


def test_photos_of_the_map_are_queries_of_their_places(tmp_path):
    first, second = queries_of_photos(row_of_places(tmp_path, 0, 10))
    assert first == Query(tmp_path / "0.png", frozenset([(0.0, 50.0)]), (0.0, 50.0))
    assert second.path == tmp_path / "1.png"


def test_in_clusters_right_is_the_cluster_of_a_right_place(tmp_path):
    place_map = row_of_places(tmp_path, 0, 10, 20, 100, 110, 120)
    clusters = clustered(place_map, 2)  # their middle places are at 10 and 110
    queries = [
        Query(Path(f"{i}"), frozenset((float(x), 50.0) for x in xs))
        for i, xs in enumerate(([20], [], [0, 120]))
    ]
    assert [each.true_places for each in queries_in_clusters(queries, place_map, clusters)] == [
        {(10.0, 50.0)},
        set(),
        {(10.0, 50.0), (110.0, 50.0)},
    ]
    photo, others, query = list(leave_one_out_queries(place_map, 10.0, clusters))[2]
    assert (photo.x, len(others.photos), {each.x for each in others.photos}) == (20.0, 5, {10.0, 110.0})
    assert (query.true_places, query.position) == ({(10.0, 50.0)}, (20.0, 50.0))


def test_a_pixel_of_corners_on_the_earth_is_not_square(tmp_path):
    corners = GeoCorners((0.01, 0.0), (-0.01, 0.01))  # 2226 m up, 1113 m across: 4.45 and 1.11 m a pixel
    place_map = row_of_places(tmp_path, 500, georeference=corners)
    assert places_near(place_map, (502.0, 50.0), 2.3) and not places_near(place_map, (502.0, 50.0), 2.2)
    assert places_near(place_map, (500.0, 52.0), 9.0) and not places_near(place_map, (500.0, 52.0), 8.8)


def test_photos_of_another_map_are_queries_in_its_order(tmp_path):
    other = row_of_places(tmp_path / "walk", 400, 18)
    far, near = queries_of_map(row_of_places(tmp_path, 0, 10, 20), other, 5.0)
    assert (far.path, far.true_places, far.position) == (tmp_path / "walk/0.png", frozenset(), (400.0, 50.0))
    assert (near.path, near.true_places) == (tmp_path / "walk/1.png", {(20.0, 50.0)})


@pytest.mark.parametrize(
    "change",
    [
        {"overview": Overview("park.png", 999, 500)},
        {"georeference": MetricFrame("map", 0.5, (0.0, 0.0, 0.0))},
    ],
)
def test_another_overview_is_refused(change, tmp_path):
    place_map = row_of_places(tmp_path, 0, 10)
    with pytest.raises(ValueError, match="another overview"):
        queries_of_map(place_map, place_map._replace(**change), 5.0)


def test_a_table_names_the_right_photos(tmp_path):
    (tmp_path / "truth.csv").write_text("query,right_refs\na.jpg,0.png 2.png\nb.jpg,\n")
    one, nowhere = queries_of_table(
        row_of_places(tmp_path, 0, 10, 20), tmp_path / "truth.csv", tmp_path / "q"
    )
    assert (one.path, one.true_places, one.position) == (
        tmp_path / "q/a.jpg",
        {(0.0, 50.0), (20.0, 50.0)},
        None,
    )
    assert (nowhere.path, nowhere.true_places) == (tmp_path / "q/b.jpg", frozenset())


@pytest.mark.parametrize(
    "text, reason",
    [
        ("", ":1: the columns"),
        ("query,photo\na,b\n", ":1: the columns"),
        ("query,right_refs\na.jpg,0.png\nb.jpg,0.png 7.png\n", ":3: 7.png is not a photo"),
        ("query,right_refs\n,0.png\n", ":2: the query is missing"),
    ],
)
def test_a_table_that_cannot_be_is_refused_with_its_line(text, reason, tmp_path):
    (tmp_path / "truth.csv").write_text(text)
    with pytest.raises(ValueError, match=reason):
        queries_of_table(row_of_places(tmp_path, 0), tmp_path / "truth.csv", tmp_path)


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\xff", b"query,right_refs\n" + 200_000 * b"a"])
def test_what_is_no_table_is_named(content, tmp_path):
    (tmp_path / "truth.csv").write_bytes(content)
    with pytest.raises(ValueError, match=r"truth.csv:\d: "):
        queries_of_table(row_of_places(tmp_path, 0), tmp_path / "truth.csv", tmp_path)


def test_a_photo_that_is_left_out_is_right_at_its_neighbours_only(tmp_path):
    found = list(leave_one_out_queries(row_of_places(tmp_path, 0, 10, 40), 15.0))
    assert [(photo.id, query.true_places) for photo, _, query in found] == [
        (0, {(10.0, 50.0)}),
        (1, {(0.0, 50.0)}),
        (2, frozenset()),
    ]
    assert [[photo.id for photo in others.photos] for _, others, _ in found] == [[1, 2], [0, 2], [0, 1]]


def test_another_image_of_the_same_place_is_right(tmp_path):
    found = list(leave_one_out_queries(row_of_places(tmp_path, 10, 10), 0.0))
    assert [query.true_places for _, _, query in found] == [{(10.0, 50.0)}] * 2
