# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tags of tagslam (berndpfrommer/tagslam): tagslam.yaml, which it reads, and poses.yaml, which it writes.

    bodies:
      - NAME:
          is_static: true
          type: simple
          default_tag_size: 0.2
          pose: {position: {x, y, z}, rotation: {x, y, z}, and the noise: tagslam_noise.py}
          tags: [{id, size, bits, pose: as above}, ...]

(Body::parseCommon of src/body.cpp, Tag::parseTags of src/tag.cpp, the parsers of src/xml.cpp; for
poses.yaml TagSlam::writePoses of src/tag_slam.cpp and write_pose of src/yaml_utils.cpp.) Metres; rotation
is axis times angle in radians (make_transform of src/geometry.cpp). The pose of a tag is T_body_tag, the
pose of a body T_map_body; the map is tagslam's fixed_frame_id.

Tag frame: the corners are (-s/2, -s/2), (s/2, -s/2), (s/2, s/2), (-s/2, s/2) (src/tag.cpp) and the first is
the bottom left one (content/measurements of tagslam_web): x right, y up, z out of the print, as in Sextant.

Only static bodies that list their tags can be read. A board lists none, and tagslam's source and
documentation disagree about the poses of its tags.
"""

from typing import Dict, Iterable, List, Optional, Set

import numpy as np

import sextant
from sextant.markers.formats.format_types import MapFileError, MapFormatParams, ReadMap, errors_located_at
from sextant.markers.formats.tagslam_noise import NAMES as NOISE_NAMES
from sextant.markers.formats.tagslam_noise import in_map_axes, read_noise, read_vector
from sextant.markers.formats.yaml_table import Table, read_yaml

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
FOUND_LATER = "tagslam estimates it at run time, convert the poses.yaml that it writes"
# PoseNoise() of include/tagslam/pose_noise.h: noise in poses.yaml (ROS 1) of a tag that tagslam discovered
PLACEHOLDER = np.eye(6)


def read_tagslam(path: str, params: MapFormatParams) -> ReadMap:
    """Reads the tags of all static bodies, or of the body params.bundle.

    :raises MapFileError: a moving body with tags, a tag without a pose, or content that tagslam refuses:
        "file:line: reason"
    """
    family = params.known_family(DEFAULT_FAMILY)
    if not family.startswith("tag"):
        raise MapFileError(f"{path}: tagslam has AprilTags only, not {family}")
    root = read_yaml(path)
    root.require("a tagslam.yaml", ["bodies"], FILE_NAMES)
    reader = _Reader(params, family, _is_output(root))
    bodies = _bodies(root, params.bundle)
    for name, body in bodies.items():
        reader.read_body(name, body)
    return ReadMap(reader.marker_map, [*reader.warnings(), *_ignored(root, reader.marker_map)])


def _bodies(root: Table, wanted: Optional[str]) -> Dict[str, Table]:
    """Returns the bodies to read: the chosen one, or all with tags or boards."""
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
                raise entry.mistake("is defined twice", name)
            bodies[str(name)] = entry.table(name)
            _require_body(name, entry[name])
    return bodies


def _require_body(name: str, body: Table) -> None:
    odometry = [each for each in body if str(each).startswith(("odom_", "fake_odom_"))]
    body.require(f"body '{name}'", ["is_static", "type"], [*BODY_NAMES, *odometry])


class _Reader:
    """Collects the tags of bodies in a map."""

    def __init__(self, params: MapFormatParams, family: str, output: bool):
        self.marker_map = params.empty_map()
        self._family, self._output = family, output
        self._bodies: List[str] = []
        self._unknown: List[int] = []  # ids whose noise is the placeholder

    def read_body(self, name: str, body: Table) -> None:
        """Adds the tags of a body."""
        if body.word("type") != "simple":
            raise body.mistake(
                f"body '{name}' is a {body['type']}, which does not list its tags: choose another body"
                " (--bundle), or list the tags in a body of type simple"
            )
        if not body.flag("is_static"):
            raise body.mistake(
                f"body '{name}' moves (is_static: false), its tags have no pose in a map: choose another body"
                " (--bundle)"
            )
        if "pose" not in body:
            raise body.mistake(f"body '{name}' has no pose: {FOUND_LATER}")
        T_map_body = _pose(body.table("pose"))
        read_noise(body["pose"])  # validated only
        self._bodies.append(name)
        for tag in body.tables("tags"):
            with errors_located_at(tag.place):
                self.marker_map.add(self._marker(tag, body, T_map_body))

    def _marker(self, tag: Table, body: Table, T_map_body: np.ndarray) -> sextant.MappedMarker:
        tag.require("a tag", ["id"], ["size", "bits", "pose"])
        id = tag.whole("id")
        self._require_family(tag)
        if "pose" not in tag:
            raise tag.mistake(f"tag {id} has no pose: {FOUND_LATER}")
        T_map_tag = T_map_body @ _pose(tag.table("pose"))
        covariance = in_map_axes(self._noise(id, tag["pose"], body), T_map_tag[:3, :3])
        owner, name = (tag, "size") if "size" in tag else (body, "default_tag_size")
        if name not in owner:
            raise ValueError("the tag lacks 'size', and its body 'default_tag_size'")
        return sextant.MappedMarker(self._family, id, owner.number(name), T_map_tag, covariance=covariance)

    def _require_family(self, tag: Table) -> None:
        if "bits" in tag and FAMILY_OF_BITS.get(tag.whole("bits")) != self._family:
            family = FAMILY_OF_BITS.get(tag["bits"], "no family of tagslam")
            raise tag.mistake(f"{tag['bits']} is {family}, the map is of {self._family} (--family)", "bits")

    def _noise(self, id: int, pose: Table, body: Table) -> np.ndarray:
        """Returns the (6, 6) covariance of a tag in its own axes."""
        noise = read_noise(pose)
        overrides = [body.number(name, -1.0) for name in OVERRIDES]
        if min(overrides) > 0:  # Body::overrides
            return np.diag(np.repeat(overrides, 3) ** 2)
        if not self._output or not np.array_equal(noise, PLACEHOLDER):
            return noise
        self._unknown.append(id)
        return np.zeros((6, 6))

    def warnings(self) -> List[str]:
        """Returns warnings of uncertainty that the map cannot represent."""
        warnings = []
        if self._unknown:
            warnings.append(
                f"the uncertainty of the tags {_list(self._unknown)}: tagslam writes 1 m and 1 rad for tags"
                " that it discovered; they are read as exact, set their sigma_position and sigma_rotation"
            )
        if len(self._bodies) > 1:
            warnings.append(
                f"the uncertainty of the bodies {', '.join(self._bodies)}: their tags share this error, and a"
                " map has no shared errors"
            )
        return warnings


def _pose(table: Table) -> np.ndarray:
    """Parses a pose (4, 4) in the parent frame."""
    table.require("a pose", ["position", "rotation"], NOISE_NAMES)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = sextant.exp_so3(read_vector(table, "rotation")), read_vector(table, "position")
    return T


def _ignored(root: Table, marker_map: sextant.MarkerMap) -> List[str]:
    """Warns of content besides the bodies."""
    warnings = []
    measured = [name for name in MEASUREMENTS if name in root]
    if measured:
        warnings.append(f"{', '.join(measured)}: only tagslam applies them, its poses.yaml has the result")
    invented = _remapped(root) & {marker.id for marker in marker_map.markers}
    if invented:
        warnings.append(
            f"tag_id_remap: the prints of {_list(invented)} show another id, they will never be detected"
        )
    if _is_output(root) and any(np.any(marker.covariance) for marker in marker_map.markers):
        warnings.append(
            "the uncertainty after optimization: tagslam of ROS 1 writes the noise of tagslam.yaml into"
            " poses.yaml"
        )
    return warnings


def _remapped(root: Table) -> Set[int]:
    """Returns ids that tagslam assigns to prints of another id."""
    remaps = [remap for entry in root.tables("tag_id_remap") for remap in entry.tables("remaps")]
    return {remap.whole("remap_id") for remap in remaps if "remap_id" in remap}


def _is_output(root: Table) -> bool:
    """Returns whether the file is a poses.yaml: it has only bodies, with which tagslam would not start."""
    return list(root) == ["bodies"]


def _list(ids: Iterable[int]) -> str:
    return ", ".join(map(str, sorted(ids)))
