# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the launch files: description, node graph and arguments of each.

The nodes and their remapped topics come from roslaunch, the topics of each node from doc/reference/nodes.md.
"""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Dict, Iterator, List, NamedTuple, Optional, Tuple

import rosgraph.names
import roslaunch.config
from parameter_tables import snake_case
from roslaunch.core import Node

ROOT = Path(__file__).resolve().parents[1]
NODES_PAGE = ROOT / "doc/reference/nodes.md"
# Arguments without which a file cannot be loaded or starts next to nothing.
ARGS = {
    "amcl.launch": ["places:=map.txt", "floor:=floor.yaml"],
    "localization.launch": ["marker_map:=map.yaml", "place_map:=map.txt"],
    "places.launch": ["map:=map.txt"],
    "markers.launch": ["map:=map.yaml"],
    "robot.launch": ["map:=map.yaml", "start_camera:=true"],
    "webcam.launch": ["map:=map.yaml"],
}
EVERYWHERE = ("/diagnostics", "/clock", "/tf", "/tf_static")


class Topics(NamedTuple):
    """Topics of a kind of node, with the names that can be remapped."""

    subscribed: List[str]
    published: List[str]


OTHERS = {
    "amcl": Topics(["scan", "map", "initialpose"], ["amcl_pose"]),
    "ekf_localization_node": Topics(["pose", "odom"], ["odometry/filtered"]),
    "map_server": Topics([], ["map"]),
    "cameracalibrator.py": Topics(["image"], []),
}
HEAD = """# Launch files

Written by `tools/reference_pages.py`. `roslaunch --ros-args sextant FILE` lists the arguments, too. In the
graphs, boxes are nodes and rounded shapes are topics; tf, `/clock` and `/diagnostics` are left out.
"""


def documented_topics() -> Dict[str, Topics]:
    """Returns the topics of each node of nodes.md."""
    result = {}
    for part in re.split(r"^## ", NODES_PAGE.read_text(encoding="utf-8"), flags=re.M)[1:]:
        tables = [
            re.search(rf"^### {title}\n\n.*?\n((?:\|.*\n)+)", part, re.M)
            for title in ("Subscribed Topics", "Published Topics")
        ]
        names = [re.findall(r"^\| `([^`]+)`", table[1], re.M) if table else [] for table in tables]
        result[part.partition("\n")[0]] = Topics(
            *([each for each in some if not is_left_out(each)] for some in names)
        )
    return result


def is_left_out(topic: str) -> bool:
    """Whether a topic is not drawn: it is everywhere, or the compressed form of another."""
    return topic in EVERYWHERE or topic.endswith("/compressed")


def kind_of(node: Node) -> str:
    """Returns the name of the node in nodes.md, or its executable."""
    nodelet = re.match(r"load sextant/(\w+)", node.args or "")
    return snake_case(nodelet[1]) if nodelet else node.type


def resolved(node: Node, topic: str) -> str:
    """Returns the name of a topic after the remappings of the node, without the first slash."""
    scope = rosgraph.names.ns_join(node.namespace, node.name) + "/"

    def full(name: str) -> str:
        return rosgraph.names.resolve_name(name, scope)

    remaps = {full(source): full(target) for source, target in node.remap_args}
    if topic == "camera_info" and full(topic) not in remaps:  # beside the image
        image = next(
            (remaps[full(each)] for each in ("image", "image_raw") if full(each) in remaps), "/image"
        )
        return rosgraph.names.namespace(image)[1:] + topic
    return remaps.get(full(topic), full(topic))[1:]


def graph_of(path: Path, topics: Dict[str, Topics]) -> Optional[str]:
    """Returns the node graph of a launch file as a Mermaid flowchart; None: it starts no node with topics."""
    subscribed, published = edges_of(path, topics)
    if not subscribed and not published:
        return None
    lines = [f"  {name}[{name}]" for name in sorted({*sum([*subscribed.values(), *published.values()], [])})]
    drawn = sorted({*subscribed, *published})
    lines += [f'  t{number}(["{topic}"])' for number, topic in enumerate(drawn)]
    for number, topic in enumerate(drawn):
        lines += [f"  {name} --> t{number}" for name in sorted(published.get(topic, []))]
        lines += [f"  t{number} --> {name}" for name in sorted(subscribed.get(topic, []))]
    return "\n".join(["```mermaid", "flowchart LR", *lines, "```"])


def edges_of(path: Path, topics: Dict[str, Topics]) -> Tuple[Dict[str, List[str]], Dict[str, List[str]]]:
    """Returns the subscribers and the publishers of each topic."""
    config = roslaunch.config.load_config_default(
        [(str(path), ARGS.get(path.name, []))], 11311, verbose=False, assign_machines=False
    )
    subscribed: Dict[str, List[str]] = {}
    published: Dict[str, List[str]] = {}
    for node in config.nodes:
        node.name = re.sub(r"_[^_]+_\d+_\d{6,}", "", node.name)  # $(anon NAME)
        of_kind = {**topics, **OTHERS}.get(kind_of(node), Topics([], []))
        for name in of_kind.subscribed:
            subscribed.setdefault(resolved(node, name), []).append(node.name)
        for name in of_kind.published:
            published.setdefault(resolved(node, name), []).append(node.name)
    for placeholder in [topic for topic in subscribed if "MODE" in topic]:
        names, pattern = subscribed.pop(placeholder), placeholder.replace("MODE", r"\w+")
        for topic in filter(re.compile(pattern).fullmatch, published):
            subscribed.setdefault(topic, []).extend(names)
    return subscribed, published


def sections(path: Path, topics: Dict[str, Topics]) -> Iterator[str]:
    """Yields description, graph and table of a launch file, Markdown."""
    root = ElementTree.parse(path).getroot()
    comments = re.findall(r"<!--(.*?)-->", path.read_text(encoding="utf-8"), re.S)
    description = next(text for text in comments if "SPDX" not in text)
    yield f"## {path.name}"
    yield "```text\n" + "\n".join(line.strip() for line in description.strip().splitlines()) + "\n```"
    graph = graph_of(path, topics)
    if graph:
        shown = " ".join(ARGS.get(path.name, []))
        yield f"With `{shown}`:\n\n{graph}" if shown else graph
    rows = [row_of(each) for each in root.findall("arg") if "value" not in each.attrib]
    yield "\n".join(["| argument | default | description |", "| --- | --- | --- |", *rows])


def row_of(arg: ElementTree.Element) -> str:
    """Returns the row of an argument."""
    default = arg.get("default")
    shown = "required" if default is None else f"`{default}`" if default else ""
    return " ".join(
        [
            "|",
            f"`{arg.get('name')}`",
            "|",
            *([shown] if shown else []),
            "|",
            arg.get("doc", "").replace("|", "\\|"),
            "|",
        ]
    )


def page() -> str:
    """Returns the page."""
    topics = documented_topics()
    parts = [part for path in sorted((ROOT / "launch").glob("*.launch")) for part in sections(path, topics)]
    return "\n\n".join([HEAD.rstrip(), *parts]) + "\n"
