# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How good a place map is: figures that can be computed by hand, and images of which it is known."""

from itertools import permutations
from pathlib import Path

import cv2
import numpy as np
import pytest
from made_network import projection_network
from made_photos import picture, shifted, written_photos

import sextant
from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.places.global_descriptor import GlobalDescriptorParams
from sextant.places.index_params import IndexParams, plain_features
from sextant.places.place_estimate import PlaceEstimate
from sextant.places.place_evaluation import (
    WARM_UP_IMAGE,
    Cost,
    PlaceEvaluation,
    QueryResult,
    evaluate,
    evaluate_leave_one_out,
)
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import Localization, PlaceHypothesis, PlaceLocalizationParams, Status
from sextant.places.place_queries import Query
from sextant.places.place_recognition import RecognitionParams

PLACES = [Photo(i, f"{i}.png", 10.0 * i, 5.0) for i in range(12)]


def outcome(right, answers, status=Status.AMBIGUOUS, estimate=None, position=None, seconds=0.1):
    """:param right: numbers of places; answers: pairs of a number and a probability"""
    query = Query(Path("q.png"), frozenset((PLACES[i].x, PLACES[i].y) for i in right), position)
    hypotheses = [PlaceHypothesis(PLACES[number], probability, None) for number, probability in answers]
    return QueryResult(query, Localization(status, hypotheses, 0.0, estimate, False, None, None), seconds)


def evaluation(*results, pixels=(1.0, 1.0)):
    return PlaceEvaluation(results, np.array(pixels), Cost(2.0, True, 3000000, 4000000))


def test_recall_is_of_the_queries_in_the_map():
    found = evaluation(
        outcome([1], [(1, 0.9)]),
        outcome([1, 2], [(3, 0.8), (2, 0.1)]),
        outcome([4], [(n, 0.1) for n in (0, 1, 2, 3, 5, 6, 4)]),
        outcome([5], []),
        outcome([], [(7, 0.6)]),
    )
    assert found.ranks.tolist() == [1, 2, 7, np.inf]
    figures = found.figures()
    assert [figures[f"recall@{n}"] for n in (1, 5, 10)] == [0.25, 0.5, 0.75]
    assert (figures["queries"], figures["unmapped_queries"]) == (5, 1)


def test_the_share_within_a_distance_is_of_the_queries_in_the_map():
    found = evaluation(
        outcome([1], [(1, 0.9)], position=(13.0, 5.0)),  # 3 pixels from the truth, 1.5 m
        outcome([1], [(4, 0.9), (1, 0.1)]),  # 30 pixels from the right place
        outcome([2], []),
        outcome([], [(3, 0.9)], position=(30.0, 5.0)),
        pixels=(0.5, 0.5),
    )
    shares = [found.within(distance) for distance in (1.4, 1.5, 14.9, 15.0, 1e6)]
    assert shares == pytest.approx([0, 1 / 3, 1 / 3, 2 / 3, 2 / 3])
    assert found.results[1].errors(found.pixels).tolist() == [15.0, 0.0]
    assert np.isnan(evaluation(outcome([], [])).within(1.0))


def test_an_answer_to_a_query_of_an_unknown_place_is_wrong():
    found = evaluation(outcome([1], [(1, 0.8)]), outcome([], [(1, 0.9)]), outcome([2], []))
    probabilities, right = found.predictions
    assert (probabilities.tolist(), right.tolist()) == ([0.8, 0.9], [True, False])
    assert found.calibration_error == pytest.approx((0.2 + 0.9) / 2)
    assert found.curve.precision.tolist() == [0.0, 0.5]
    assert found.curve.recall.tolist() == [0.0, 0.5]  # of two queries in the map
    assert found.curve.area == pytest.approx(0.5 * 0.5 / 2)


def test_unknown_rates_of_mapped_and_unmapped_queries():
    found = evaluation(
        outcome([1], [(1, 0.2)], Status.UNKNOWN_PLACE),
        *(outcome([1], [(1, 0.8)]) for _ in range(3)),
        outcome([], [(1, 0.2)], Status.UNKNOWN_PLACE),
        outcome([], [(1, 0.8)], Status.LOCALIZED),
    )
    assert (found.unknown_rate(True), found.unknown_rate(False)) == (0.25, 0.5)


