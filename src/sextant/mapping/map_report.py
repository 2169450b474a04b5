# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Report on a new marker map: one self-contained HTML file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Mapping, Sequence, Union

import numpy as np

from sextant.base.findings import count_text
from sextant.base.html_report import Row, Table, embedded, write_report
from sextant.mapping.map_findings import list_findings, verdict
from sextant.mapping.map_links import Key
from sextant.mapping.map_plots import plan_view, residual_boxes
from sextant.mapping.map_quality import MapQuality, MarkerQuality
from sextant.mapping.map_report_template import TEMPLATE

MAX_LINKS = 30  # rows of the table of links; if there are more, the weakest are shown
# The report has a note if the known markers scatter by this many times their standard deviations or more.
NOTABLE_SCALE = 1.5
NOTABLE_LENS_ERROR = 2.0  # px, of a calibration; with few images, 0.5 are estimated where there is none
HEADS = (
    "marker",
    "remarks",
    "observations",
    "used",
    "left out",
    "RMS, px",
    "worst, px",
    "position, mm",
    "rotation, deg",
    "seen with",
    "images linking to the frame",  # without these images, nothing connects it to the map frame
)


@dataclass(frozen=True)
class MapOrigin:
    """Inputs from which a map was made."""

    bags: Sequence[str]  # paths
    cameras: Sequence[str]  # in the order of MappingResult.noise_scales
    corner_sigma: float  # of the parameters, pixels
    options: Mapping[str, object]  # of the command, by name


def write_map_report(path: Union[str, Path], result, quality: MapQuality, origin: MapOrigin) -> None:
    """Writes the report atomically.

    :param result: sextant.MappingResult with one marker or more
    :param quality: map_quality() of result
    :raises OSError: the file cannot be written
    :raises ValueError: the map has no marker
    """
    write_report(path, TEMPLATE, _content(result, quality, origin))


def _content(result, quality: MapQuality, origin: MapOrigin) -> Dict[str, object]:
    return {
        "title": "Marker map",
        "verdict": verdict(quality),
        "findings": list_findings(quality),
        "plan": embedded(plan_view(result, quality)),
        "markers": _marker_table(quality),
        "wrong": _wrong_entries_table(quality),
        "links": _link_table(quality),
        "links_note": _links_note(quality),
        "residuals": embedded(residual_boxes(quality)),
        "cameras": _camera_table(result, origin),
        "notes": _noise_notes(result),
        "origin": _origin_table(origin),
    }


def _marker_table(quality: MapQuality) -> Table:
    remarks: Dict[Key, List[str]] = {}
    for finding in list_findings(quality):
        for key in finding.keys:
            remarks.setdefault(key, []).append(finding.word)
    mapped = [marker.key for marker in quality.markers]
    rows = [_marker_row(quality, marker, remarks.get(marker.key, [])) for marker in quality.markers]
    for key in sorted(set(remarks) - set(mapped)):
        cells = (quality.name(key), "; ".join(["not in the map", *remarks[key]]), *[""] * (len(HEADS) - 2))
        rows.append(Row(cells, highlighted=True))
    return Table(HEADS, rows, text_columns=(0, 1))


def _marker_row(quality: MapQuality, marker: MarkerQuality, remarks: Sequence[str]) -> Row:
    role = "defines the frame" if marker.is_anchor else "from --known" if marker.known else ""
    cells = (
        quality.name(marker.key),
        "; ".join(filter(None, [*remarks, role])),
        str(marker.observations),
        str(marker.used_rms.size),
        str(marker.left_out_rms.size),
        _number(marker.rms, 2),
        _number(marker.worst, 2),
        _number(1000 * marker.position_sigma, 1),
        _number(np.degrees(marker.rotation_sigma), 2),
        count_text(len(marker.neighbours), "other"),
        "" if marker.images is None else str(marker.images),
    )
    return Row(cells, highlighted=bool(remarks))


def _number(value: float, digits: int) -> str:
    return "" if np.isnan(value) else f"{value:.{digits}f}"


def _wrong_entries_table(quality: MapQuality) -> Table:
    """Known markers that are not at their known poses."""
    swapped = {a: b for pair in quality.swapped for a, b in (pair, pair[::-1])}
    rows = [
        Row(
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
    return Table(("marker", "x, cm", "y, cm", "z, cm", "total, cm", "rotation, deg", "remarks"), rows, (0, 6))


def _link_table(quality: MapQuality) -> Table:
    weak = {frozenset(pair) for cut in quality.weak for pair in cut.links}
    # Weak links first, then those with the fewest images.
    order = sorted(quality.links.items(), key=lambda link: (frozenset(link[0]) not in weak, link[1], link[0]))
    rows = [
        Row(
            (" and ".join(map(quality.name, pair)), str(images), "weak" if frozenset(pair) in weak else ""),
            highlighted=frozenset(pair) in weak,
        )
        for pair, images in order[:MAX_LINKS]
    ]
    return Table(("markers", "images with both", "remarks"), rows, (0, 2))


def _links_note(quality: MapQuality) -> str:
    shown = f"; the {MAX_LINKS} weakest are shown" if len(quality.links) > MAX_LINKS else ""
    weak = " Some markers are connected to the rest only by a weak link." if quality.weak else ""
    pairs = f"Pairs of markers that were seen together in at least one used image: {len(quality.links)}"
    return f"{pairs}{shown}.{weak}"


def _camera_table(result, origin: MapOrigin) -> Table:
    names = [*origin.cameras, *(f"camera {i}" for i in range(len(origin.cameras), len(result.noise_scales)))]
    rows = [
        Row((name, f"{scale * origin.corner_sigma:.2f}", f"{scale:.2f}", f"{lens:.2f}"))
        for name, scale, lens in zip(names, result.noise_scales, result.lens_errors)
    ]
    ratio = f"ratio to the assumed {origin.corner_sigma:g} px"
    return Table(("camera", "corner noise, px", ratio, "error of the calibration, px"), rows)


def _noise_notes(result) -> List[str]:
    notes = [
        f"{result.correlated_images:.1f} consecutive images count as one, since their errors are correlated."
    ]
    if max(result.lens_errors, default=0.0) >= NOTABLE_LENS_ERROR:
        notes.append(
            "The calibration of a camera does not fit its images. The map takes this into account; a locator "
            "does not: calibrate the camera again."
        )
    scales = (("positions", result.known_position_scale), ("rotations", result.known_rotation_scale))
    notes += [
        f"The {what} of the markers from --known scatter {scale:.1f} times their standard deviations; "
        "their weights were reduced accordingly."
        for what, scale in scales
        if scale >= NOTABLE_SCALE
    ]
    return notes


def _origin_table(origin: MapOrigin) -> Table:
    rows = [Row(("recording", str(bag))) for bag in origin.bags]
    rows += [Row((str(name), str(value))) for name, value in origin.options.items()]
    return Table(("what", "value"), rows, (0, 1))
