# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares methods of place recognition on one map, with each image localized on its own."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np

from sextant.base.html_report import Row, Table
from sextant.base.strict_params import parse_params
from sextant.place_maps.place_map import PlaceMap
from sextant.places.place_evaluation import PlaceEvaluation, evaluate
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import VOTES
from sextant.places.place_method_params import PlaceMethodParams
from sextant.places.place_queries import queries_in_clusters, queries_of_photos


def _votes(features: str, matcher: str) -> Dict[str, Any]:
    """Parameters that count the votes of OpenCV's features, as older programs do."""
    plain = {"profile": "plain", "detector": features, "extractor": features}
    return {"mode": VOTES, "matcher": matcher, **plain}


# parameters of PlaceMethodParams by the name of the method; default: the default parameters
METHODS: Dict[str, Dict[str, Any]] = {
    "surf": _votes("SURF", "FlannBased"),
    "sift": _votes("SIFT", "FlannBased"),
    "orb": _votes("ORB", "BruteForce-Hamming"),
    "akaze": _votes("AKAZE", "BruteForce-Hamming"),
    "default": {"mode": "single"},
}
Evaluate = Callable[..., PlaceEvaluation]  # evaluate() or evaluate_leave_one_out() with their queries


class ComparedMethod(NamedTuple):
    """Evaluation of a method on a map."""

    name: str  # of the method, and of the map if it is one of clusters
    clusters: int  # their number; 0: exact positions
    map_photos: PlaceEvaluation  # queries: the photos of the map
    new_photos: PlaceEvaluation  # other queries
    right_cluster: float  # fraction of the new photos in the map; nan: there are no clusters


def compared_methods(methods: Optional[str], clusters: Optional[int]) -> List[str]:
    """Names of the compared methods.

    :param methods: names of METHODS, separated by commas; None: `default` if there are clusters
    :param clusters: their number; None: none
    :returns: empty if nothing is compared
    :raises ValueError: an unknown method
    """
    if methods is None:
        return [] if clusters is None else ["default"]
    names = [name.strip() for name in methods.split(",")]
    unknown = [name for name in names if name not in METHODS]
    if unknown:
        raise ValueError(f"'{unknown[0]}' is not a method to compare; known are {', '.join(METHODS)}")
    return list(dict.fromkeys(names))


def method_params(name: str, others: Mapping[str, Any]) -> PlaceMethodParams:
    """Parameters of a method.

    :param name: one of METHODS
    :param others: other parameters by name
    :raises ValueError: a parameter is refused, or the method sets it
    """
    fixed = [parameter for parameter in METHODS[name] if parameter in others]
    if fixed:
        raise ValueError(f"{fixed[0]} cannot be set: the compared method '{name}' has its own")
    return parse_params(PlaceMethodParams, {**others, **METHODS[name]}, "", "")


def compare(
    indexer: PlaceIndexer,
    methods: Mapping[str, PlaceMethodParams],
    new_photos: Evaluate,
    clusters: Optional[PlaceMap] = None,
) -> List[ComparedMethod]:
    """Evaluates each method, with an index that is built anew; the cache beside the map is not touched.

    :param indexer: of the map; its parameters are those of each method
    :param methods: parameters by name, of a mode that localizes each image independently
    :param new_photos: called with indexer, parameters and clusters, see evaluate()
    :param clusters: the map with merged places; every method is also evaluated on it
    :raises: as evaluate()
    """
    compared = []
    for name, params in methods.items():
        with TemporaryDirectory() as folder:
            own = replace(
                indexer,
                params=params.index_params(),
                report=lambda line, name=name: indexer.report(f"{name}: {line}"),
                cache=Path(folder) / "index",
            )
            compared += _compared(name, own, params, new_photos, clusters)
    return compared


def _compared(
    name: str,
    indexer: PlaceIndexer,
    params: PlaceMethodParams,
    new_photos: Evaluate,
    clusters: Optional[PlaceMap],
) -> List[ComparedMethod]:
    photos, localization = queries_of_photos(indexer.place_map), params.localization
    map_exact = evaluate(indexer, localization, photos)
    exact = new_photos(indexer, localization)
    exact = replace(exact, cost=map_exact.cost)  # the index was built once, later it was loaded
    if clusters is None:
        return [ComparedMethod(name, 0, map_exact, exact, np.nan)]
    map_merged = evaluate(indexer, localization, photos, clusters)
    merged = replace(new_photos(indexer, localization, clusters=clusters), cost=map_exact.cost)
    count, right_cluster = len(clusters.places()), in_clusters(exact, indexer.place_map, clusters).recall(1)
    return [
        ComparedMethod(name, 0, map_exact, exact, right_cluster),
        ComparedMethod(f"{name}, {count} clusters", count, map_merged, merged, merged.recall(1)),
    ]


def in_clusters(evaluation: PlaceEvaluation, place_map: PlaceMap, clusters: PlaceMap) -> PlaceEvaluation:
    """An evaluation on exact positions as one of clusters: correct is every place in the correct cluster.

    :param clusters: place_map with merged places
    """
    merged = {photo.id: photo for photo in clusters.photos}
    queries = queries_in_clusters([each.query for each in evaluation.results], place_map, clusters)
    results = []
    for query, result in zip(queries, evaluation.results):
        hypotheses = [each._replace(photo=merged[each.photo.id]) for each in result.found.hypotheses]
        found = result.found._replace(hypotheses=hypotheses)
        results.append(result._replace(query=query, found=found))
    return replace(evaluation, results=results)


def comparison_table(compared: Sequence[ComparedMethod], distances: Sequence[float], unit: str) -> Table:
    """Keypoints, memory, times, and the shares of map photos and new photos localized within distances.

    :param distances: of the best hypothesis from the truth, see PlaceEvaluation.within()
    :param unit: of the distances, m or px
    """
    heads = ["method", "keypoints", "index,\nMB", "build,\ns", "query,\nms", "95 %,\nms"]
    for photos in ("map", "new"):
        heads += [f"{photos}\n≤ {distance:g} {unit}, %" for distance in distances]
    heads += ["right\ncluster, %"] * any(each.clusters for each in compared)
    rows = [Row(tuple(_cells(each, distances)[: len(heads)])) for each in compared]
    return Table(tuple(heads), rows)


def _cells(method: ComparedMethod, distances: Sequence[float]) -> List[str]:
    cost, figures = method.new_photos.cost, method.new_photos.figures()
    evaluations = (method.map_photos, method.new_photos)
    shares = [each.within(distance) for each in evaluations for distance in distances]
    return [
        method.name,
        str(cost.keypoints),
        f"{cost.index_bytes / 1e6:.2f}",
        f"{cost.seconds:.1f}",
        f"{figures['query_ms']:.1f}",
        f"{figures['query_ms_95']:.1f}",
        *(f"{100 * share:.1f}" for share in (*shares, method.right_cluster)),
    ]
