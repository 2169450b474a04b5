# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is to be said of a map that was made, and what to do about it, in sentences."""

from dataclasses import dataclass
from typing import Callable, Collection, Dict, List, Sequence, Tuple

import numpy as np

from sextant.mapping.map_links import Cut, Key, Pair
from sextant.mapping.map_quality import ElsewhereMarker, MapQuality, Unconnected, WrongEntry

NAMED = 8  # markers in a sentence; of more, the first ones


@dataclass(frozen=True)
class Finding:
    """Something that needs a look."""

    keys: Tuple[Key, ...]
    word: str  # what is the matter, for a table
    fact: str
    advice: str

    def __str__(self) -> str:
        return f"{self.fact}: {self.advice}"


def findings(quality: MapQuality) -> List[str]:
    """Lines for a terminal, one a finding, the gravest kind first; the report has the same sentences."""
    return [str(each) for each in list_findings(quality)]


def list_findings(quality: MapQuality) -> List[Finding]:
    """As findings(), with the markers that each is about."""
    return [finding for kind in _KINDS for finding in kind(quality)]


def verdict(quality: MapQuality) -> str:
    """The report in one line."""
    absent = len(quality.absent)
    named = {key for finding in list_findings(quality) for key in finding.keys}
    mapped = f"{len(quality.markers)} {_plural('marker', len(quality.markers))} mapped"
    seen = f", {absent} seen but not mapped" if absent else ""
    look = f"{len(named)} named below {'needs' if len(named) == 1 else 'need'} a look" if named else ""
    return f"{mapped}{seen}; {look or 'nothing stands out'}"


def _swapped(quality: MapQuality) -> List[Finding]:
    return [
        Finding(
            pair,
            "swapped",
            f"{names(quality, pair)} are swapped, each hangs where the other was known",
            "hang them back, or check both entries of the new map",
        )
        for pair in quality.swapped
    ]


def _wrong(quality: MapQuality) -> List[Finding]:
    told = {key for pair in quality.swapped for key in pair}
    return [_wrong_entry(quality, entry) for entry in quality.wrong if entry.key not in told]


def _wrong_entry(quality: MapQuality, entry: WrongEntry) -> Finding:
    return Finding(
        (entry.key,),
        "its entry was wrong",
        f"{quality.name(entry.key)} had a wrong entry, it hangs {_way(entry)} from where it was known",
        "the new map has the place that the images tell; measure again what you doubt",
    )


def _doubtful(quality: MapQuality) -> List[Finding]:
    return [
        Finding(
            (entry.key,),
            "its entry may be wrong",
            f"{quality.name(entry.key)} may have a wrong entry, all else shows it {_way(entry)} from there",
            "measure it again; the new map has it between both places",
        )
        for entry in quality.doubtful
    ]


def _way(entry: WrongEntry) -> str:
    along = ", ".join(f"{100 * value:+.1f}" for value in entry.offset)
    distance = 100 * np.linalg.norm(entry.offset)
    return f"{distance:.1f} cm ({along} along x, y, z) and {np.degrees(entry.rotation):.1f} degrees"


def _contradicting(quality: MapQuality) -> List[Finding]:
    """Pairs of which each speaks against the other alone: who is right, the recording does not tell."""
    return [
        Finding(
            pair,
            "contradicted",
            f"{names(quality, pair)} cannot both hang where the map has them "
            f"({count(images, 'image')} with both say otherwise)",
            "look which of them was moved, or is there twice, and correct its entry",
        )
        for pair, images in _contradictions(quality).items()
    ]


def _contradictions(quality: MapQuality) -> Dict[Pair, int]:
    """How many images say so; swapped ones are told as such."""
    alone = {each.key: each for each in quality.elsewhere if len(each.witnesses) == 1}
    return {
        (key, each.witnesses[0]): each.images
        for key, each in sorted(alone.items())
        if key < each.witnesses[0] in alone
        and alone[each.witnesses[0]].witnesses == (key,)
        and (key, each.witnesses[0]) not in quality.swapped
    }


def _elsewhere(quality: MapQuality) -> List[Finding]:
    told = {key for pair in (*quality.swapped, *_contradictions(quality)) for key in pair}
    return [_elsewhere_marker(quality, each) for each in quality.elsewhere if each.key not in told]


def _elsewhere_marker(quality: MapQuality, each: ElsewhereMarker) -> Finding:
    at = ", ".join(f"{value:.2f}" for value in each.position)
    away = np.linalg.norm(each.position - each.place)
    shown = f"{count(each.images, 'image')} with {names(quality, each.witnesses)}"
    return Finding(
        (each.key,),
        "seen elsewhere",
        f"{quality.name(each.key)} is seen elsewhere ({shown} show it {away:.2f} m from its place, "
        f"at {at} m along x, y, z)",
        "it was moved, or there are two prints of it; look where it hangs, and correct its entry",
    )


def _twice(quality: MapQuality) -> List[Finding]:
    why = "moved during the recording, or there twice"
    advice = "take the second print away if there is one, and record again what is near it"
    return _left_out(quality, quality.twice, "moved, or there twice", why, advice)


def _ambiguous(quality: MapQuality) -> List[Finding]:
    why = "two places explain what was seen of it"
    advice = "drive past it nearer and from both sides, with other markers in the same images"
    return _left_out(quality, quality.ambiguous, "ambiguous", why, advice)


