# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the pages state is true: parameters and their defaults, topics, messages, links, code examples."""

import re
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from made_photos import picture as place_picture
from made_photos import shifted, written_photos

import sextant

ROOT = Path(__file__).resolve().parents[3]
NODES_PAGE = (ROOT / "doc/reference/nodes.md").read_text()
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "doc").rglob("*.md"), *(ROOT / "test").rglob("*.md")])
sys.path.insert(0, str(ROOT / "tools"))
from parameter_tables import STRUCTS as NODELETS  # noqa: E402
from parameter_tables import records, rows_of  # noqa: E402
from reference_pages import STEPS  # noqa: E402

SCRIPTS = {
    path.stem: path
    for path in sorted((ROOT / "src/sextant/nodes").rglob("*.py"))
    if (ROOT / "scripts/nodes" / path.stem).exists()
}

NEEDED = "required"  # where the table has a default


def section(page, title):
    """Text below a heading, to the next one of its level."""
    level, found = re.search(rf"^(#+) {re.escape(title)}\n(.*)", page, re.M | re.S).groups()
    return re.split(rf"^#{{1,{len(level)}}} ", found, flags=re.M)[0]


def code(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.M | re.S)


# ---- parameters -----------------------------------------------------------------------------------------


def table_of(node):
    """{parameter: default} as the page has them."""
    table = section(NODES_PAGE, node).partition("| parameter |")[2].partition("\n\n")[0]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    return {
        name.strip("`"): NEEDED if default == NEEDED else yaml.safe_load(default.strip("`"))
        for name, _, _, default, _ in rows
    }


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.__module__)
def test_generated_texts_follow_the_sources(step):
    """Else run tools/reference_pages.py."""
    assert [path.name for path, text in step().items() if path.read_text() != text] == []


def test_every_command_is_on_the_page_of_commands():
    page = (ROOT / "doc/reference/commands.md").read_text()
    executables = [path.name for path in (ROOT / "scripts").iterdir() if path.is_file() and not path.suffix]
    assert len(executables) > 10
    assert [name for name in executables if f"| `{name}` | " not in page] == []


def test_the_parameters_of_every_node_are_found_and_described():
    assert set(records()) == {node for node, path in SCRIPTS.items() if "read_params(" in path.read_text()}
    rows = {f"{node}/{row.name}": row.what for node in [*NODELETS, *records()] for row in rows_of(node)}
    assert [name for name, what in rows.items() if not what] == []


# ---- topics, services, families -------------------------------------------------------------------------


def source_of(node):
    if node in NODELETS:
        return (ROOT / f"src/nodelets/{node}_nodelet.cpp").read_text()
    return SCRIPTS[node].read_text()


@pytest.mark.parametrize("node", [*sorted(NODELETS), *SCRIPTS])
def test_topics_and_services_are_named(node):
    calls = "advertise|subscribe|advertiseService|Publisher|Subscriber|Service|LatestImage"
    call = rf'(?:{calls})(?:<[^(]*>)?\(\s*"([^"]+)"'
    names = set(re.findall(call, source_of(node)))
    assert names or node == "registration_keeper"  # which has those of the others
    text = section(NODES_PAGE, node)
    assert {name for name in names if f"`{name}`" not in text and f"`~{name}`" not in text} == set()


def test_every_family_is_named():
    table = section(NODES_PAGE, "Marker families")
    endings = {re.sub(r"^DICT_(\dX\d|APRILTAG)", "", name) for name in sextant.marker_families()}
    assert {ending for ending in endings if f"{ending}`" not in table} == set()


def test_dictionary_numbers_are_those_of_opencv():
    page = (ROOT / "doc/how_to/migrating.md").read_text()
    rows = dict(re.findall(r"\| (\d+) \| `(DICT_\w+)`", page))
    dictionaries = [name for name in sextant.marker_families() if name.startswith("DICT")]
    assert {name: int(number) for number, name in rows.items()} == {
        name: getattr(cv2.aruco, name) for name in dictionaries
    }


def test_messages_are_those_of_the_code():
    """The first column of "No pose", but for what stands in the place of names and numbers."""
    sources = [path for path in (ROOT / "src").rglob("*") if path.suffix in (".cpp", ".py")]
    source = re.sub(r'"\s+"', "", "\n".join(path.read_text() for path in sources))
    table = section((ROOT / "doc/how_to/trouble.md").read_text(), "No pose")
    messages = re.findall(r"`([^`]+)`", " ".join(re.findall(r"^\| (.*?) \|", table, re.M)))
    parts = [part.strip() for text in messages for part in re.split("…|[A-Z]+[^ ]*|no pose:", text)]
    assert len(messages) > 15
    assert [part for part in parts if len(part) > 3 and part not in source] == []


# ---- links ----------------------------------------------------------------------------------------------


def anchors(page):
    """What a page's headings are called in links, as GitHub makes them."""
    titles = re.findall(r"^#+ (.*)", re.sub(r"^```.*?^```", "", page, flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def is_dead(page, link):
    path, _, anchor = link.partition("#")
    target = (page.parent / path) if path else page
    return not target.exists() or bool(anchor) and anchor not in anchors(target.read_text())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_relative_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)\s]+)\)", page.read_text())
    assert [link for link in links if "://" not in link and is_dead(page, link)] == []


def test_pages_are_there():
    assert {"README.md", "nodes.md", "marker_map.md", "frames.md", "migrating.md", "trouble.md"} <= {
        page.name for page in PAGES
    }


# ---- code -----------------------------------------------------------------------------------------------


def picture_of(calibration, marker_map, T_map_camera):
    scene = sextant.RoomScene(sextant.RoomSceneParams(), marker_map)
    camera = sextant.CameraModel(calibration)
    return sextant.RoomRenderer(sextant.RoomRendererParams(), scene, camera).render([T_map_camera], 0)


