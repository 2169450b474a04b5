# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bundles of apriltag_ros (AprilRobotics, ROS 1): the tag_bundles of its tags.yaml.

Read as TagDetector::parseTagBundles of apriltag_ros/src/common_functions.cpp does:

    standalone_tags: [{id, size, name}, ...]
    tag_bundles: [{name, layout: [{id, size, x, y, z, qw, qx, qy, qz}, ...]}, ...]

metres; x, y, z default to 0 and the quaternion, which need not be of unit length, to no rotation; a bundle
without a name is bundle_ and its number. A pose takes the tag's frame to the bundle's, and the bundle's
frame becomes that of the map.

Tag frame: addObjectPoints puts the corners at (-s, -s), (s, -s), (s, s), (-s, s), bottom left and
counter-clockwise: "x is right, y is up and z is towards you (out of the tag)", as ours. (libapriltag's own
frame has y down and z into the tag; apriltag_ros does not use it.) size is the edge between the corners, as
ours.
"""

import json
from typing import Dict, List, Optional, Set

import numpy as np

import sextant
from sextant.geometry.poses import quaternion_of
from sextant.markers.formats.located_yaml import Table, read_yaml
from sextant.markers.formats.losses import (
    lost_covariances,
    lost_frames,
    lost_names,
    only_family,
    require_markers,
)
from sextant.markers.formats.map_file import (
    MapFileError,
    MapFormatParams,
    ReadMap,
    WrittenMap,
    decimal,
    told_as,
)

# tag_family of settings.yaml, the first is its default
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
    """One bundle; params.bundle names it where there are several, params.family the family.

    :raises MapFileError: no bundle, several of them and none named, or what apriltag_ros would not read,
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
        with told_as(tag.mistake):
            marker_map.add(_marker(tag, family, standalone))
    placed = {marker.id for marker in marker_map.markers}
    return ReadMap(marker_map, _unplaced(set(standalone) - placed))


def _standalone_sizes(root: Table) -> Dict[int, float]:
    """Edge length in metres by id."""
    sizes: Dict[int, float] = {}
    for tag in root.tables("standalone_tags"):
        tag.require("a standalone tag", ["id", "size"], ["name"])
        if tag.whole("id") in sizes:
            raise tag.mistake(f"standalone tag {tag['id']} is there twice")
        sizes[tag["id"]] = tag.number("size")
    return sizes


def _bundles(root: Table) -> Dict[str, Table]:
    bundles: Dict[str, Table] = {}
    for number, bundle in enumerate(root.tables("tag_bundles")):
        bundle.require("a bundle", ["layout"], ["name"])
        name = bundle.word("name") if "name" in bundle else f"bundle_{number}"
        if name in bundles:
            raise bundle.mistake(f"bundle '{name}' is there twice")
        bundles[name] = bundle
    return bundles


def _chosen(root: Table, bundles: Dict[str, Table], wanted: Optional[str]) -> Table:
    names = ", ".join(bundles)
    if not bundles:
        raise root.mistake("has no tag_bundles: standalone tags have no place, so there is no map in them")
    if wanted is None and len(bundles) > 1:
        raise root.mistake(f"has several bundles, name the one that is the map (--bundle): {names}")
    if wanted is not None and wanted not in bundles:
        raise root.mistake(f"has no bundle '{wanted}', only {names}")
    return bundles[wanted] if wanted is not None else next(iter(bundles.values()))


def _marker(tag: Table, family: str, standalone: Dict[int, float]) -> sextant.MappedMarker:
    """:raises ValueError: a quaternion of length zero, or another size than as a standalone tag"""
    tag.require("a tag of a bundle", ["id", "size"], POSE_NAMES)
    id, size = tag.whole("id"), tag.number("size")
    if standalone.get(id, size) != size:
        raise ValueError(f"tag {id} has {size:g} m here and {standalone[id]:g} m as a standalone tag")
    x, y, z, qw, qx, qy, qz = (tag.number(name, float(name == "qw")) for name in POSE_NAMES)
    T_bundle_tag = sextant.pose_from_quaternion([x, y, z], [qx, qy, qz, qw], tolerance=np.inf)
    return sextant.MappedMarker(family, id, size, T_bundle_tag)


def _unplaced(ids: Set[int]) -> List[str]:
    told = ", ".join(map(str, sorted(ids)))
    return [f"the standalone tags {told}: they have no place in the bundle"] if ids else []


def format_apriltag_ros(marker_map: sextant.MarkerMap) -> WrittenMap:
    """A tags.yaml with one bundle, which is called as the map's frame.

    :raises MapFileError: no markers, several families, a family that apriltag_ros does not know
    """
    require_markers(marker_map)
    family = only_family(marker_map, FAMILIES, "apriltag_ros")
    layout = ",\n".join(_format_tag(marker) for marker in marker_map.markers)
    text = (
        "standalone_tags: []\ntag_bundles:\n"
        f"  - name: {json.dumps(marker_map.frame)}\n    layout: [\n{layout}\n    ]\n"
    )
    warnings = [f"the family: set tag_family: {family} in settings.yaml"]
    warnings += lost_covariances(marker_map) + lost_names(marker_map) + lost_frames(marker_map)
    return WrittenMap(text, warnings)


def _format_tag(marker: sextant.MappedMarker) -> str:
    x, y, z, w = quaternion_of(marker.T_map_marker[:3, :3])
    numbers = np.array([*marker.T_map_marker[:3, 3], w, x, y, z])
    told = ", ".join(f"{name}: {decimal(value)}" for name, value in zip(POSE_NAMES, numbers))
    return f"      {{id: {marker.id}, size: {decimal(marker.size)}, {told}}}"
