# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every launch, configuration and map file that is shipped is loaded, by roslaunch's own loader."""

import functools
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
import roslaunch.config
import roslib.packages
import yaml
from test_doc import table_of

import sextant
from sextant.base.strict_params import parse_params, parse_struct
from sextant.nodes.simulation.landmark_simulator import LandmarkSimulatorParams
from sextant.simulation.drive import DriveParams
from sextant.simulation.rgbd_camera import RgbdParams
from sextant.simulation.room_markers import default_map

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
from launch_pages import resolved  # noqa: E402
from parameter_tables import records, snake_case  # noqa: E402

LAUNCH_FILES = sorted((ROOT / "launch").glob("*.launch"))
ROOM = str(ROOT / "config" / "room.txt")

NEEDED = {"places.launch": ["map:=park.txt"], "amcl.launch": ["places:=park.txt"]}
# Packages that Debian does not have, and one that only a Kobuki needs.
FOREIGN = {"robot_localization", "amcl", "map_server", "move_base", "topic_tools"}

# Arguments that, all together, enter every <... if=...> of the shipped files.
BRANCHES = {
    "robot.launch": [
        ["map:=" + ROOM, "start_camera:=true", "camera_info:=calibration"],
        ["start_manager:=false"],
        ["start_camera:=true", "camera_exposure:=0.005", "camera_automatic:=[focus]"],
    ],
    "markers.launch": [
        ["map:=" + ROOM, "camera_info:=calibration"],
        ["start_manager:=false"],
        ["detections:=tag_detections", "camera_info:=calibration"],
    ],
    "corridor_experiment.launch": [["ekf:=true"]],
    "demo.launch": [["rviz:=true", "mode:=nearest"], ["mode:=average"]],
    "building_demo.launch": [["rviz:=true", "move_base:=true"], ["maps:=/maps"]],
    "calibrate.launch": [
        ["fisheye:=true", "commit:=false"],
        ["start_camera:=false", "camera:=front", "image:=front/image_raw"],
    ],
    "landmarks.launch": [["manager:=sextant_manager", "markers:=[markers]", "start_pose:=[1, 2.5, 0]"]],
    "localization.launch": [["marker_map:=hall.yaml", "place_map:=park.txt", "landmark_map:=pillars.yaml"]],
    "landmarks_demo.launch": [["rviz:=true"]],
    "ball_task.launch": [["rviz:=true", "task:=3", "detector:=colour"]],
    "turtlebot.launch": [
        ["mount:=0.1 0 0.3 0 0.25 0", "rviz:=true"],
        ["kobuki_bumper:=none", "autostart:=false"],
    ],
    "robot_localization.launch": [["odom:=wheels/odom"]],
    "amcl.launch": [["floor:=floor.yaml"]],
    "places.launch": [["start_camera:=true", "rviz:=true"], ["visualizer:=false"]],
    "places_demo.launch": [["rviz:=true", "season:=[dusk]"]],
    "teleop.launch": [["joystick:=/dev/input/js0", "bag:=drive.bag", "topics:=/odom"]],
    "webcam.launch": [
        ["rviz:=true"],
        ["map:=" + ROOM, "rviz:=true"],
        ["exposure:=0.005", "gain:=4", "focus:=0", "white_balance:=4600"],
    ],
    "view.launch": [
        ["hostname:=laptop", "master:=http://robot:11311"],
        ["rviz:=false"],
        ["system:=localization"],
    ],
}
RUNS = [
    (path, [*NEEDED.get(path.name, []), *args])
    for path in LAUNCH_FILES
    for args in [[], *BRANCHES.get(path.name, [])]
]