def test_library_example_locates_the_camera(tmp_path, monkeypatch):
    """A rendered picture, whose camera pose is known."""
    monkeypatch.chdir(tmp_path)
    T_map_camera = sextant.pose_from_xyz_rpy([0.0, 0.0, 1.0], [-0.5 * np.pi, 0.0, 0.0])  # looks along y
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height, calibration.distortion_model = 640, 480, "plumb_bob"
    calibration.K = np.array([[500.0, 0, 319.5], [0, 500.0, 239.5], [0, 0, 1]])
    room = ROOT / "config/room.txt"
    (tmp_path / "map.txt").write_text(room.read_text())
    picture = picture_of(calibration, sextant.read_marker_map(str(room)), T_map_camera)
    cv2.imwrite("photo.png", picture)

    names = {}
    for block in code(section(NODES_PAGE, "In Python, without ROS"), "python"):
        exec(block, names)
    assert len(names["detections"]) == 2
    error = sextant.pose_error(T_map_camera, names["result"].pose.T_map_base)
    assert np.linalg.norm(error[:3]) < 0.02 and np.linalg.norm(error[3:]) < 0.01
    marker = names["poses"].best.T_camera_marker[:3, 3]
    np.testing.assert_allclose(np.abs(marker), [1.5, 0.0, 3.0], atol=0.1)


def test_library_example_localizes_a_photo(tmp_path, monkeypatch, capsys):
    """A photo a bit aside of one in the map."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hall").mkdir()
    made = written_photos(tmp_path / "hall", 5)
    (made.folder / "park.txt").rename(made.folder / "map.txt")
    cv2.imwrite("photo.jpg", shifted(place_picture(3), 4, 2))
    (block,) = code(section((ROOT / "doc/how_to/places.md").read_text(), "In Python, without ROS"), "python")
    exec(block, {})
    assert capsys.readouterr().out.startswith("LOCALIZED [('3.png', 0.9")


def migration(index):
    return code((ROOT / "doc/how_to/migrating.md").read_text(), "python")[index]


# Where the packages' sources put the corners top left, top right, bottom right, bottom left in their frame.
CORNERS = {
    "aruco_ros, library 3": [(-1, 1), (1, 1), (1, -1), (-1, -1)],
    "aruco_ros, library 1 or 2, rotate_marker_axis false": [(-1, -1), (-1, 1), (1, 1), (1, -1)],
    "apriltag_ros": [(-1, 1), (1, 1), (1, -1), (-1, -1)],
    "libapriltag's estimate_tag_pose": [(-1, -1), (1, -1), (1, 1), (-1, 1)],
    "fiducials": [(-1, 1), (1, 1), (1, -1), (-1, -1)],
    "fiducials, DICT_APRILTAG_...": [(1, -1), (-1, -1), (-1, 1), (1, 1)],
}
# rotate_to_ros of aruco_ros before library 3, multiplied from the right
ROTATE_TO_ROS = np.array([[-1, 0, 0], [0, 0, 1], [0, 1, 0]])


def test_constant_rotations_put_the_corners_where_they_are():
    names = {}
    exec(migration(0), names)
    ours = sextant.marker_corners(2.0)
    for convention, corners in CORNERS.items():
        theirs = np.column_stack([np.array(corners, float), np.zeros(4)])
        np.testing.assert_allclose(ours @ names["R_THEIRS_SEXTANT"][convention].T, theirs, err_msg=convention)
    plain = names["R_THEIRS_SEXTANT"]["aruco_ros, library 1 or 2, rotate_marker_axis false"]
    np.testing.assert_allclose(names["R_THEIRS_SEXTANT"]["aruco_ros, library 1 or 2"], ROTATE_TO_ROS @ plain)
    assert set(names["R_THEIRS_SEXTANT"]) == {*CORNERS, "aruco_ros, library 1 or 2"}
    for R in names["R_THEIRS_SEXTANT"].values():
        assert np.linalg.det(R) == pytest.approx(1.0)


@pytest.mark.parametrize("language, name", [("yaml", "map.yaml"), ("text", "map.txt")])
def test_examples_of_maps_are_read(tmp_path, language, name):
    (tmp_path / name).write_text(code((ROOT / "doc/reference/marker_map.md").read_text(), language)[0])
    marker_map = sextant.read_marker_map(str(tmp_path / name))
    assert len(marker_map.markers) == 2 and len(marker_map.frames) == 1
    np.testing.assert_allclose(marker_map.find("tag36h11", 7).T_map_marker[:3, 2], [-1, 0, 0], atol=1e-4)


def test_directions_of_hanging_markers():
    page = (ROOT / "doc/reference/marker_map.md").read_text()
    rows = re.findall(r"^\| ([+−])([xyz]) .*\| `(\[.*\])` \|$", page, re.M)
    assert len(rows) == 6
    for sign, axis, rpy in rows:
        z = sextant.pose_from_xyz_rpy([0, 0, 0], yaml.safe_load(rpy))[:3, 2]
        expected = np.eye(3)["xyz".index(axis)] * (1 if sign == "+" else -1)
        np.testing.assert_allclose(z, expected, atol=1e-4)


def test_filter_configuration_is_whole():
    """15 flags an input: position, rotation, their speeds, acceleration."""
    filters = yaml.safe_load(code((ROOT / "doc/reference/frames.md").read_text(), "yaml")[0])
    flags = [value for each in filters.values() for key, value in each.items() if key.endswith("_config")]
    assert [len(each) for each in flags] == [15]
    assert filters["ekf_odom"]["world_frame"] == "odom"
