# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re

import numpy as np
import pytest
from foreign_maps import TAGS, example_map, read_file, refused, variances

from sextant.markers.formats.format_types import MapFileError, MapFormatParams, decimal
from sextant.markers.map_formats import read_map, write_map

NOISE = "position_noise: {x: 0.01, y: 0.01, z: 0.01}, rotation_noise: {x: 0.001, y: 0.001, z: 0.001}"
NOWHERE = "position: {x: 0, y: 0, z: 0}, rotation: {x: 0, y: 0, z: 0}"


def tagslam_text(
    tag=NOISE, place=NOWHERE, body="", top="", tags=None, pose=f"pose: {{{NOWHERE}, {NOISE}}}", **kind
):
    """A file with one body, its tags in line 8."""
    tags = f"{{id: 1, size: 0.2, pose: {{{place}, {tag}}}}}" if tags is None else tags
    return (
        f"bodies:\n- room: {{type: {kind.get('type', 'simple')},\n"
        f"    is_static: {kind.get('is_static', 'true')},\n    {body + ',' if body else ''}\n"
        f"    {pose + ',' if pose else ''}\n\n    tags: [\n      {tags}\n    ]}}\n{top}\n"
    )


def tagslam_file(tmp_path, **parts):
    path = tmp_path / "poses.yaml"
    path.write_text(tagslam_text(**parts))
    return str(path)


def test_deviations_of_tagslam_are_along_the_axes_of_the_tag():
    """Tag 7: its x is the map's x, its y the map's z, its z the map's -y. Tag 8: x is -y, y is z, z is -x."""
    read = read_file("tagslam.yaml")
    assert variances(read, 7) == pytest.approx(np.square([0.01, 0.03, 0.02, 0.004, 0.006, 0.005]))
    # R: rotation 1/100 1/200 1/400 before position 1/10 1/20 1/40
    assert variances(read, 8) == pytest.approx(np.square([0.025, 0.1, 0.05, 0.0025, 0.01, 0.005]))
    assert variances(read, 9) == pytest.approx(np.zeros(6))


def test_square_root_of_tagslam_with_correlations(tmp_path):
    """Rotation about z and position along x err together: R^T R is the inverse of what is read."""
    covariance = np.diag([4.0, 1.0, 1.0, 1.0, 1.0, 9.0])  # x y z roll pitch yaw
    covariance[0, 5] = covariance[5, 0] = 3.0
    order = [3, 4, 5, 0, 1, 2]
    R = np.linalg.cholesky(np.linalg.inv(covariance[np.ix_(order, order)])).T
    text = f"R: [{', '.join(map(decimal, R.ravel()))}]"
    path = tagslam_file(tmp_path, tag=text)
    (marker,) = read_map(path, "tagslam", TAGS).marker_map.markers
    np.testing.assert_allclose(marker.covariance, covariance, atol=1e-9)


def test_override_of_tagslam(tmp_path):
    both = "override_tag_position_noise: 0.5, override_tag_rotation_noise: 0.1"
    read = read_map(tagslam_file(tmp_path, body=both), "tagslam", TAGS)
    assert variances(read, 1) == pytest.approx([0.25] * 3 + [0.01] * 3)
    one = read_map(tagslam_file(tmp_path, body="override_tag_position_noise: 0.5"), "tagslam", TAGS)
    assert variances(one, 1) == pytest.approx([1e-4] * 3 + [1e-6] * 3)


def test_placeholder_is_one_only_in_what_tagslam_wrote(tmp_path):
    ones = "position_noise: {x: 1, y: 1, z: 1}, rotation_noise: {x: 1, y: 1, z: 1}"
    written = read_map(tagslam_file(tmp_path, tag=ones), "tagslam", TAGS)
    assert variances(written, 1) == pytest.approx([0] * 6)
    assert any("the uncertainty of the tags 1" in warning for warning in written.warnings)
    asked = read_map(tagslam_file(tmp_path, tag=ones, top="body_defaults: {}"), "tagslam", TAGS)
    assert variances(asked, 1) == pytest.approx([1] * 6)


def test_an_exact_place_in_tagslam_has_the_deviations_of_its_examples(tmp_path):
    path = str(tmp_path / "tagslam.yaml")
    warnings = write_map(example_map(), path, "tagslam")
    assert any("0.0001 m and 0.00001 rad" in warning for warning in warnings)
    marker = read_map(path, "tagslam", TAGS).marker_map.markers[0]
    np.testing.assert_allclose(np.diag(marker.covariance), [1e-8] * 3 + [1e-10] * 3, rtol=1e-6)


