# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Methods on the same photos: what each of them finds and costs."""

from functools import partial

import cv2
import numpy as np
import pytest
from made_evaluations import PLACES, evaluation_of, result_of
from made_photos import picture, shifted, written_photos

from sextant.place_maps.place_clusters import clustered
from sextant.place_maps.place_map import Overview, PlaceMap
from sextant.place_reports.place_comparison import (
    METHODS,
    ComparedMethod,
    compare,
    compared_methods,
    comparison_table,
    in_clusters,
    method_params,
)
from sextant.places.place_evaluation import evaluate, evaluate_leave_one_out
from sextant.places.place_index import IndexParams, plain_features
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_queries import Query


def test_names_are_those_of_the_list():
    assert compared_methods("sift, orb,sift", None) == ["sift", "orb"]
    assert compared_methods(None, None) == [] and compared_methods(None, 4) == ["default"]
    with pytest.raises(
        ValueError, match="'surff' is not a method to compare; known are surf, sift, orb, akaze"
    ):
        compared_methods("sift,surff", None)


def test_the_default_method_has_the_default_parameters():
    params = method_params("default", {})
    assert params.index_params() == IndexParams() and params.localization.mode == "single"


@pytest.mark.parametrize("name", ["surf", "sift", "orb", "akaze"])
def test_the_others_count_votes_of_opencvs_features(name):
    params = method_params(name, {})
    assert params.index_params().features == plain_features(name.upper(), name.upper())
    assert params.localization.mode == "votes"
    params.index_params().validate()


def test_thresholds_can_be_set_but_not_what_makes_the_method():
    features = method_params("orb", {"max_features": 800, "min_matches": 5}).index_params().features
    assert (features["max_features"], features["max_side"]) == (800, 0)
    assert method_params("default", {"detector": "AKAZE", "extractor": "AKAZE"}).detector == "AKAZE"
    with pytest.raises(ValueError, match="detector cannot be set: the compared method 'orb' has its own"):
        method_params("orb", {"detector": "SIFT"})
    with pytest.raises(ValueError, match="mode cannot be set"):
        method_params("default", {"mode": "filter"})


@pytest.fixture(scope="module")
def park(tmp_path_factory):
    """Six places ten pixels apart, with queries a bit aside of the first three."""
    folder = tmp_path_factory.mktemp("park")
    place_map = written_photos(folder, 6)
    queries = []
    for i in range(3):
        cv2.imwrite(str(folder / f"q{i}.png"), shifted(picture(i), 4, 2, seed=i))
        queries.append(Query(folder / f"q{i}.png", frozenset([(10.0 * i, 50.0)]), (10.0 * i + 2, 50.0)))
    reports = []
    return (
        PlaceIndexer(folder / "park.txt", place_map, IndexParams(), report=reports.append),
        queries,
        reports,
    )


@pytest.mark.slow
def test_every_method_finds_photos_of_the_map_and_of_new_ones(park):
    indexer, queries, reports = park
    methods = {name: method_params(name, {"min_matches": 3}) for name in METHODS}
    compared = compare(indexer, methods, partial(evaluate, queries=queries))
    assert [each.name for each in compared] == list(METHODS)
    for each in compared:
        assert each.map_photos.within(0.0) == 1.0 and len(each.map_photos.results) == 6
        assert (each.new_photos.within(1.9), each.new_photos.within(2.0)) == (0.0, 1.0)
        cost = each.new_photos.cost
        assert cost.keypoints > 6 * 20 and cost.index_bytes > 0 and not cost.is_loaded
        assert np.isnan(each.right_cluster)
    assert "orb: " in " ".join(reports)
    assert not list(indexer.place_map.folder.glob("*.index"))  # the cache of the map's user


@pytest.mark.slow
@pytest.mark.parametrize("leave_out", [False, True])
def test_clusters_are_compared_with_exact_positions(park, leave_out):
    indexer, queries, _ = park
    clusters = clustered(indexer.place_map, 2)
    new_photos = partial(evaluate, queries=queries)
    if leave_out:
        new_photos = partial(evaluate_leave_one_out, tolerance=10.0)
    exact, merged = compare(indexer, {"default": method_params("default", {})}, new_photos, clusters)
    assert (exact.name, merged.name) == ("default", "default, 2 clusters")
    assert (exact.clusters, merged.clusters) == (0, 2)
    assert merged.map_photos.recall(1) == 1.0
    if not leave_out:
        assert exact.right_cluster == merged.right_cluster == 1.0
    positions = {(each.x, each.y) for each in clusters.photos}
    assert {place for each in merged.new_photos.results for place in each.query.true_places} <= positions
    heads = comparison_table([exact, merged], [10.0], "px").heads
    assert heads[-1] == "right\ncluster, %"


def test_an_answer_in_the_right_cluster_may_be_the_wrong_place():
    place_map = PlaceMap("", Overview("park.png", 200, 10), tuple(PLACES))
    clusters = clustered(place_map, 2)  # 0 to 5 and 6 to 11
    results = [result_of([1], [(4, 0.9)]), result_of([1], [(8, 0.9)]), result_of([9], [(9, 0.9)])]
    exact = evaluation_of(*results)
    assert exact.recall(1) == pytest.approx(1 / 3)
    assert in_clusters(exact, place_map, clusters).recall(1) == pytest.approx(2 / 3)


def test_the_table_has_the_figures():
    found = evaluation_of(
        result_of([1], [(1, 0.9)], position=(12.0, 5.0), seconds=0.010),
        result_of([1], [(3, 0.9)], position=(12.0, 5.0), seconds=0.030),
    )
    table = comparison_table([ComparedMethod("sift", 0, found, found, np.nan)], [2.0, 18.0], "m")
    assert len(table.heads) == 10 and table.heads[6:8] == ("map\n≤ 2 m, %", "map\n≤ 18 m, %")
    cells = ("sift", "1200", "3.00", "2.0", "20.0", "29.0", "50.0", "100.0", "50.0", "100.0")
    assert table.rows[0].cells == cells
