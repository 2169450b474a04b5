# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recall on walks along the simulated street with the map of another season."""

import tempfile
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import numpy as np
from tables import Row, Table, Value

from places.place_recall import COLUMNS, MODES, measured, row_of
from places.place_walk import Shot, Size, take_all
from sextant.place_maps.place_map import MetricFrame, Overview, Photo, PlaceMap
from sextant.places.place_evaluation import PlaceEvaluation
from sextant.places.place_queries import Query, default_tolerance, queries_of_map
from sextant.places.rough_pose import RoughPose
from sextant.streets.street import LENGTH, WIDTH, Street
from sextant.streets.street_conditions import CONDITIONS, at_hour

SEED = 1
MAP_STEP, QUERY_STEP = 3.0, 4.0  # distance between photos, metres
ASIDE, TURN = 0.5, 0.08  # standard deviations of the queries' offset and yaw, metres and radians
SIZE: Size = (640, 480)
FEW, SMALL = 12, (320, 240)  # number and size of the photos of a quick run
MARGIN, RESOLUTION = 10.0, 0.1  # of the overview: metres, metres per pixel
PAIRS = (("summer", "autumn"), ("summer", "winter"), ("autumn", "winter"))
BARS = {("autumn", "winter", "single"): 0.60, ("autumn", "winter", "filter"): 0.85}  # minimum recall@1
POSITION = ["median error, m", "in 95 % ellipse, %"]
HARD_SEEDS = (3, 4)  # of the streets; the conditions were made on streets 1 and 2
HARD_PAIRS = (("autumn", "snow"), ("summer", "low_sun"), ("autumn", "wet"))
HARD_BARS = {"single": 0.55, "filter": 0.85}  # minimum mean of recall@1
HARD_MODES = (*HARD_BARS, "filter, GPS")
FIX_DEVIATION = 5.0  # standard deviation of the simulated GPS, the same error for a whole walk, m
HARD_ASIDE, HARD_TURN = 1.0, np.deg2rad(15.0)  # offset and yaw of every query, to either side
HARD_CAMERA = "phone"
HOURS = (9.5, 11.0, 13.0, 14.5)  # of the parts of the walk, by the sun


def season_tables(quick: bool) -> List[Table]:
    """Tables of usual and of hard pairs of map and walk; a quick run has one pair of a few metres each."""
    return [_usual(quick), _hard(quick)]


def _usual(quick: bool) -> Table:
    pairs, count, size = (PAIRS[:1], FEW, SMALL) if quick else (PAIRS, None, SIZE)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        maps = {season: walk(folder / "map", season, MAP_STEP, size, count) for season, _ in pairs}
        walks = {season: walk(folder / "walk", season, QUERY_STEP, size, count) for _, season in pairs}
        rows = [row for pair in pairs for row in _rows(folder, pair, maps, walks, quick)]
    title = f"Simulated street, a map with a place every {MAP_STEP:g} m, a query every {QUERY_STEP:g} m"
    return Table(title, COLUMNS + POSITION, rows)


def _hard(quick: bool) -> Table:
    """Walks with another camera, off the way of the map, in bare, snowy or wet streets in low sun."""
    pairs, seeds = (HARD_PAIRS[:1], HARD_SEEDS[:1]) if quick else (HARD_PAIRS, HARD_SEEDS)
    count, size = (FEW, SMALL) if quick else (None, SIZE)
    found: Dict[str, List[PlaceEvaluation]] = {mode: [] for mode in HARD_MODES}
    rows = []
    for seed, pair in product(seeds, pairs):
        with tempfile.TemporaryDirectory() as name:
            place_map, queries = hard_walk(Path(name), pair, seed, size, count)
            fixed = _with_fixes(queries, seed)
            for mode, all_of in found.items():
                given = fixed if mode.endswith("GPS") else queries
                all_of.append(measured(Path(name), pair[0], place_map, given, mode.split(",")[0]))
                rows.append(row_of(f"{pair[0]} -> {pair[1]}, street {seed}, {mode}", all_of[-1], {}))
    rows += [_mean(mode, all_of, None if quick else HARD_BARS.get(mode)) for mode, all_of in found.items()]
    title = (
        f"Hard seasons: a {HARD_CAMERA}, {HARD_ASIDE:g} m and {np.rad2deg(HARD_TURN):.0f} degrees off the "
        f"map's way, in the sun of a day in December from {HOURS[0]:g} to {HOURS[-1]:g} o'clock"
    )
    return Table(title, COLUMNS, rows)


