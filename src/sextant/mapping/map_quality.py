# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quality of a marker map from a recording, marker by marker."""

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import Collection, Dict, FrozenSet, List, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.mapping.map_links import Cut, Image, Key, Pair, components, count_links, cuts, weak_cuts

MISFIT_SHARE = 0.2  # of a marker's observations; a marker with more left out does not fit
MISFIT_OBSERVATIONS = 5  # minimum number of those left out
UNCERTAIN_POSITION = 0.05  # m, standard deviation above which a marker is uncertain
UNCERTAIN_ROTATION = 0.05  # rad, the same
DOUBTFUL = 12.8  # chi-square quantile of 3 degrees of freedom, exceeded by one correct entry in 200
SWAPPED = 0.25  # maximum distance from the other's known position, as a fraction of the offset

Seen = List[List[List[Key]]]  # markers by instant, view and detection


@dataclass(frozen=True)
class MarkerQuality:
    """A marker of the map."""

    key: Key  # family and id
    known: bool  # it was in the known map
    is_anchor: bool  # it defines the map frame: a known marker that was used and is not wrong
    observations: int  # in the whole recording
    used_rms: np.ndarray  # (U,) RMS residual of each used observation, pixels
    left_out_rms: np.ndarray  # (L,) RMS residual of each observation that does not fit, pixels
    position_sigma: float  # standard deviation along the worst axis, metres
    rotation_sigma: float  # standard deviation about the worst axis, radians
    neighbours: Tuple[Key, ...]  # markers seen in one image with it
    images: Optional[int]  # in the minimum cut to the anchors; None: it is an anchor

    @property
    def rms(self) -> float:
        """RMS residual of the used observations, pixels; NaN without any."""
        return float(np.sqrt(np.mean(np.square(self.used_rms)))) if self.used_rms.size else float("nan")

    @property
    def worst(self) -> float:
        """Largest residual of a used observation, pixels; NaN without any."""
        return float(self.used_rms.max()) if self.used_rms.size else float("nan")

    @property
    def does_not_fit(self) -> bool:
        """Whether too many observations were left out, or all."""
        used, left_out = self.used_rms.size, self.left_out_rms.size
        often = left_out >= MISFIT_OBSERVATIONS and left_out > MISFIT_SHARE * (used + left_out)
        return often or (self.observations > 0 and used == 0)

    @property
    def is_uncertain(self) -> bool:
        """Whether the standard deviation of position or rotation is large."""
        return self.position_sigma > UNCERTAIN_POSITION or self.rotation_sigma > UNCERTAIN_ROTATION


@dataclass(frozen=True)
class WrongEntry:
    """A known marker whose entry contradicts all other observations."""

    key: Key  # family and id
    known_position: np.ndarray  # (3,) of the entry, in the map, metres
    offset: np.ndarray  # (3,) from there to the observed position, in the axes of the map, metres
    rotation: float  # between known and observed orientation, radians


@dataclass(frozen=True)
class ConflictingMarker:
    """A marker that some images show at another position than its own in the map."""

    key: Key  # family and id
    place: np.ndarray  # (3,) position in the map, metres
    position: np.ndarray  # (3,) conflicting position, metres
    images: int  # number of images that show it there
    witnesses: Tuple[Key, ...]  # markers that localized those images


@dataclass(frozen=True)
class Unconnected:
    """Markers that are connected to each other, but not to the map."""

    keys: FrozenSet[Key]  # families and ids
    images: int  # number of images that also show a marker of the map, but could not be used


@dataclass(frozen=True)
class MapQuality:
    """Quality of a map and its markers."""

    markers: List[MarkerQuality]  # in the order of the map
    links: Dict[Pair, int]  # number of used images that show both markers
    weak: List[Cut]  # weak connections, the weakest first
    wrong: List[WrongEntry]  # entries that were rejected, the worst first
    doubtful: List[WrongEntry]  # entries that may be wrong but were used, the worst first
    swapped: List[Pair]  # wrong or moved markers, each at the known position of the other
    conflicting: List[ConflictingMarker]  # the clearest first
    inconsistent: List[Key]  # not in the map: moved during the recording, or printed twice
    ambiguous: List[Key]  # not in the map: two poses explain their observations, or none enough of them
    unconnected: List[Unconnected]  # not in the map
    odometry: bool  # the recording has odometry, which connects images as well

    def name(self, key: Key) -> str:
        """Returns the id if all markers are of one family, else FAMILY/ID."""
        families = {family for family, _ in (*self.unmapped, *(each.key for each in self.markers))}
        return str(key[1]) if families <= {key[0]} else f"{key[0]}/{key[1]}"

    @property
    def unmapped(self) -> List[Key]:
        """Markers that were seen, but are not in the map."""
        unconnected = (key for group in self.unconnected for key in group.keys)
        return sorted({*self.inconsistent, *self.ambiguous, *unconnected})


