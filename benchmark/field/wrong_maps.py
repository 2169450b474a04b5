# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps that are centimetres off: successive images, the same images one by one, and declared errors."""

from pathlib import Path
from typing import List, NamedTuple

import numpy as np
from real_data import read_tagslam
from tables import Row, Table, Value

import sextant
from field.faulty_room import MARKERS, Truth, drive, mapped, room

RECORDING = "tagslam_9"  # a drive through a hall
SEEDS, IMAGES = 10, 600
OFF, DECLARED = 0.03, 0.02  # m, standard deviations of the markers' positions
NOISE = 0.3  # pixels
MOST, LEAST = 1.1, 0.99  # bars: 95 % error over that of single images; poses over those of an exact map
COLUMNS = ["median, cm", "95 %", "worst", "one by one: median", "95 %", "worst", "95 % over one by one"]


class Errors(NamedTuple):
    """Errors of the position by image, m; NaN without a pose."""

    successive: np.ndarray
    single: np.ndarray


def wrong_map_tables(folder: Path, quick: bool) -> List[Table]:
    """Real and simulated halls; a map with declared errors. :raises OSError: the recording is not there"""
    seeds = 1 if quick else SEEDS
    halls = [_hall(seed, 100 if quick else IMAGES) for seed in range(seeds)]
    simulated = Errors(*(np.concatenate(errors) for errors in zip(*halls)))
    rows = [
        (RECORDING, _cells(_recorded(folder, quick), quick)),
        (f"simulated hall, map off by {100 * OFF:g} cm", _cells(simulated, quick)),
    ]
    title = "Wrong maps: errors of the position, successive images and the same images one by one"
    return [Table(title, COLUMNS, rows), _declared(seeds, quick)]


def _recorded(folder: Path, quick: bool) -> Errors:
    recording = read_tagslam(folder / RECORDING)
    images = recording.referenced()[: 200 if quick else None]
    localization, locator, errors = sextant.MarkerLocalization(), _locator(), []
    for image in images:
        truth, view = recording.trajectory[image.stamp], recording.view(image)
        successive = localization.locate(recording.map, [view], None, image.stamp).pose
        single = locator.locate(recording.map, [view]).pose
        errors.append((_error(successive, truth), _error(single, truth)))
    return Errors(*np.array(errors).T)


def _hall(seed: int, images: int) -> Errors:
    random = np.random.default_rng([seed, 9])
    poses = room(random)
    truth, marker_map = Truth(offsets=OFF * random.normal(size=(MARKERS, 3))), mapped(poses)
    localization, locator, errors = sextant.MarkerLocalization(), _locator(), []
    for seen in drive(poses, truth, images, NOISE, random):
        successive = localization.locate(marker_map, [seen.view], None, seen.stamp).pose
        single = locator.locate(marker_map, [seen.view]).pose
        errors.append((_error(successive, seen.T_map_base), _error(single, seen.T_map_base)))
    return Errors(*np.array(errors).T)


def _locator():
    """One that accepts poses of a wrong map, too."""
    params = sextant.LocatorParams()
    params.max_reprojection_error = 100.0
    return sextant.MarkerLocator(params)


def _error(pose, T_map_base: np.ndarray) -> float:
    return float(np.linalg.norm(pose.T_map_base[:3, 3] - T_map_base[:3, 3])) if pose else np.nan


def _cells(errors: Errors, quick: bool) -> List[Value]:
    both = np.isfinite(errors.successive) & np.isfinite(errors.single)
    quantiles = [np.quantile(100.0 * each[both], (0.5, 0.95, 1.0)) for each in errors]
    ratio = quantiles[0][1] / quantiles[1][1]
    cells = [Value(each) for each in np.concatenate(quantiles)]
    return [*cells, Value(ratio, at_most=None if quick else MOST)]


def _declared(seeds: int, quick: bool) -> Table:
    rows: List[Row] = []
    for name, sigma in (("exact map", 0.0), (f"off by {100 * DECLARED:g} cm, declared", DECLARED)):
        found = []
        for seed in range(seeds):
            random = np.random.default_rng([seed, 2])
            poses = room(random)
            truth = Truth(offsets=sigma * random.normal(size=(MARKERS, 3)))
            localization, marker_map = sextant.MarkerLocalization(), mapped(poses, sigma)
            for seen in drive(poses, truth, 100 if quick else IMAGES, NOISE, random):
                found.append(bool(localization.locate(marker_map, [seen.view], None, seen.stamp).pose))
        rows.append((name, [Value(len(found), 0), Value(np.mean(found), 4)]))
    share = rows[1][1][1].value / rows[0][1][1].value
    rows.append(("  over the exact map's", ["", Value(share, 4, at_least=None if quick else LEAST)]))
    return Table("A map with declared errors: images with a pose", ["images", "share with a pose"], rows)