def _with_fixes(queries: List[Query], seed: int) -> List[Query]:
    """The queries with rough positions, all with the same error."""
    deviation = FIX_DEVIATION / RESOLUTION
    error = np.random.default_rng([seed, 1]).normal(0, deviation, 2)
    covariance = deviation**2 * np.eye(2)
    return [
        query._replace(rough=RoughPose(*(np.array(query.position) + error), covariance)) for query in queries
    ]


def _mean(mode: str, found: List[PlaceEvaluation], bar: Optional[float]) -> Row:
    first, fifth = (float(np.mean([each.recall(k) for each in found])) for k in (1, 5))
    cells = [Value(first, 3, at_least=bar), Value(fifth, 3)]
    return f"mean, {mode}", cells + ["-"] * (len(COLUMNS) - len(cells))


def hard_walk(
    folder: Path, pair: Tuple[str, str], seed: int, size: Size, count: Optional[int] = None
) -> Tuple[PlaceMap, List[Query]]:
    """A map in one condition, and queries to it in another one by another camera."""
    place_map = walk(folder / f"map{seed}", pair[0], MAP_STEP, size, count, seed)
    rng, arcs = np.random.default_rng(seed), np.arange(0.0, _street().length, QUERY_STEP)[:count]
    aside, turn = rng.choice([-1.0, 1.0], (2, len(arcs))) * [[HARD_ASIDE], [HARD_TURN]]
    hours = np.array(HOURS)[np.arange(len(arcs)) * len(HOURS) // len(arcs)]
    shots = [
        Shot(
            folder / f"walk{seed}" / f"{pair[1]}_{i:03}.jpg",
            size,
            seed,
            at_hour(CONDITIONS[pair[1]], hours[i]),
            arc,
            aside[i],
            turn[i],
            i,
            HARD_CAMERA,
        )
        for i, arc in enumerate(arcs)
    ]
    walked = _map_of(folder / f"walk{seed}", shots)
    return place_map, queries_of_map(place_map, walked, default_tolerance(place_map))


def walk(
    folder: Path, season: str, step: float, size: Size, count: Optional[int] = None, seed: int = SEED
) -> PlaceMap:
    """Photos of a walk around the block, or of its first steps; photos of a map have no offset and rotation.

    :param step: distance between photos, metres; MAP_STEP: photos of a map
    :param count: number of photos; None: the whole block
    :param seed: of the street, and of the walker's offsets
    """
    is_map = step == MAP_STEP
    arcs = np.arange(0.0, _street().length, step)[:count]
    rng = np.random.default_rng(seed)
    drawn = np.zeros((2, len(arcs))) if is_map else rng.normal(0, 1, (2, len(arcs)))
    aside, turn = drawn * [[ASIDE], [TURN]]
    shots = [
        Shot(folder / f"{season}_{i:03}.jpg", size, seed, CONDITIONS[season], *each, i)
        for i, each in enumerate(zip(arcs, aside, turn))
    ]
    return _map_of(folder, shots)


def _map_of(folder: Path, shots: List[Shot]) -> PlaceMap:
    """Takes the photos, which are in the folder, and maps them."""
    folder.mkdir(exist_ok=True)
    take_all(shots)
    overview = Overview("none.png", *(int((side + 2 * MARGIN) / RESOLUTION) for side in (LENGTH, WIDTH)))
    frame = MetricFrame("map", RESOLUTION, (-MARGIN, -MARGIN, 0.0))
    poses = [_street().pose(shot.arc, shot.aside, shot.turn) for shot in shots]
    photos = tuple(
        Photo(i, shot.path.name, *frame.pixel(overview, *pose[:2]), frame.photo_yaw(pose[2]))
        for i, (shot, pose) in enumerate(zip(shots, poses))
    )
    return PlaceMap(folder, overview, photos, frame)


@lru_cache(maxsize=1)
def _street() -> Street:
    return Street(SEED)


def _rows(
    folder: Path, pair: Tuple[str, str], maps: Dict[str, PlaceMap], walks: Dict[str, PlaceMap], quick: bool
) -> List[Row]:
    place_map = maps[pair[0]]
    queries = queries_of_map(place_map, walks[pair[1]], default_tolerance(place_map))
    rows = []
    for mode in MODES:
        found = measured(folder, pair[0], place_map, queries, mode)
        bar = None if quick else BARS.get((*pair, mode))
        errors = np.linalg.norm(found.position_errors, axis=1)
        name, cells = row_of(f"{pair[0]} -> {pair[1]}, {mode}", found, {"at_least": bar})
        error = Value(np.median(errors) if len(errors) else np.nan, 1)
        rows.append((name, [*cells, error, Value(100 * found.ellipse_coverage, 0)]))
    return rows