# Arguments that enter every node with a file of parameters.
ENTERED = dict.fromkeys(("markers.launch", "robot.launch"), ["map:=" + ROOM])
FILES = [
    (path, each.get("name"))
    for path in LAUNCH_FILES
    for each in ElementTree.parse(path).getroot().iter("arg")
    if each.get("name").endswith("params") and each.get("default")
]
# Arguments without which the node that reads the file is not started.
STARTED = {"adapter_params": ["detections:=tag_detections"]}
# What such a file cannot set, because it is of several nodes or the user has to give it.
ARGUMENTS_ALONE = {
    ("building_demo.launch", "simulator_params"): {"map_folder", "spacing"},
    ("demo.launch", "simulator_params"): {"map_file", "family", "marker_size"},
    ("corridor_experiment.launch", "simulator_params"): {"map_file"},
    ("places.launch", "localizer_params"): {"map_file"},
    ("places.launch", "visualizer_params"): {"map_file"},
    ("amcl.launch", "localizer_params"): {"map_file"},
    ("ball_task.launch", "locator_params"): {"base_frame"},
    ("localization.launch", "landmark_params"): {"start", "read_only", "tf_output"},
}


def load(path, args=()):
    argv = [str(path), *args]
    return roslaunch.config.load_config_default(
        [(str(path), argv[1:])], 11311, verbose=False, assign_machines=False
    )


@functools.lru_cache(maxsize=None)
def is_there(package, node_type):
    return bool(roslib.packages.find_node(package, node_type))


def tag_of(run):
    path, args = run
    return " ".join([path.name, *args]).replace(str(ROOT), ".")


def loaded_classes(config):
    """Names of nodes to the nodelets that they load."""
    loads = [(node, re.match(r"load (\S+)", node.args or "")) for node in config.nodes]
    return {node.name: match.group(1) for node, match in loads if match}


def params_of(config, name):
    """Private parameters of a node, nested ones as dictionaries."""
    prefix, result = f"/{name}/", {}
    for key, param in config.params.items():
        if key.startswith(prefix):
            first, _, rest = key[len(prefix) :].partition("/")
            if rest:
                result.setdefault(first, {})[rest] = param.value
            else:
                result[first] = param.value
    return result


def declared(path):
    """Arguments that a user of the file may set."""
    return [each for each in ElementTree.parse(path).getroot().iter("arg") if each.get("value") is None]


def own_declared(path):
    return {each.get("name"): (each.get("default"), each.get("doc")) for each in declared(path)}


def test_there_are_launch_files():
    assert set(BRANCHES) == {path.name for path in LAUNCH_FILES}


@pytest.mark.slow
@pytest.mark.parametrize("run", RUNS, ids=tag_of)
def test_loads_and_every_node_exists(run):
    config = load(*run)
    assert config.nodes and not config.config_errors
    for node in config.nodes:
        assert node.package in FOREIGN or is_there(node.package, node.type), f"{node.package}/{node.type}"
    plugins = ElementTree.parse(ROOT / "nodelet_plugins.xml").getroot()
    assert set(loaded_classes(config).values()) <= {each.get("name") for each in plugins.iter("class")}


@pytest.mark.slow
@pytest.mark.parametrize("run", RUNS, ids=tag_of)
def test_nodes_know_their_parameters(run):
    config = load(*run)
    for node in config.nodes:
        if node.type in records():
            parse_params(records()[node.type], params_of(config, node.name), node.name)
    for node, nodelet in loaded_classes(config).items():
        struct = getattr(sextant, nodelet.split("/")[1] + "NodeParams")
        parse_struct(struct, params_of(config, node), node)


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_every_argument_is_documented(path):
    assert [each.get("name") for each in declared(path) if not each.get("doc")] == []


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_what_is_not_empty_by_default_is_not_switched_off_by_emptiness(path):
    """roslaunch drops an argument without a value from its command line."""
    args = own_declared(path)
    assert [name for name, (default, doc) in args.items() if default and "empty:" in doc] == []


@pytest.mark.slow
@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_the_word_none_switches_off(path):
    args = own_declared(path)
    words = {name for name, (_, doc) in args.items() if "; none: " in doc}
    given = {"map": ROOM, **dict.fromkeys(words, "none")}
    taken = [f"{name}:={given[name]}" for name in args if name in given]
    config = load(path, [*NEEDED.get(path.name, []), *taken])
    values = [param.value for key, param in config.params.items() if key.rpartition("/")[2] in words]
    assert values == [""] * len(words & {"base_frame", "fourcc", "plot"})  # the others are no parameters
    assert not words & {node.name for node in config.nodes}


