# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bundles of apriltag_ros (AprilRobotics, ROS 1): the tag_bundles of its tags.yaml.

Read as in TagDetector::parseTagBundles of apriltag_ros/src/common_functions.cpp:

    standalone_tags: [{id, size, name}, ...]
    tag_bundles: [{name, layout: [{id, size, x, y, z, qw, qx, qy, qz}, ...]}, ...]

Metres. x, y, z default to 0, the quaternion to the identity; it need not be normalized. A bundle without a
name is called ``bundle_`` and its number. A pose is T_bundle_tag; the bundle's frame becomes the map frame.

Tag frame: addObjectPoints puts the corners at (-s, -s), (s, -s), (s, s), (-s, s), counter-clockwise from the
bottom left: "x is right, y is up and z is towards you (out of the tag)", as in Sextant. (libapriltag's own
frame has y down and z into the tag; apriltag_ros does not use it.) size is the edge length between the
corners, as in Sextant.
"""

import json
from typing import Dict, List, Optional, Set

import numpy as np

import sextant
from sextant.geometry.poses import quaternion_of
from sextant.markers.formats.format_types import (
    MapFileError,
    MapFormatParams,
    ReadMap,
    WrittenMap,
    decimal,
    errors_located_at,
)
from sextant.markers.formats.losses import lost_covariances, lost_frames, lost_names, only_family
from sextant.markers.formats.yaml_table import Table, read_yaml

# values of tag_family in settings.yaml; the first is the default
FAMILIES = (
    "tag36h11",
    "tag16h5",
    "tag25h9",
    "tagCircle21h7",
    "tagCircle49h12",
    "tagCustom48h12",
    "tagStandard41h12",
    "tagStandard52h13",
)
POSE_NAMES = ("x", "y", "z", "qw", "qx", "qy", "qz")


def read_apriltag_ros(path: str, params: MapFormatParams) -> ReadMap:
    """Reads one bundle of a tags.yaml.

    :param params: bundle is required if the file has several, family defaults to tag36h11
    :raises MapFileError: no bundle, several and none chosen, or content that apriltag_ros refuses,
        "file:line: reason"
    """
    family = params.known_family(FAMILIES[0])
    if family not in FAMILIES:
        raise MapFileError(f"{path}: apriltag_ros does not know {family}, only {', '.join(FAMILIES)}")
    root = read_yaml(path)
    root.require("a tags.yaml", [], ["standalone_tags", "tag_bundles"])
    standalone = _standalone_sizes(root)
    bundle = _chosen(root, _bundles(root), params.bundle)
    marker_map = params.empty_map()
    for tag in bundle.tables("layout"):
        with errors_located_at(tag.place):
            marker_map.add(_marker(tag, family, standalone))
    placed = {marker.id for marker in marker_map.markers}
    return ReadMap(marker_map, _unplaced(set(standalone) - placed))


def _standalone_sizes(root: Table) -> Dict[int, float]:
    """Returns the edge length in metres by id."""
    sizes: Dict[int, float] = {}
    for tag in root.tables("standalone_tags"):
        tag.require("a standalone tag", ["id", "size"], ["name"])
        if tag.whole("id") in sizes:
            raise tag.mistake(f"standalone tag {tag['id']} is defined twice")
        sizes[tag["id"]] = tag.number("size")
    return sizes


def _bundles(root: Table) -> Dict[str, Table]:
    bundles: Dict[str, Table] = {}
    for number, bundle in enumerate(root.tables("tag_bundles")):
        bundle.require("a bundle", ["layout"], ["name"])
        name = bundle.word("name") if "name" in bundle else f"bundle_{number}"
        if name in bundles:
            raise bundle.mistake(f"bundle '{name}' is defined twice")
        bundles[name] = bundle
    return bundles


def _chosen(root: Table, bundles: Dict[str, Table], wanted: Optional[str]) -> Table:
    names = ", ".join(bundles)
    if not bundles:
        raise root.mistake("has no tag_bundles: standalone tags have no pose, so they make no map")
    if wanted is None and len(bundles) > 1:
        raise root.mistake(f"has several bundles, choose one (--bundle): {names}")
    if wanted is not None and wanted not in bundles:
        raise root.mistake(f"has no bundle '{wanted}', only {names}")
    return bundles[wanted] if wanted is not None else next(iter(bundles.values()))


def _marker(tag: Table, family: str, standalone: Dict[int, float]) -> sextant.MappedMarker:
    """:raises ValueError: a zero quaternion, or a size other than that of the standalone tag"""
    tag.require("a tag of a bundle", ["id", "size"], POSE_NAMES)
    id, size = tag.whole("id"), tag.number("size")
    if standalone.get(id, size) != size:
        raise ValueError(f"tag {id} has {size:g} m here and {standalone[id]:g} m as a standalone tag")
    x, y, z, qw, qx, qy, qz = (tag.number(name, float(name == "qw")) for name in POSE_NAMES)
    T_bundle_tag = sextant.pose_from_quaternion([x, y, z], [qx, qy, qz, qw], tolerance=np.inf)
    return sextant.MappedMarker(family, id, size, T_bundle_tag)


def _unplaced(ids: Set[int]) -> List[str]:
    listed = ", ".join(map(str, sorted(ids)))
    return [f"the standalone tags {listed}: they have no pose in the bundle"] if ids else []


def format_apriltag_ros(marker_map: sextant.MarkerMap) -> WrittenMap:
    """Formats a map as a tags.yaml with one bundle, named after the map frame.

    :raises MapFileError: several families, or a family that apriltag_ros does not support
    """
    family = only_family(marker_map, FAMILIES, "apriltag_ros")
    layout = ",\n".join(_format_tag(marker) for marker in marker_map.markers)
    text = (
        "standalone_tags: []\ntag_bundles:\n"
        f"  - name: {json.dumps(marker_map.frame)}\n    layout: [\n{layout}\n    ]\n"
    )
    warnings = [f"the family: set tag_family: {family} in settings.yaml"]
    warnings += lost_covariances(marker_map) + lost_names(marker_map) + lost_frames(marker_map)
    return text, warnings


def _format_tag(marker: sextant.MappedMarker) -> str:
    x, y, z, w = quaternion_of(marker.T_map_marker[:3, :3])
    numbers = np.array([*marker.T_map_marker[:3, 3], w, x, y, z])
    pose = ", ".join(f"{name}: {decimal(value)}" for name, value in zip(POSE_NAMES, numbers))
    return f"      {{id: {marker.id}, size: {decimal(marker.size)}, {pose}}}"
