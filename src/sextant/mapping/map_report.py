# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Report on a marker map that was made of a drive: one HTML file that needs nothing else."""

import base64
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, Mapping, Sequence, Tuple, Union

import numpy as np
from jinja2 import Environment, StrictUndefined

from sextant.base.atomic_file import atomic_file
from sextant.mapping.map_findings import count, findings, list_findings, verdict
from sextant.mapping.map_links import Key
from sextant.mapping.map_plots import plan_view, residual_boxes
from sextant.mapping.map_quality import MapQuality, MarkerQuality
from sextant.mapping.map_report_template import TEMPLATE

__all__ = ["MapOrigin", "findings", "write_map_report"]

LINKS = 30  # rows; the weakest ones
NOTABLE_SCALE = 1.5  # of the known markers' deviations, from which it is told
HEADS = (
    "marker",
    "to note",
    "sightings",
    "used",
    "left out",
    "RMS, px",
    "worst, px",
    "position, mm",
    "rotation, deg",
    "seen with",
    "images to the frame",
)


@dataclass(frozen=True)
class MapOrigin:
    """What a map was made of."""

    bags: Sequence[str]
    cameras: Sequence[str]  # in the order of MadeMap.noise_scales
    corner_sigma: float  # pixels, of the parameters
    options: Mapping[str, object] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)  # of programs
    title: str = "Marker map"


@dataclass(frozen=True)
class _Row:
    cells: Tuple[str, ...]
    look: bool = False


@dataclass(frozen=True)
class _Table:
    heads: Tuple[str, ...]
    rows: List[_Row]
    text: Tuple[int, ...] = (0,)  # columns that are no numbers


def write_map_report(path: Union[str, Path], made, quality: MapQuality, origin: MapOrigin) -> None:
    """Writes the report; an old one is replaced when the new one is whole.

    :param made: sextant.MadeMap with one marker or more; quality: map_quality() of it
    :raises OSError: the file cannot be written
    :raises ValueError: the map has no marker
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    page = environment.from_string(TEMPLATE).render(_content(made, quality, origin))
    with atomic_file(path, "wb") as file:
        # Names of files need not be UTF-8: Python reads their other bytes as surrogates.
        file.write(page.encode("utf-8", "backslashreplace"))


def _content(made, quality: MapQuality, origin: MapOrigin) -> Dict[str, object]:
    return {
        "title": origin.title,
        "verdict": verdict(quality),
        "findings": list_findings(quality),
        "plan": base64.b64encode(plan_view(made, quality)).decode(),
        "markers": _marker_table(quality),
        "wrong": _wrong_table(quality),
        "links": _link_table(quality),
        "links_note": _links_note(quality),
        "residuals": base64.b64encode(residual_boxes(quality)).decode(),
        "cameras": _camera_table(made, origin),
        "notes": _noise_notes(made),
        "origin": _origin_table(origin),
    }


def _marker_table(quality: MapQuality) -> _Table:
    words: Dict[Key, List[str]] = {}
    for finding in list_findings(quality):
        for key in finding.keys:
            words.setdefault(key, []).append(finding.word)
    mapped = [marker.key for marker in quality.markers]
    rows = [_marker_row(quality, marker, words.get(marker.key, [])) for marker in quality.markers]
    for key in sorted(set(words) - set(mapped)):
        cells = (quality.name(key), "; ".join(["not in the map", *words[key]]), *[""] * (len(HEADS) - 2))
        rows.append(_Row(cells, look=True))
    return _Table(HEADS, rows, text=(0, 1))


def _marker_row(quality: MapQuality, marker: MarkerQuality, words: Sequence[str]) -> _Row:
    role = "holds the frame" if marker.holds else "known before" if marker.known else ""
    cells = (
        quality.name(marker.key),
        "; ".join(filter(None, [*words, role])),
        str(marker.sightings),
        str(marker.used_rms.size),
        str(marker.left_out_rms.size),
        _number(marker.rms, 2),
        _number(marker.worst, 2),
        _number(1000 * marker.position_sigma, 1),
        _number(np.degrees(marker.rotation_sigma), 2),
        count(len(marker.neighbours), "other"),
        "" if marker.images is None else str(marker.images),
    )
    return _Row(cells, look=bool(words))


def _number(value: float, digits: int) -> str:
    return "" if np.isnan(value) else f"{value:.{digits}f}"


def _wrong_table(quality: MapQuality) -> _Table:
    swapped = {a: b for pair in quality.swapped for a, b in (pair, pair[::-1])}
    rows = [
        _Row(
            (
                quality.name(each.key),
                *(f"{100 * value:+.1f}" for value in each.offset),
                f"{100 * np.linalg.norm(each.offset):.1f}",
                f"{np.degrees(each.rotation):.1f}",
                f"swapped with {quality.name(swapped[each.key])}" if each.key in swapped else "",
            )
        )
        for each in quality.wrong
    ]
    return _Table(
        ("marker", "x, cm", "y, cm", "z, cm", "in all, cm", "rotation, deg", "to note"), rows, (0, 6)
    )


def _link_table(quality: MapQuality) -> _Table:
    weak = {frozenset(pair) for cut in quality.weak for pair in cut.links}
    # The weak first, then those with the fewest images.
    order = sorted(quality.links.items(), key=lambda link: (frozenset(link[0]) not in weak, link[1], link[0]))
    rows = [
        _Row(
            (" and ".join(map(quality.name, pair)), str(images), "weak" if frozenset(pair) in weak else ""),
            look=frozenset(pair) in weak,
        )
        for pair, images in order[:LINKS]
    ]
    return _Table(("markers", "images with both", "to note"), rows, (0, 2))


def _links_note(quality: MapQuality) -> str:
    shown = f"; shown are the {LINKS} weakest" if len(quality.links) > LINKS else ""
    return (
        f"Pairs of markers that were seen in one image the map was made of: {len(quality.links)}{shown}. "
        "A weak link is what alone connects some markers with the rest."
    )


def _camera_table(made, origin: MapOrigin) -> _Table:
    names = [*origin.cameras, *(f"camera {i}" for i in range(len(origin.cameras), len(made.noise_scales)))]
    rows = [
        _Row((name, f"{scale * origin.corner_sigma:.2f}", f"{scale:.2f}"))
        for name, scale in zip(names, made.noise_scales)
    ]
    return _Table(("camera", "noise of a corner, px", f"times the {origin.corner_sigma:g} px told"), rows)


def _noise_notes(made) -> List[str]:
    notes = [
        f"{made.correlated_images:.1f} images in a row say as much as one, since their errors are alike."
    ]
    scales = (("positions", made.known_position_scale), ("rotations", made.known_rotation_scale))
    notes += [
        f"The {what} of the known markers scatter {scale:.1f} times as far as their deviations say; "
        "they were believed accordingly less."
        for what, scale in scales
        if scale >= NOTABLE_SCALE
    ]
    return notes


def _origin_table(origin: MapOrigin) -> _Table:
    rows = [_Row(("recording", str(bag))) for bag in origin.bags]
    rows += [_Row((str(name), str(value))) for name, value in origin.options.items()]
    rows += [_Row((f"version of {name}", str(version))) for name, version in origin.versions.items()]
    return _Table(("what", "value"), rows, (0, 1))