def test_robot_launch_passes_every_argument_of_markers_launch():
    robot, markers = own_declared(ROOT / "launch/robot.launch"), own_declared(ROOT / "launch/markers.launch")
    assert {name: robot.get(name) for name in markers} == markers


@pytest.mark.parametrize("name", ["markers.launch", "robot.launch", "webcam.launch"])
@pytest.mark.parametrize("topic", ["pose", "markers/pose"])
def test_the_locator_publishes_its_pose_on_the_topic_of_the_argument(name, topic):
    shown = ["rviz:=true"] if name == "webcam.launch" else []
    config = load(ROOT / "launch" / name, ["map:=" + ROOM, f"pose:={topic}", *shown])
    nodes = [node for node in config.nodes if node.name in ("marker_locator", "rviz")]
    assert [resolved(node, "pose") for node in nodes] == [topic] * (1 + len(shown))


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_an_empty_argument_means_what_its_doc_has(path):
    found = {name: re.search(r"; empty: ([][\w.-]+)$", doc) for name, (_, doc) in own_declared(path).items()}
    needed = [*NEEDED.get(path.name, []), *ENTERED.get(path.name, [])]
    plain = load(path, needed)
    given = load(path, [*needed, *(f"{name}:={match[1]}" for name, match in found.items() if match)])
    for node in plain.nodes:
        if node.package in FOREIGN:
            continue
        kind = snake_case(loaded_classes(plain).get(node.name, "/" + node.type).split("/")[1])
        taken, own = params_of(given, node.name), params_of(plain, node.name)
        defaults = {**table_of(kind), **own} if set(taken) - set(own) else own
        assert {key: defaults[key] for key in taken} == taken


def params_with(path, *args):
    needed = [*NEEDED.get(path.name, []), *ENTERED.get(path.name, [])]
    return {key: param.value for key, param in load(path, [*needed, *args]).params.items()}


def reader_of(path, name, file, start):
    """The node that reads a file of parameters, with a slash at both ends."""
    file.write_text("probe: 1")
    (node,) = (key[:-5] for key in params_with(path, f"{name}:={file}", *start) if key.endswith("/probe"))
    return node


def differences(params, others):
    return {key for key, value in params.items() if others.get(key) != value}


@pytest.mark.parametrize(("path", "name"), FILES, ids=lambda each: getattr(each, "name", each))
def test_a_file_wins_over_defaults_and_arguments_win_over_the_file(path, name, tmp_path):
    file = tmp_path / "params.yaml"
    start = STARTED.get(name, [])
    node = reader_of(path, name, file, start)
    empty = {arg for arg, (default, _) in own_declared(path).items() if default == ""}
    names = {"camera_info", "manager", "detections", "maps"}
    sevens = [f"{arg}:=7" for arg in empty - names]
    plain, given = params_with(path, *start), params_with(path, *start, *sevens)
    from_file = {key: "of the file" for key in given if key.startswith(node)}
    file.write_text(yaml.safe_dump({key[len(node) :]: value for key, value in from_file.items()}))
    lost = differences(from_file, params_with(path, f"{name}:={file}", *start))
    assert {key[len(node) :] for key in lost} == ARGUMENTS_ALONE.get((path.name, name), set())
    lost = differences(given, params_with(path, f"{name}:={file}", *start, *sevens))
    assert not lost & differences(given, plain)


def test_the_demo_of_landmarks_sets_the_range_of_its_sensor():
    config = load(ROOT / "launch/landmarks_demo.launch")
    simulated, slam = LandmarkSimulatorParams(), "landmark_slam"
    params = {**table_of(slam), **params_of(config, slam)}
    assert (params["max_range"], params["field_of_view"]) == (simulated.max_range, simulated.field_of_view)