def test_position_errors_are_in_metres():
    estimate = PlaceEstimate(13.0, 9.0, np.diag([4.0, 4.0]), None)
    found = evaluation(
        outcome([1], [(1, 0.8)], estimate=estimate, position=(10.0, 5.0)),
        outcome([1], [(1, 0.8)], position=(10.0, 5.0)),
        outcome([1], [(1, 0.8)], estimate=estimate),
        pixels=(2.0, 0.5),
    )
    assert found.position_errors.tolist() == [[6.0, 2.0]]
    assert found.figures()["position_error"] == pytest.approx(np.hypot(6, 2))


@pytest.mark.parametrize("deviations, inside", [(2.447, 1.0), (2.448, 0.0)])  # sqrt(-2 ln 0.05) = 2.4477
def test_the_ellipse_holds_95_percent(deviations, inside):
    covariance = np.array([[9.0, 2.0], [2.0, 4.0]])
    direction = np.linalg.cholesky(covariance) @ (0.6, 0.8)
    estimate = PlaceEstimate(*(deviations * direction), covariance, None)
    of_one = outcome([0], [(0, 0.8)], estimate=estimate, position=(0.0, 0.0))
    assert evaluation(of_one, pixels=(0.1, 0.3)).ellipse_coverage == inside


def test_honest_ellipses_hold_the_truth_as_often_as_stated():
    rng = np.random.default_rng(4)
    results = [
        outcome([0], [(0, 1.0)], estimate=PlaceEstimate(*xy, np.diag([9.0, 1.0]), None), position=(0.0, 0.0))
        for xy in rng.normal(0, (3, 1), (2000, 2))
    ]
    assert 0.935 < evaluation(*results).ellipse_coverage < 0.965


def test_times_and_costs():
    figures = evaluation(*(outcome([1], [], seconds=0.001 * n) for n in range(101))).figures()
    assert (figures["query_ms"], figures["query_ms_95"]) == pytest.approx((50, 95))
    assert [figures[name] for name in ("index_seconds", "index_mb", "resident_mb")] == [2.0, 3.0, 4.0]


def test_what_was_not_measured_is_no_number():
    figures = evaluation(outcome([], [], Status.UNUSABLE)).figures()
    unknown = {name for name, value in figures.items() if np.isnan(value)}
    assert unknown == {
        *("recall@1", "recall@5", "recall@10", "area", "calibration_error", "perfect_calibration_error"),
        *("unknown_rate_in_map", "position_error", "position_error_90", "ellipse_coverage"),
    }


# ---- pictures ---------------------------------------------------------------------------------------------


def library_of(place_map, settings=None):
    return PlaceIndexer(place_map.folder / "park.txt", place_map, settings or IndexParams())


def queries_of(folder, place_map, *seeds):
    """Pictures beside those of the map's photos; a seed that the map does not have is nowhere."""
    queries = []
    for seed in seeds:
        cv2.imwrite(str(folder / f"q{seed}.png"), shifted(picture(seed), 4, 2, seed=seed))
        position = (10.0 * seed, 50.0)
        right = frozenset((p.x, p.y) for p in place_map.photos if (p.x, p.y) == position)
        queries.append(Query(folder / f"q{seed}.png", right, position))
    return queries


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["single", "filter", "sequence"])
def test_photos_that_are_seen_again_are_found(mode, tmp_path):
    place_map = written_photos(tmp_path, 5)
    queries = queries_of(tmp_path, place_map, *range(5))
    found = evaluate(library_of(place_map), PlaceLocalizationParams(mode=mode), queries)
    figures = found.figures()
    assert (
        figures["recall@1"] == 1.0
        and figures["unmapped_queries"] == 0
        and figures["area"] == pytest.approx(1)
    )
    assert figures["unknown_rate_in_map"] == 0.0 and figures["position_error"] < 15
    assert not found.cost.is_loaded and figures["index_mb"] > 0
    assert evaluate(library_of(place_map), PlaceLocalizationParams(mode=mode), queries[:1]).cost.is_loaded


