# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How good a map is that was made of a recorded drive: plain numbers, marker by marker."""

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import Collection, Dict, FrozenSet, List, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.mapping.map_links import Cut, Image, Key, Pair, components, count_links, cuts, weak_cuts

MISFIT_SHARE = 0.2  # of a marker's sightings left out, from which something is wrong with it
MISFIT_SIGHTINGS = 5
UNCERTAIN_POSITION = 0.05  # m, standard deviation from which a marker is named
UNCERTAIN_ROTATION = 0.05  # rad
DOUBTFUL = 12.8  # chi-square of 3 degrees of freedom that one right entry of 200 exceeds
SWAPPED = 0.25  # of the way between two places: so far at most each is from where the other was known

Seen = Sequence[Sequence[Sequence[Key]]]


@dataclass(frozen=True)
class MarkerQuality:
    """A marker of the map."""

    key: Key
    known: bool  # before the drive
    holds: bool  # the frame of the map; of known ones, those that were used and not found wrong
    sightings: int  # in the whole recording
    used_rms: np.ndarray  # (U,) of each sighting the map was made of, pixels
    left_out_rms: np.ndarray  # (L,) of each that does not fit, pixels; others could not be compared
    position_sigma: float  # along the worst axis, metres
    rotation_sigma: float  # about the worst axis, radians
    neighbours: Tuple[Key, ...]  # in one image with it
    images: Optional[int]  # the fewest that connect it with those that hold the frame; None: it is one

    @property
    def rms(self) -> float:
        """Pixels; not a number where no sighting was used."""
        return float(np.sqrt(np.mean(np.square(self.used_rms)))) if self.used_rms.size else float("nan")

    @property
    def worst(self) -> float:
        """Pixels, of those that were used; not a number where none was."""
        return float(self.used_rms.max()) if self.used_rms.size else float("nan")

    @property
    def does_not_fit(self) -> bool:
        used, left_out = self.used_rms.size, self.left_out_rms.size
        often = left_out >= MISFIT_SIGHTINGS and left_out > MISFIT_SHARE * (used + left_out)
        return often or (self.sightings > 0 and used == 0)

    @property
    def is_uncertain(self) -> bool:
        return self.position_sigma > UNCERTAIN_POSITION or self.rotation_sigma > UNCERTAIN_ROTATION


@dataclass(frozen=True)
class WrongEntry:
    """A known marker against what all else says of it."""

    key: Key
    known_position: np.ndarray  # (3,) metres, in the map
    offset: np.ndarray  # (3,) from there to where all else shows it, metres, in the map's axes
    rotation: float  # radians


@dataclass(frozen=True)
class ElsewhereMarker:
    """A marker that some images show at another place than its own in the map."""

    key: Key
    place: np.ndarray  # (3,) in the map, metres
    position: np.ndarray  # (3,) the other place, metres
    images: int  # that say so
    witnesses: Tuple[Key, ...]  # by which those images were located


@dataclass(frozen=True)
class Unconnected:
    """Markers that were seen together, but not with the map's."""

    keys: FrozenSet[Key]
    images: int  # that do show one of them together with one of the map, but could not be used


@dataclass(frozen=True)
class MapQuality:
    """Everything that a user should know of a map that was made."""

    markers: List[MarkerQuality]  # in the order of the map
    links: Dict[Pair, int]  # images that show both and that the map was made of
    weak: List[Cut]  # the weakest first
    wrong: List[WrongEntry]  # the worst first; what was known of them was not used
    doubtful: List[WrongEntry]  # the worst first; they may be wrong, but hold the frame
    swapped: List[Pair]  # of wrong or moved ones: each hangs where the other was known
    elsewhere: List[ElsewhereMarker]  # the most clearly so first
    twice: List[Key]  # not in the map: moved during the recording, or printed twice
    ambiguous: List[Key]  # not in the map: two places explain what was seen of them
    unconnected: List[Unconnected]  # not in the map
    odometry: bool  # it connects images, besides what they show

    def name(self, key: Key) -> str:
        """The id alone where all markers are of one family."""
        families = {family for family, _ in (*self.absent, *(each.key for each in self.markers))}
        return str(key[1]) if families <= {key[0]} else f"{key[0]}/{key[1]}"

    @property
    def absent(self) -> List[Key]:
        """Markers that were seen, but are not in the map."""
        unconnected = (key for group in self.unconnected for key in group.keys)
        return sorted({*self.twice, *self.ambiguous, *unconnected})


def map_quality(
    made: sextant.MadeMap,
    instants: Sequence[sextant.RecordedInstant],
    seen: Seen,
    known: Optional[sextant.MarkerMap] = None,
) -> MapQuality:
    """Judges a map.

    :param instants: that it was made of
    :param seen: of every instant, of every view: (family, id) of its detections, in their order
    :param known: the map that was handed to make_marker_map(); None or empty: there was none
    :raises ValueError: seen is not of these instants
    """
    _require_fit(made, instants, seen)
    known = sextant.MarkerMap() if known is None else known
    images = _used_images(made, seen)
    holders = _holders(made, known)
    found = cuts(images, holders)
    wrong = _entries([each for each in made.known if each.wrong], known)
    doubtful = [each for each in made.known if not each.wrong and each.squared_distance > DOUBTFUL]
    elsewhere = _elsewhere(made)
    return MapQuality(
        markers=_markers(made, seen, known, holders, found, images),
        links=count_links(images),
        weak=weak_cuts(images, list(found.values())),
        wrong=wrong,
        doubtful=_entries(doubtful, known),
        swapped=swapped_pairs(_known_and_seen(wrong, elsewhere, known)),
        elsewhere=elsewhere,
        twice=sorted(made.twice),
        ambiguous=sorted(made.ambiguous),
        unconnected=_unconnected(made, seen),
        odometry=any(instant.T_odom_base is not None for instant in instants),
    )


