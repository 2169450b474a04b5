# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Findings about a new marker map and what to do about them, as sentences."""

from typing import Callable, Collection, Dict, Iterator, List, Sequence

import numpy as np

from sextant.base.findings import Finding, count_text, listed_names, verdict_text
from sextant.mapping.map_links import Cut, Key, Pair
from sextant.mapping.map_quality import MapQuality, WrongEntry


def findings(quality: MapQuality) -> List[str]:
    """Returns one line per finding, the most severe kind first; the report has the same sentences."""
    return [str(each) for each in list_findings(quality)]


def list_findings(quality: MapQuality) -> List[Finding]:
    """Returns the findings, the most severe kind first."""
    return [finding for kind in _KINDS for finding in kind(quality)]


def verdict(quality: MapQuality) -> str:
    """Summarizes the map in one line."""
    unmapped = len(quality.unmapped)
    named = {key for finding in list_findings(quality) for key in finding.keys}
    seen = f", {unmapped} seen but not mapped" if unmapped else ""
    return verdict_text(f"{count_text(len(quality.markers), 'marker')} mapped{seen}", len(named), "marker")


def _swapped(quality: MapQuality) -> Iterator[Finding]:
    for pair in quality.swapped:
        yield Finding(
            pair,
            "swapped",
            f"{names(quality, pair)} are swapped, each is at the known position of the other",
            "swap them back, or check both entries of the new map",
        )


def _wrong(quality: MapQuality) -> Iterator[Finding]:
    swapped = {key for pair in quality.swapped for key in pair}
    advice = "the new map has the pose from the images; measure it again if in doubt"
    for entry in quality.wrong:
        if entry.key not in swapped:
            fact = f"{quality.name(entry.key)} had a wrong entry, off by {_offset(entry)}"
            yield Finding((entry.key,), "its entry was wrong", fact, advice)


def _doubtful(quality: MapQuality) -> Iterator[Finding]:
    for entry in quality.doubtful:
        yield Finding(
            (entry.key,),
            "its entry may be wrong",
            f"{quality.name(entry.key)} may have a wrong entry, off by {_offset(entry)} in all other images",
            "measure it again; the new map has a pose between both",
        )


def _offset(entry: WrongEntry) -> str:
    along = ", ".join(f"{100 * value:+.1f}" for value in entry.offset)
    distance = 100 * np.linalg.norm(entry.offset)
    return f"{distance:.1f} cm ({along} along x, y, z) and {np.degrees(entry.rotation):.1f} degrees"


def _contradicting(quality: MapQuality) -> Iterator[Finding]:
    """Finds pairs that contradict only each other: the recording does not show which one was moved."""
    for pair, images in _contradictions(quality).items():
        yield Finding(
            pair,
            "contradicted",
            f"{names(quality, pair)} cannot both be where the map has them "
            f"({count_text(images, 'image')} with both contradict it)",
            "check which of them was moved or has a second print, and correct its entry",
        )


def _contradictions(quality: MapQuality) -> Dict[Pair, int]:
    """Returns the number of contradicting images by pair, without swapped pairs."""
    alone = {each.key: each for each in quality.conflicting if len(each.witnesses) == 1}
    return {
        (key, each.witnesses[0]): each.images
        for key, each in sorted(alone.items())
        if key < each.witnesses[0] in alone
        and alone[each.witnesses[0]].witnesses == (key,)
        and (key, each.witnesses[0]) not in quality.swapped
    }


def _conflicting(quality: MapQuality) -> Iterator[Finding]:
    paired = {key for pair in (*quality.swapped, *_contradictions(quality)) for key in pair}
    for each in quality.conflicting:
        if each.key not in paired:
            at = ", ".join(f"{value:.2f}" for value in each.position)
            away = np.linalg.norm(each.position - each.place)
            shown = f"{count_text(each.images, 'image')} with {names(quality, each.witnesses)}"
            yield Finding(
                (each.key,),
                "seen elsewhere",
                f"{quality.name(each.key)} is seen elsewhere ({shown} show it {away:.2f} m from its position,"
                f" at {at} m along x, y, z)",
                "it was moved, or there are two prints of it; check where it is, and correct its entry",
            )


def _inconsistent(quality: MapQuality) -> Iterator[Finding]:
    why = "moved during the recording, or printed twice"
    advice = "remove the second print if there is one, and record its surroundings again"
    return _left_out(quality, quality.inconsistent, "moved, or printed twice", why, advice)


def _ambiguous(quality: MapQuality) -> Iterator[Finding]:
    why = "two poses explain its observations, or none explains enough of them"
    advice = "drive past it closer and from both sides, with other markers in the same images"
    return _left_out(quality, quality.ambiguous, "ambiguous", why, advice)