@pytest.mark.parametrize(
    "parts, reason",
    [
        (dict(is_static="false"), r":2: body 'room' moves .*\(--bundle\)"),
        (dict(is_static="maybe"), ":3: 'is_static' must be true or false, not 'maybe'"),
        (dict(type="board"), ":2: body 'room' is a board, which does not list its tags"),
        (dict(pose=""), ":2: body 'room' has no pose: .* convert the poses.yaml"),
        (dict(pose=f"pose: {{{NOWHERE}}}"), ":5: a pose needs either .* or R, this has none"),
        (dict(body="tag_size: 0.1"), ":4: 'tag_size' is not a name in body 'room'"),
        (dict(tags="{id: 1, size: 0.2}"), ":8: tag 1 has no pose: .* convert the poses.yaml"),
        (dict(tags=f"{{id: 1, pose: {{{NOWHERE}, {NOISE}}}}}"), ":8: the tag lacks 'size', and its body"),
        (dict(tags="{id: 1, size: 0.2, center: {}}"), ":8: 'center' is not a name in a tag"),
        (
            dict(tags="{id: 1, size: 0.2, bits: 5}"),
            r":8: 'bits' 5 is tag25h9, the map is of tag36h11 \(--family",
        ),
        (dict(tags="{id: 1, size: 0.2, bits: 9}"), ":8: 'bits' 9 is no family of tagslam"),
        (dict(tags=""), ": has no markers"),
        (dict(tag="R: [1, 2]"), ":8: 'R' must be a list of 36 numbers"),
        (dict(tag=f"R: [{', '.join(['0'] * 36)}]"), ":8: 'R' is singular"),
        (
            dict(tag="R: " + str((1e-9 * np.eye(6)).ravel().tolist())),
            ":8: 'R' has standard deviations of more",
        ),
        (
            dict(tag=f"R: [], {NOISE}"),
            ":8: a pose needs either .* has position_noise and rotation_noise and R",
        ),
        (dict(tag="position_noise: {x: 1, y: 1, z: 1}"), ":8: a pose needs either .* has position_noise"),
        (dict(tag=NOISE.replace("0.001", "-1")), r":8: standard deviations must be in \[0, 1e\+06\]"),
        (dict(tag=NOISE.replace("0.01", "1e300")), r":8: standard deviations must be in \[0, 1e\+06\]"),
        (dict(tag=NOISE.replace("x: 0.001", "x: .nan")), ":8: 'x' must be a finite number, not nan"),
        (dict(tag=NOISE.replace("x: 0.001, ", "")), ":8: 'rotation_noise' lacks 'x'"),
        (dict(place="position: {x: 0, y: 0, z: 0}"), ":8: a pose lacks 'rotation'"),
        (dict(place=NOWHERE + ", yaw: 1"), ":8: 'yaw' is not a name in a pose"),
        (dict(top="bodys: []"), ":10: 'bodys' is not a name in a tagslam.yaml"),
        (dict(top="- room: {type: simple, is_static: true}"), ":10: 'room' is defined twice"),
    ],
)
def test_tagslam_refuses(tmp_path, parts, reason):
    assert re.match(reason, refused(tmp_path, "tagslam.yaml", tagslam_text(**parts), "tagslam", TAGS))


def test_one_body_of_tagslam_is_chosen(tmp_path):
    tag = f"{{id: 4, size: 1, pose: {{{NOWHERE}, {NOISE}}}}}"
    path = tagslam_file(tmp_path, top=f"- cart: {{type: simple, is_static: false, tags: [{tag}]}}")
    with pytest.raises(MapFileError, match="body 'cart' moves"):
        read_map(path, "tagslam", TAGS)
    with pytest.raises(MapFileError, match="has no body 'hall', only room, cart"):
        read_map(path, "tagslam", MapFormatParams(bundle="hall"))
    (marker,) = read_map(path, "tagslam", MapFormatParams(bundle="room")).marker_map.markers
    assert marker.id == 1


def test_bodies_of_tagslam_share_their_error(tmp_path):
    tag = f"{{id: 4, size: 1, pose: {{{NOWHERE}, {NOISE}}}}}"
    other = f"- hall: {{type: simple, is_static: true, pose: {{{NOWHERE}, {NOISE}}}, tags: [{tag}]}}"
    read = read_map(tagslam_file(tmp_path, top=other), "tagslam", TAGS)
    assert [marker.id for marker in read.marker_map.markers] == [1, 4]
    assert any("the uncertainty of the bodies room, hall" in warning for warning in read.warnings)
