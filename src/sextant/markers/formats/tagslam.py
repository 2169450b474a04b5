# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tags of tagslam (berndpfrommer/tagslam): tagslam.yaml, which it reads, and poses.yaml, which it writes.

    bodies:
      - NAME:
          is_static: true
          type: simple
          default_tag_size: 0.2
          pose: {position: {x, y, z}, rotation: {x, y, z}, and how well it is known: tagslam_noise.py}
          tags: [{id, size, bits, pose: as above}, ...]

(Body::parseCommon of src/body.cpp, Tag::parseTags of src/tag.cpp, the parsers of src/xml.cpp; for
poses.yaml TagSlam::writePoses of src/tag_slam.cpp and write_pose of src/yaml_utils.cpp.) Metres; rotation
is axis times angle in radians (make_transform of src/geometry.cpp); a pose of a tag takes the tag's frame
to the body's, that of a body the body's to the map's (fixed_frame_id).

Tag frame: the corners are (-s/2, -s/2), (s/2, -s/2), (s/2, s/2), (-s/2, s/2) (src/tag.cpp) and the first is
the bottom left one (content/measurements of tagslam_web): x right, y up, z out of the print, as ours.

Only bodies that stand still and list their tags are maps; a board lists none, and source and documentation
do not agree where its tags are.
"""

from typing import Dict, Iterable, List, Optional, Set

import numpy as np

import sextant
from sextant.markers.formats.located_yaml import Table, read_yaml
from sextant.markers.formats.map_file import MapFileError, MapFormatParams, ReadMap, told_as
from sextant.markers.formats.tagslam_noise import NAMES as NOISE_NAMES
from sextant.markers.formats.tagslam_noise import in_map_axes, read_noise, read_vector

MEASUREMENTS = ("distance_measurements", "coordinate_measurements", "plane_measurements")
FILE_NAMES = (
    *("tagslam_parameters", "body_defaults", "default_body", "tag_id_remap", "squash", "amnesia"),
    *("warn_ignore_tags", "warn_unknown_tags", "max_hamming_distance"),
    *MEASUREMENTS,
)
OVERRIDES = ("override_tag_position_noise", "override_tag_rotation_noise")
BODY_NAMES = (
    *("type", "default_tag_size", "pose", "tags", "board", "staggered_board", "ignore_tags"),
    *("max_hamming_distance", "publish_covariance", "T_body_odom"),
    *OVERRIDES,
)
FAMILY_OF_BITS = {4: "tag16h5", 5: "tag25h9", 6: "tag36h11"}
DEFAULT_FAMILY = "tag36h11"
FOUND_LATER = "tagslam finds it while it runs, convert the poses.yaml that it writes"
# PoseNoise() of include/tagslam/pose_noise.h: what poses.yaml (ROS 1) says of a tag that tagslam found itself
PLACEHOLDER = np.eye(6)


def read_tagslam(path: str, params: MapFormatParams) -> ReadMap:
    """The tags of all bodies that stand still, or of the one that params.bundle names.

    :raises MapFileError: a body with tags that moves, a tag without a pose, anything that tagslam would not
        read: "file:line: reason"
    """
    family = params.known_family(DEFAULT_FAMILY)
    if not family.startswith("tag"):
        raise MapFileError(f"{path}: tagslam has AprilTags only, {family} is none")
    root = read_yaml(path)
    root.require("a tagslam.yaml", ["bodies"], FILE_NAMES)
    reader = _Reader(params, family, _is_output(root))
    bodies = _bodies(root, params.bundle)
    for name, body in bodies.items():
        reader.read_body(name, body)
    return ReadMap(reader.marker_map, [*reader.warnings(), *_ignored(root, reader.marker_map)])


def _bodies(root: Table, wanted: Optional[str]) -> Dict[str, Table]:
    """The bodies to read: with tags or boards, unless one of all was named."""
    bodies = _all_bodies(root)
    if wanted is None:
        return {name: body for name, body in bodies.items() if body.get("tags") or body["type"] != "simple"}
    if wanted not in bodies:
        raise root.mistake(f"has no body '{wanted}', only {', '.join(bodies)}", "bodies")
    return {wanted: bodies[wanted]}


def _all_bodies(root: Table) -> Dict[str, Table]:
    bodies: Dict[str, Table] = {}
    for entry in root.tables("bodies"):
        for name in entry:
            if str(name) in bodies:
                raise entry.mistake("is there twice", name)
            bodies[str(name)] = entry.table(name)
            _require_body(name, entry[name])
    return bodies


def _require_body(name: str, body: Table) -> None:
    odometry = [each for each in body if str(each).startswith(("odom_", "fake_odom_"))]
    body.require(f"body '{name}'", ["is_static", "type"], [*BODY_NAMES, *odometry])


class _Reader:
    """Puts the tags of one body after another into a map."""

    def __init__(self, params: MapFormatParams, family: str, output: bool):
        self.marker_map = params.empty_map()
        self._family, self._output = family, output
        self._bodies: List[str] = []
        self._unknown: List[int] = []  # ids whose deviations are the placeholder

    def read_body(self, name: str, body: Table) -> None:
        if body.word("type") != "simple":
            raise body.mistake(
                f"body '{name}' is a {body['type']}, which does not list its tags: name the body that is"
                " wanted (--bundle), or list the tags in a body of type simple"
            )
        if not body.flag("is_static"):
            raise body.mistake(
                f"body '{name}' moves (is_static: false), its tags have no place in a map: name the body that"
                " is wanted (--bundle)"
            )
        if "pose" not in body:
            raise body.mistake(f"body '{name}' has no pose: {FOUND_LATER}")
        T_map_body = _pose(body.table("pose"))
        read_noise(body["pose"])  # nobody asks for it, but it must be one
        self._bodies.append(name)
        for tag in body.tables("tags"):
            with told_as(tag.mistake):
                self.marker_map.add(self._marker(tag, body, T_map_body))

    def _marker(self, tag: Table, body: Table, T_map_body: np.ndarray) -> sextant.MappedMarker:
        tag.require("a tag", ["id"], ["size", "bits", "pose"])
        id = tag.whole("id")
        self._require_family(tag)
        if "pose" not in tag:
            raise tag.mistake(f"tag {id} has no pose: {FOUND_LATER}")
        T_map_tag = T_map_body @ _pose(tag.table("pose"))
        covariance = in_map_axes(self._noise(id, tag["pose"], body), T_map_tag[:3, :3])
        size = tag.number("size") if "size" in tag else _default_size(body)
        return sextant.MappedMarker(self._family, id, size, T_map_tag, covariance=covariance)

    def _require_family(self, tag: Table) -> None:
        if "bits" in tag and FAMILY_OF_BITS.get(tag.whole("bits")) != self._family:
            family = FAMILY_OF_BITS.get(tag["bits"], "no family of tagslam")
            raise tag.mistake(f"{tag['bits']} is {family}, the map is of {self._family} (--family)", "bits")

    def _noise(self, id: int, pose: Table, body: Table) -> np.ndarray:
        """(6, 6) covariance of a tag in its own axes."""
        noise = read_noise(pose)
        overrides = [body.number(name, -1.0) for name in OVERRIDES]
        if min(overrides) > 0:  # Body::overrides
            return np.diag(np.repeat(overrides, 3) ** 2)
        if not self._output or not np.array_equal(noise, PLACEHOLDER):
            return noise
        self._unknown.append(id)
        return np.zeros((6, 6))

    def warnings(self) -> List[str]:
        warnings = []
        if self._unknown:
            warnings.append(
                f"how well the tags {_list(self._unknown)} are known: tagslam writes 1 m and 1 rad for what"
                " it found itself; they are taken for exact, give them sigma_position and sigma_rotation"
            )
        if len(self._bodies) > 1:
            warnings.append(
                f"how well the bodies {', '.join(self._bodies)} are known: their tags share that error, and"
                " a map has none that is shared"
            )
        return warnings


def _pose(table: Table) -> np.ndarray:
    """(4, 4), the frame that the table belongs to in its parent."""
    table.require("a pose", ["position", "rotation"], NOISE_NAMES)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = sextant.exp_so3(read_vector(table, "rotation")), read_vector(table, "position")
    return T


def _default_size(body: Table) -> float:
    """:raises ValueError: the body has none"""
    if "default_tag_size" not in body:
        raise ValueError("the tag lacks 'size', and its body 'default_tag_size'")
    return body.number("default_tag_size")


def _ignored(root: Table, marker_map: sextant.MarkerMap) -> List[str]:
    """What the file says besides the bodies."""
    warnings = []
    measured = [name for name in MEASUREMENTS if name in root]
    if measured:
        warnings.append(f"{', '.join(measured)}: only tagslam applies them, its poses.yaml has the result")
    invented = _remapped(root) & {marker.id for marker in marker_map.markers}
    if invented:
        warnings.append(
            f"tag_id_remap: the prints of {_list(invented)} show another id, these markers will never be seen"
        )
    if _is_output(root) and any(np.any(marker.covariance) for marker in marker_map.markers):
        warnings.append(
            "how well the tags were optimized: tagslam of ROS 1 writes the deviations of tagslam.yaml into"
            " poses.yaml"
        )
    return warnings


def _remapped(root: Table) -> Set[int]:
    """Ids that no print has: tagslam gives them to prints of another id."""
    remaps = [remap for entry in root.tables("tag_id_remap") for remap in entry.tables("remaps")]
    return {remap.whole("remap_id") for remap in remaps if "remap_id" in remap}


def _is_output(root: Table) -> bool:
    """poses.yaml: tagslam itself would not start with it, as it lacks the tables beside the bodies."""
    return list(root) == ["bodies"]


def _list(ids: Iterable[int]) -> str:
    return ", ".join(map(str, sorted(ids)))