def _left_out(
    quality: MapQuality, keys: Sequence[Key], title: str, why: str, advice: str
) -> Iterator[Finding]:
    for key in keys:
        yield Finding((key,), title, f"{quality.name(key)} is not in the map ({why})", advice)


def _weak(quality: MapQuality) -> Iterator[Finding]:
    for cut in quality.weak:
        several = len(cut.markers) > 1
        who = f"{names(quality, cut.markers)} {'are' if several else 'is'} connected to the rest"
        if cut.images:
            fact, advice = f"{who} only by {_cut_images(quality, cut)}", _past_both_sides(quality, cut)
        else:
            fact = f"{who} by no image, only by {'odometry' if quality.odometry else 'the floor'}"
            advice = f"drive so that images show {'them' if several else 'it'} together with other markers"
        yield Finding(
            tuple(sorted(cut.markers)), f"weak link: {count_text(cut.images, 'image')}", fact, advice
        )


def _cut_images(quality: MapQuality, cut: Cut) -> str:
    """Describes the images of a cut, e.g. 3 images of 7 with 12."""
    here, there = (names(quality, {pair[side] for pair in cut.links}) for side in (0, 1))
    shown = f"with {there}" if len(cut.markers) == 1 else f"of {there} with {here}"
    return f"{count_text(cut.images, 'image')} {shown}{' and by odometry' if quality.odometry else ''}"


def _past_both_sides(quality: MapQuality, cut: Cut) -> str:
    both = names(quality, {key for pair in cut.links for key in pair})
    return f"drive slowly past {both} again, so that images show both sides together"


def _unconnected(quality: MapQuality) -> Iterator[Finding]:
    for group in quality.unconnected:
        several = len(group.keys) > 1
        who = f"{names(quality, group.keys)} {'are' if several else 'is'} not in the map"
        why = (
            f"only {count_text(group.images, 'image')} with markers of the map, and none could be used"
            if group.images
            else "never seen together with its markers"
        )
        one = "one of them" if several else "it"
        advice = f"drive so that images show {one} together with mapped markers"
        yield Finding(tuple(sorted(group.keys)), "not connected", f"{who} ({why})", advice)


def _misfits(quality: MapQuality) -> Iterator[Finding]:
    misplaced = {each.key for each in (*quality.wrong, *quality.conflicting)}
    advice = "check whether it is where the map has it, and whether it is bent, loose or of another size"
    for marker in quality.markers:
        if marker.does_not_fit and marker.key not in misplaced:
            fact = f"{quality.name(marker.key)} does not fit its pose ({_share_left_out(marker)})"
            yield Finding((marker.key,), "does not fit", fact, advice)


def _share_left_out(marker) -> str:
    if not marker.used_rms.size:
        return f"none of its {count_text(marker.observations, 'observation')} could be used"
    compared = marker.used_rms.size + marker.left_out_rms.size
    return f"{marker.left_out_rms.size} of its {count_text(compared, 'observation')} were left out"


def _uncertain(quality: MapQuality) -> Iterator[Finding]:
    found = [marker for marker in quality.markers if marker.is_uncertain and marker.observations]
    if found:
        keys = tuple(marker.key for marker in found)
        position = 100 * max(marker.position_sigma for marker in found)
        rotation = np.degrees(max(marker.rotation_sigma for marker in found))
        who = f"{names(quality, keys)} {'are' if len(keys) > 1 else 'is'} uncertain"
        spread = f"{'up to ' if len(keys) > 1 else ''}{position:.1f} cm and {rotation:.1f} degrees"
        advice = "drive past slower and closer, with other markers in the same images"
        yield Finding(keys, "uncertain", f"{who} ({spread}, standard deviation)", advice)


def _unseen(quality: MapQuality) -> Iterator[Finding]:
    keys = tuple(marker.key for marker in quality.markers if marker.observations == 0)
    if keys:
        several = len(keys) > 1
        who = f"{names(quality, keys)} {'were' if several else 'was'} never seen"
        kept = "their entries are" if several else "its entry is"
        advice = f"drive past {'them' if several else 'it'}, or remove the entry if there is no marker"
        yield Finding(keys, "never seen", f"{who}, {kept} unchanged", advice)


_KINDS: Sequence[Callable[[MapQuality], Iterator[Finding]]] = (
    _swapped,
    _wrong,
    _doubtful,
    _inconsistent,
    _contradicting,
    _conflicting,
    _misfits,
    _unconnected,
    _ambiguous,
    _weak,
    _uncertain,
    _unseen,
)


def names(quality: MapQuality, keys: Collection[Key]) -> str:
    """Lists markers, e.g. 3, 4 and 7."""
    return listed_names([quality.name(key) for key in sorted(keys)])
