# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A folder with the maps of all systems in one frame, as localization.launch uses it (maps:=FOLDER).

maps.launch names the maps that exist; it is written last, so that it never names a missing file.
"""

import argparse
import os
from collections import Counter
from pathlib import Path
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence
from xml.sax.saxutils import quoteattr

import yaml

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.base.html_report import Table, write_report
from sextant.base.params_file import read_params_file
from sextant.commands.command_line import check_output

MARKERS, LANDMARKS, PLACES = "markers.yaml", "landmarks.yaml", "places/map.txt"
MARKER_PAGE, LANDMARK_PAGE = "markers.html", "landmarks.html"
LAUNCH, PAGE, PARAMS = "maps.launch", "index.html", "landmark_slam.yaml"
FILES = (MARKERS, LANDMARKS, PLACES, MARKER_PAGE, LANDMARK_PAGE, LAUNCH, PAGE, PARAMS)

_LAUNCH = """\
<launch>
  <!-- The maps of this folder: roslaunch sextant localization.launch maps:=FOLDER
       Remove the line of a map to localize without it. -->
  <arg name="folder" value="$(dirname)"/>
  <include file="$(find sextant)/launch/localization.launch" pass_all_args="true">
    <arg name="maps" value=""/>
{lines}
  </include>
</launch>
"""
_PAGE = """\
{% extends "report" %}
{% from "macros" import table %}
{% block content %}
<h1>{{ title }}</h1>
<p class="verdict">{{ verdict }}</p>
{%- for part in parts %}
<h2>{{ part.name }}</h2>
<p>{{ part.verdict }}{% if part.page %}: <a href="{{ part.page }}">report</a>{% endif %}</p>
{%- if part.findings %}
<ol class="findings">
{%- for finding in part.findings %}
<li>{{ finding }}</li>
{%- endfor %}
</ol>
{%- endif %}
{%- endfor %}
{%- if details %}
<h2>{{ details.title }}</h2>
<p class="note">{{ details.note }}</p>
{{ table(details.table) }}
{%- endif %}
{% endblock %}
"""


class MapPart(NamedTuple):
    """What the page has of one map."""

    name: str  # of the system
    verdict: str  # one line, or why there is no map
    findings: Sequence[str] = ()  # one sentence each
    page: str = ""  # file of its report in the folder; empty: none
    file: str = ""  # of the map in the folder: MARKERS, LANDMARKS or PLACES; empty: there is no map

    def lines(self) -> List[str]:
        """For the terminal."""
        return [f"{self.name}: {self.verdict}", *(f"- {finding}" for finding in self.findings)]


class Details(NamedTuple):
    """A table below the maps of the page."""

    title: str  # above it
    note: str  # what its columns are
    table: Table  # its content


def add_folder_options(parser: argparse.ArgumentParser) -> None:
    """Adds `output` and `force`."""
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder to write")
    parser.add_argument("--force", action="store_true", help="overwrite existing files")


def check_folder(folder: Path, force: bool) -> None:
    """Checks a folder before anything is computed; it may not exist yet.

    :param force: overwrite the files of earlier maps
    :raises ValueError: a file exists and force is False, or the folder cannot be created or written to
    """
    for path in (folder / name for name in FILES):
        if path.parent.is_dir():
            check_output(path, force)
    above = folder.absolute()
    first = next(each for each in (above, *above.parents) if each.exists())
    if not (first.is_dir() and os.access(first, os.W_OK)):
        raise ValueError(f"{folder}: cannot be written, as {first} is no folder, or write-protected")


def begin_folder(folder: Path) -> None:
    """Creates the folder; removes the launch file of earlier maps, which are in another frame.

    :raises OSError: that is not possible
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / LAUNCH).unlink(missing_ok=True)


def write_folder(
    folder: Path,
    title: str,
    parts: Sequence[MapPart],
    arguments: Mapping[str, str],
    details: Optional[Details] = None,
) -> List[str]:
    """Writes the page and the launch file of maps that were written; removes other maps.

    :param title: of the page
    :param arguments: of localization.launch, besides the maps
    :returns: lines for the terminal
    :raises OSError: a file cannot be written
    """
    files = [part.file for part in parts if part.file]
    content: Dict[str, object] = {
        "title": title,
        "verdict": f"{len(files)} of {len(parts)} systems have a map",
        "parts": parts,
        "details": details,
    }
    write_report(folder / PAGE, _PAGE, content)
    arguments = {**{_ARGUMENTS[name]: f"$(arg folder)/{name}" for name in files}, **arguments}
    lines = "\n".join(f'    <arg name="{key}" value={quoteattr(arguments[key])}/>' for key in arguments)
    written = {PAGE, *files, *(part.page for part in parts), *([PARAMS] if _PARAMS in arguments else [])}
    for name in set(FILES) - written:
        (folder / name).unlink(missing_ok=True)
    with atomic_file(folder / LAUNCH) as file:
        file.write(_LAUNCH.format(lines=lines))
    how = f"roslaunch sextant localization.launch maps:={folder}"
    return [f"{folder / PAGE}: findings of all maps", f"{folder / LAUNCH}: {how}"]


_OF_LAUNCH = (
    *("map_file", "marker_map_file", "map_frame", "start"),
    *("cameras", "places", "read_only", "tf_output"),
)
_PARAMS = "landmark_params"  # argument of localization.launch
_ARGUMENTS = {MARKERS: "marker_map", LANDMARKS: "landmark_map", PLACES: "place_map"}


def params_arguments(folder: Path, path: Optional[str]) -> Dict[str, str]:
    """Writes parameters of landmark_slam, without those that localization.launch sets.

    :param path: of a file of parameters; None: there is none
    :returns: the argument of localization.launch that sets the new file
    :raises OSError, ValueError: it cannot be read or written
    """
    if not path:
        return {}
    values = {name: value for name, value in read_params_file(path).items() if name not in _OF_LAUNCH}
    with atomic_file(folder / PARAMS) as file:
        yaml.safe_dump(values, file, sort_keys=False)
    return {_PARAMS: f"$(arg folder)/{PARAMS}"}


def detector_arguments(
    marker_map: "sextant.MarkerMap", sizes: Optional["sextant.MarkerSizes"] = None
) -> Dict[str, str]:
    """Families and sizes of the markers, as arguments of localization.launch.

    :param sizes: of markers that are not in the map; None: there are none
    """
    markers = marker_map.markers
    size = sizes.size if sizes else Counter(marker.size for marker in markers).most_common(1)[0][0]
    others = dict(sizes.sizes) if sizes else {}
    others.update({f"{each.family}/{each.id}": each.size for each in markers if each.size != size})
    families = ", ".join(sorted({marker.family for marker in markers}))
    arguments = {"families": f"[{families}]", "marker_size": str(size)}
    listed = ", ".join(f"'{name}': {value}" for name, value in others.items())
    return {**arguments, "marker_sizes": f"{{{listed}}}"} if others else arguments