@pytest.mark.slow
def test_a_place_that_the_map_does_not_have_is_an_unknown_place(tmp_path):
    place_map = written_photos(tmp_path, 5)
    found = evaluate(
        library_of(place_map),
        PlaceLocalizationParams(mode="single"),
        queries_of(tmp_path, place_map, 20, 21, 3),
    )
    assert (found.unknown_rate(False), found.unknown_rate(True), found.recall(1)) == (1.0, 0.0, 1.0)


@pytest.mark.slow
def test_a_network_sees_the_colours_of_queries(tmp_path):
    """Photos of one scene that differ in their tint, seen again with noise."""
    grey, tints = picture(3), list(permutations((1.0, 0.6, 0.3)))
    for i, tint in enumerate(tints):
        photo = (grey[..., None] * tint).astype(np.uint8)
        cv2.imwrite(str(tmp_path / f"{i}.png"), photo)
        noise = np.random.default_rng(i).integers(0, 30, photo.shape)
        cv2.imwrite(str(tmp_path / f"q{i}.png"), np.clip(photo + noise, 0, 255).astype(np.uint8))
    photos = tuple(Photo(i, f"{i}.png", 100.0 * i, 50.0) for i in range(len(tints)))
    place_map = PlaceMap(tmp_path, Overview("park.png", 1000, 100), photos)
    model = projection_network(tmp_path / "net.onnx", np.eye(3, dtype=np.float32))
    network = GlobalDescriptorParams(model, width=64, height=48, mean=(0, 0, 0), std=(1, 1, 1))
    queries = [Query(tmp_path / f"q{i}.png", frozenset({(100.0 * i, 50.0)})) for i in range(len(tints))]
    found = evaluate(
        library_of(place_map, IndexParams(global_descriptor=network)),
        PlaceLocalizationParams("single", recognition=RecognitionParams(network_weight=10.0)),
        queries,
    )
    assert found.recall(1) == 1.0


def twins(folder):
    """Five places with a photo of their own, of which the next ones show two."""
    photos = []
    for i, seed in enumerate((0, 0, 1, 1, 2)):
        cv2.imwrite(str(folder / f"{i}.png"), shifted(picture(seed), 4 * i, 2, seed=i))
        photos.append(Photo(i, f"{i}.png", 100.0 * seed + i, 50.0))
    return PlaceMap(folder, Overview("park.png", 1000, 100), tuple(photos))


@pytest.mark.slow
@pytest.mark.parametrize(
    "mode, settings",
    [("single", None), ("votes", IndexParams(plain_features("SIFT", "SIFT"), "BruteForce"))],
)
def test_a_photo_that_is_left_out_finds_its_twin_and_never_itself(mode, settings, tmp_path):
    library = library_of(twins(tmp_path), settings)
    found = evaluate_leave_one_out(library, PlaceLocalizationParams(mode=mode), 10.0)
    assert found.recall(1) == 1.0 and len(found.ranks) == 4
    for each in found.results:
        assert each.query.path.name not in [answer.photo.image for answer in each.found.hypotheses]
    if mode == "single":
        assert found.unknown_rate(False) == 1.0  # that of the fifth, which has no twin


@pytest.mark.parametrize("features", sextant.feature_names())
def test_the_first_query_does_not_train_the_matcher(features):
    """OpenCV's matchers are trained by the first search; without keypoints nothing is searched."""
    params = IndexParams(plain_features(features, features)).feature_params()
    assert len(sextant.FeatureExtractor(params).extract(WARM_UP_IMAGE).keypoints) > 100


def test_modes_that_carry_on_leave_no_photo_out(tmp_path):
    library = library_of(written_photos(tmp_path, 2))
    with pytest.raises(ValueError, match="leave-one-out needs single or votes"):
        evaluate_leave_one_out(library, PlaceLocalizationParams(mode="filter"), 10.0)


def test_of_one_photo_none_is_left_out(tmp_path):
    with pytest.raises(ValueError, match="park.txt: leave-one-out needs at least two photos"):
        evaluate_leave_one_out(
            library_of(written_photos(tmp_path, 1)), PlaceLocalizationParams(mode="single"), 10.0
        )