def _require_fit(made, instants: Sequence, seen: Seen) -> None:
    views = [len(instant.views) for instant in instants]
    if [len(each) for each in seen] != views:
        raise ValueError("seen must have a list for every view of every instant")
    for each in made.residuals:
        if each.instant >= len(seen) or each.detection >= len(seen[each.instant][each.view]):
            raise ValueError(f"seen has no detection {each.detection} in a view of instant {each.instant}")


def _key_of(residual, seen: Seen) -> Key:
    return tuple(seen[residual.instant][residual.view][residual.detection])


def _used_images(made, seen: Seen) -> List[Image]:
    """Of an instant: its cameras hold together by their mounts."""
    markers = defaultdict(set)
    for each in made.residuals:
        if each.used:
            markers[each.instant].add(_key_of(each, seen))
    return [markers[instant] for instant in sorted(markers)]


def _holders(made, known) -> Collection[Key]:
    wrong = {(each.family, each.id) for each in made.known if each.wrong}
    given = {(each.family, each.id) for each in known.markers} - wrong
    if given:
        return given
    # Nobody named one: the maker chose it, and holds it exactly, or but for height and tilt on a floor.
    exact = {(each.family, each.id) for each in made.map.markers if not np.any(each.covariance)}
    return exact or {(each.family, each.id) for each in made.known}


def _markers(made, seen: Seen, known, holders, found: Dict[Key, Cut], images) -> List[MarkerQuality]:
    sightings = Counter(tuple(key) for instant in seen for view in instant for key in view)
    used, left_out, neighbours = defaultdict(list), defaultdict(list), defaultdict(set)
    for each in made.residuals:
        (used if each.used else left_out)[_key_of(each, seen)].append(each.rms)
    for a, b in count_links(images):
        neighbours[a].add(b)
        neighbours[b].add(a)
    result = []
    for marker in made.map.markers:
        key = (marker.family, marker.id)
        result.append(
            MarkerQuality(
                key=key,
                known=known.find(*key) is not None,
                holds=key in holders and bool(used[key]),
                sightings=sightings[key],
                used_rms=np.array(used[key]),
                left_out_rms=np.array(left_out[key]),
                position_sigma=_worst_sigma(marker.covariance[:3, :3]),
                rotation_sigma=_worst_sigma(marker.covariance[3:, 3:]),
                neighbours=tuple(sorted(neighbours[key])),
                images=_images_to(key, holders, found),
            )
        )
    return result


def _images_to(key: Key, holders: Collection[Key], found: Dict[Key, Cut]) -> Optional[int]:
    """The fewest that connect it with the holders; None for one of those."""
    if key in holders:
        return None
    return found[key].images if key in found else 0


def _worst_sigma(covariance: np.ndarray) -> float:
    """Along the largest axis of the ellipsoid."""
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


def _elsewhere(made) -> List[ElsewhereMarker]:
    return [
        ElsewhereMarker(
            (each.family, each.id),
            made.map.find(each.family, each.id).T_map_marker[:3, 3],
            each.T_map_marker[:3, 3],
            each.images,
            tuple(sorted(each.witnesses)),
        )
        for each in made.second_places
    ]


def _known_and_seen(wrong, elsewhere, known) -> Dict[Key, Tuple[np.ndarray, np.ndarray]]:
    """Of every known marker that hangs elsewhere: where it was known, and where it hangs."""
    places = {}
    for each in elsewhere:
        entry = known.find(*each.key)
        if entry is not None:
            places[each.key] = (entry.T_map_marker[:3, 3], each.position)
    places.update({each.key: (each.known_position, each.known_position + each.offset) for each in wrong})
    return places


def swapped_pairs(places: Dict[Key, Tuple[np.ndarray, np.ndarray]]) -> List[Pair]:
    """Pairs of which each hangs where the other was known.

    :param places: of markers that hang elsewhere: (3,) where it was known, (3,) where it hangs; metres
    """

    def hangs_at(a: Key, b: Key) -> bool:
        known, hangs = places[a]
        return np.linalg.norm(hangs - places[b][0]) <= SWAPPED * np.linalg.norm(hangs - known)

    keys = sorted(places)
    return [(a, b) for i, a in enumerate(keys) for b in keys[i + 1 :] if hangs_at(a, b) and hangs_at(b, a)]


def _unconnected(made, seen: Seen) -> List[Unconnected]:
    keys = {tuple(key) for key in made.unconnected}
    mapped = {(each.family, each.id) for each in made.map.markers}
    shown = [{tuple(key) for view in instant for key in view} for instant in seen]
    groups = components([image & keys for image in shown])
    return [Unconnected(group, _images_of_both(shown, group, mapped)) for group in groups]


def _images_of_both(images: Sequence[Image], group: Image, mapped: Image) -> int:
    return sum(1 for image in images if image & group and image & mapped)