def map_quality(
    result: sextant.MappingResult, instants: Sequence[sextant.RecordedInstant], known: sextant.MarkerMap
) -> MapQuality:
    """Evaluates a map.

    :param result: of sextant.make_marker_map()
    :param instants: the recording
    :param known: the known map that was given to make_marker_map(); may be empty
    """
    seen: Seen = [
        [[(each.family, each.id) for each in view.detections] for view in instant.views]
        for instant in instants
    ]
    images = _used_images(result, seen)
    anchors = _anchors(result, known)
    found = cuts(images, anchors)
    wrong = _entries([each for each in result.known if each.wrong], known)
    doubtful = [each for each in result.known if not each.wrong and each.squared_distance > DOUBTFUL]
    conflicting = _conflicting(result)
    return MapQuality(
        markers=_markers(result, seen, known, anchors, found, images),
        links=count_links(images),
        weak=weak_cuts(images, list(found.values())),
        wrong=wrong,
        doubtful=_entries(doubtful, known),
        swapped=swapped_pairs(_known_and_seen(wrong, conflicting, known)),
        conflicting=conflicting,
        inconsistent=sorted(result.inconsistent),
        ambiguous=sorted(result.ambiguous),
        unconnected=_unconnected(result, seen),
        odometry=any(instant.T_odom_base is not None for instant in instants),
    )


def _key_of(residual, seen: Seen) -> Key:
    return seen[residual.instant][residual.view][residual.detection]


def _used_images(result, seen: Seen) -> List[Image]:
    """Returns the used markers by instant: the mounts connect the cameras of an instant."""
    markers = defaultdict(set)
    for each in result.residuals:
        if each.used:
            markers[each.instant].add(_key_of(each, seen))
    return [markers[instant] for instant in sorted(markers)]


def _anchors(result, known) -> Collection[Key]:
    wrong = {(each.family, each.id) for each in result.known if each.wrong}
    given = {(each.family, each.id) for each in known.markers} - wrong
    if given:
        return given
    # Without a known map, the map maker chose one and fixed it, or on a floor all but height and tilt.
    exact = {(each.family, each.id) for each in result.map.markers if not np.any(each.covariance)}
    return exact or {(each.family, each.id) for each in result.known}


def _markers(result, seen: Seen, known, anchors, found: Dict[Key, Cut], images) -> List[MarkerQuality]:
    observations = Counter(key for instant in seen for view in instant for key in view)
    used, left_out, neighbours = defaultdict(list), defaultdict(list), defaultdict(set)
    for each in result.residuals:
        (used if each.used else left_out)[_key_of(each, seen)].append(each.rms)
    for a, b in count_links(images):
        neighbours[a].add(b)
        neighbours[b].add(a)
    qualities = []
    for marker in result.map.markers:
        key = (marker.family, marker.id)
        qualities.append(
            MarkerQuality(
                key=key,
                known=known.find(*key) is not None,
                is_anchor=key in anchors and bool(used[key]),
                observations=observations[key],
                used_rms=np.array(used[key]),
                left_out_rms=np.array(left_out[key]),
                position_sigma=_worst_sigma(marker.covariance[:3, :3]),
                rotation_sigma=_worst_sigma(marker.covariance[3:, 3:]),
                neighbours=tuple(sorted(neighbours[key])),
                images=_images_to(key, anchors, found),
            )
        )
    return qualities


def _images_to(key: Key, anchors: Collection[Key], found: Dict[Key, Cut]) -> Optional[int]:
    """Returns the number of images in the cut to the anchors; None for an anchor."""
    if key in anchors:
        return None
    return found[key].images if key in found else 0


def _worst_sigma(covariance: np.ndarray) -> float:
    """Returns the standard deviation along the major axis of the covariance ellipsoid."""
    return float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0)))


def _entries(checks: Sequence, known) -> List[WrongEntry]:
    return [
        WrongEntry(
            (each.family, each.id),
            known.find(each.family, each.id).T_map_marker[:3, 3],
            each.offset[:3],
            float(np.linalg.norm(each.offset[3:])),
        )
        for each in sorted(checks, key=lambda each: -each.squared_distance)
        if known.find(each.family, each.id)
    ]


def _conflicting(result) -> List[ConflictingMarker]:
    return [
        ConflictingMarker(
            (each.family, each.id),
            result.map.find(each.family, each.id).T_map_marker[:3, 3],
            each.T_map_marker[:3, 3],
            each.images,
            tuple(sorted(each.witnesses)),
        )
        for each in result.conflicting_poses
    ]


def _known_and_seen(wrong, conflicting, known) -> Dict[Key, Tuple[np.ndarray, np.ndarray]]:
    """Returns known and observed position (3,) of every known marker at another position."""
    places = {}
    for each in conflicting:
        entry = known.find(*each.key)
        if entry is not None:
            places[each.key] = (entry.T_map_marker[:3, 3], each.position)
    places.update({each.key: (each.known_position, each.known_position + each.offset) for each in wrong})
    return places


def swapped_pairs(places: Dict[Key, Tuple[np.ndarray, np.ndarray]]) -> List[Pair]:
    """Finds pairs of markers, each at the known position of the other.

    :param places: known (3,) and observed (3,) position of displaced markers, metres
    """

    def is_at(a: Key, b: Key) -> bool:
        known, observed = places[a]
        return np.linalg.norm(observed - places[b][0]) <= SWAPPED * np.linalg.norm(observed - known)

    keys = sorted(places)
    return [(a, b) for i, a in enumerate(keys) for b in keys[i + 1 :] if is_at(a, b) and is_at(b, a)]


def _unconnected(result, seen: Seen) -> List[Unconnected]:
    keys = {tuple(key) for key in result.unconnected}
    mapped = {(each.family, each.id) for each in result.map.markers}
    shown = [{key for view in instant for key in view} for instant in seen]
    groups = components([image & keys for image in shown])
    return [Unconnected(group, _images_of_both(shown, group, mapped)) for group in groups]


def _images_of_both(images: Sequence[Image], group: Image, mapped: Image) -> int:
    return sum(1 for image in images if image & group and image & mapped)