def _left_out(quality: MapQuality, keys: Sequence[Key], title: str, why: str, advice: str) -> List[Finding]:
    return [
        Finding((key,), title, f"{quality.name(key)} is not in the map ({why})", advice) for key in keys
    ]


def _weak(quality: MapQuality) -> List[Finding]:
    return [_weak_cut(quality, cut) for cut in quality.weak]


def _weak_cut(quality: MapQuality, cut: Cut) -> Finding:
    several = len(cut.markers) > 1
    who = f"{names(quality, cut.markers)} {'are' if several else 'is'} connected to the rest"
    if cut.images:
        fact, advice = f"{who} only by {_cut_images(quality, cut)}", _past_both_sides(quality, cut)
    else:
        fact = f"{who} by no image, only by {'odometry' if quality.odometry else 'the floor'}"
        advice = f"drive so that images show {'them' if several else 'it'} together with other markers"
    return Finding(tuple(sorted(cut.markers)), f"weak link: {count(cut.images, 'image')}", fact, advice)


def _cut_images(quality: MapQuality, cut: Cut) -> str:
    """E.g. 3 images of 7 with 12."""
    here, there = (names(quality, {pair[side] for pair in cut.links}) for side in (0, 1))
    shown = f"with {there}" if len(cut.markers) == 1 else f"of {there} with {here}"
    return f"{count(cut.images, 'image')} {shown}{' and by odometry' if quality.odometry else ''}"


def _past_both_sides(quality: MapQuality, cut: Cut) -> str:
    both = names(quality, {key for pair in cut.links for key in pair})
    return f"drive slowly past {both} again, so that images show both sides together"


def _unconnected(quality: MapQuality) -> List[Finding]:
    return [_unconnected_group(quality, group) for group in quality.unconnected]


def _unconnected_group(quality: MapQuality, group: Unconnected) -> Finding:
    several = len(group.keys) > 1
    who = f"{names(quality, group.keys)} {'are' if several else 'is'} not in the map"
    why = (
        f"only {count(group.images, 'image')} with markers of the map, and not one could be used"
        if group.images
        else "never seen together with its markers"
    )
    advice = f"drive so that images show {'one of them' if several else 'it'} together with mapped markers"
    return Finding(tuple(sorted(group.keys)), "not connected", f"{who} ({why})", advice)


def _misfits(quality: MapQuality) -> List[Finding]:
    told = {each.key for each in (*quality.wrong, *quality.elsewhere)}
    return [
        Finding(
            (marker.key,),
            "does not fit",
            f"{quality.name(marker.key)} does not fit its place ({_share_left_out(marker)})",
            "look whether it hangs where the map has it, and whether it is bent, loose or of another size",
        )
        for marker in quality.markers
        if marker.does_not_fit and marker.key not in told
    ]


def _share_left_out(marker) -> str:
    if not marker.used_rms.size:
        return f"not one of its {count(marker.sightings, 'sighting')} could be used"
    compared = marker.used_rms.size + marker.left_out_rms.size
    return f"{marker.left_out_rms.size} of its {count(compared, 'sighting')} were left out"


def _uncertain(quality: MapQuality) -> List[Finding]:
    found = [marker for marker in quality.markers if marker.is_uncertain and marker.sightings]
    if not found:
        return []
    keys = tuple(marker.key for marker in found)
    position = 100 * max(marker.position_sigma for marker in found)
    rotation = np.degrees(max(marker.rotation_sigma for marker in found))
    who = f"{names(quality, keys)} {'are' if len(keys) > 1 else 'is'} uncertain"
    spread = f"{'up to ' if len(keys) > 1 else ''}{position:.1f} cm and {rotation:.1f} degrees"
    return [
        Finding(
            keys,
            "uncertain",
            f"{who} ({spread}, standard deviation)",
            "drive past slower and nearer, with other markers in the same images",
        )
    ]


def _unseen(quality: MapQuality) -> List[Finding]:
    keys = tuple(marker.key for marker in quality.markers if marker.sightings == 0)
    if not keys:
        return []
    several = len(keys) > 1
    who = f"{names(quality, keys)} {'were' if several else 'was'} never seen"
    kept = "their entries are" if several else "its entry is"
    advice = f"drive past {'them' if several else 'it'}, or take the entry out if nothing hangs there"
    return [Finding(keys, "never seen", f"{who}, {kept} as before", advice)]


_KINDS: Sequence[Callable[[MapQuality], List[Finding]]] = (
    _swapped,
    _wrong,
    _doubtful,
    _twice,
    _contradicting,
    _elsewhere,
    _misfits,
    _unconnected,
    _ambiguous,
    _weak,
    _uncertain,
    _unseen,
)


def names(quality: MapQuality, keys: Collection[Key]) -> str:
    """E.g. 3, 4 and 7."""
    told = [quality.name(key) for key in sorted(keys)]
    if len(told) > NAMED:
        told = [*told[: NAMED - 1], f"{len(told) - NAMED + 1} more"]
    return " and ".join(filter(None, [", ".join(told[:-1]), told[-1]]))


def count(number: int, noun: str) -> str:
    """E.g. 1 image, 2 images."""
    return f"{number} {_plural(noun, number)}"


def _plural(noun: str, number: int) -> str:
    return noun if number == 1 else f"{noun}s"