def test_one_pose_uses_the_recognized_places_and_is_the_only_pose():
    config = load(ROOT / "launch/localization.launch", ["place_map:=park.txt"])
    nodes = {node.name: node for node in config.nodes}
    places, slam = nodes["place_localizer"], nodes["landmark_slam"]
    assert resolved(places, "hypotheses") == params_of(config, "landmark_slam")["places"]
    assert resolved(slam, "pose") == "pose" != resolved(places, "pose")


def test_the_ball_task_knows_the_simulated_camera():
    config, camera = load(ROOT / "launch/ball_task.launch"), RgbdParams()
    for name, parameter in (("object_locator", "depth_scale"), ("ball_task", "depth_scale")):
        assert params_of(config, name)[parameter] * camera.depth_scale == pytest.approx(1.0)
    assert 0.7 * camera.colour_fov < params_of(config, "landmark_slam")["field_of_view"] < camera.colour_fov


def test_filter_of_robot_localization_is_whole():
    """15 flags an input: position, rotation, their speeds, acceleration; and a covariance of them all."""
    config = params_of(load(ROOT / "launch/robot_localization.launch"), "ekf_map")
    flags = {key: np.flatnonzero(value).tolist() for key, value in config.items() if key.endswith("_config")}
    assert [len(value) for key, value in config.items() if key.endswith("_config")] == [15, 15]
    assert flags == {"odom0_config": [6, 7, 11], "pose0_config": [0, 1, 5]}
    covariance = np.reshape(config["initial_estimate_covariance"], (15, 15))
    assert np.count_nonzero(covariance) == 15 and covariance[0, 0] >= 1000.0
    assert (config["world_frame"], config["map_frame"]) == ("map", "map")


def test_the_corridor_experiment_knows_the_noise_of_its_odometry():
    config = load(ROOT / "launch/corridor_experiment.launch")
    noise, params = DriveParams().odometry, params_of(config, "landmark_slam")
    assert params["translation_from_translation"] == noise.distance_per_metre
    assert params["rotation_from_translation"] == noise.angle_per_metre
    assert params["rotation_from_rotation"] == noise.angle_per_radian


@pytest.mark.slow
def test_the_demo_of_places_has_a_folder_for_every_map():
    def folder(*args):
        config = load(ROOT / "launch/places_demo.launch", args)
        return params_of(config, "street_simulator")["map_folder"]

    others = ["seed:=2", "spacing:=4.0", "parts:=9", "width:=640", "height:=240"]
    others += ["map_season:=[summer, winter]", "map_season:=[winter]"]
    folders = [folder(), *map(folder, others)]
    assert len(set(folders)) == len(folders) and not any(mark in "".join(folders) for mark in " [],")
    assert folder("season:=[dusk]", "speed:=1.0", "rate:=5.0", "mode:=votes") == folder()


@pytest.mark.parametrize("path", sorted((ROOT / "config").glob("*.yaml")), ids=lambda path: path.name)
def test_yaml_is_a_table(path):
    assert isinstance(yaml.safe_load(path.read_text()), dict)


@pytest.mark.parametrize("path", sorted((ROOT / "config").glob("*.rviz")), ids=lambda path: path.name)
def test_rviz_topics_are_relative(path):
    """So that the launch files can remap them and a namespace holds them."""
    manager = yaml.safe_load(path.read_text())["Visualization Manager"]
    topics = [display[key] for display in manager["Displays"] for key in display if key.endswith("Topic")]
    assert len(topics) >= 5
    assert [topic for topic in topics if topic.startswith("/")] == []


def test_room_file_is_the_simulated_room():
    room, expected = sextant.read_marker_map(ROOM), default_map()
    assert [(each.family, each.id, each.size) for each in room.markers] == [
        (each.family, each.id, each.size) for each in expected.markers
    ]
    for marker, truth in zip(room.markers, expected.markers):
        np.testing.assert_allclose(marker.T_map_marker, truth.T_map_marker, atol=1e-12)
