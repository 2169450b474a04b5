# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The texts of the arguments in launch/ that set one parameter of one node: the description of the parameter.

An argument that is only passed to an argument of an included file has the text of that one.
"""

import functools
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import yaml
from parameter_tables import ROOT, STRUCTS, literal, plain, records, rows_of, snake_case

# Arguments whose own text has facts of that launch file, which the parameter's description lacks.
OWN = {
    "amcl.launch": {"places"},
    "calibrate.launch": {"calibration", "width"},
}
Element = ElementTree.Element


class Use(NamedTuple):
    """An element that contains an argument's value, with the element around it."""

    element: Element
    parent: Element


@functools.lru_cache(maxsize=None)
def parsed(path: Path) -> Element:
    """Returns the root of a launch file."""
    return ElementTree.parse(path).getroot()


def declared(path: Path) -> Dict[str, Element]:
    """Returns the arguments that a user of the file may set, by name."""
    return {each.get("name"): each for each in parsed(path).findall("arg") if each.get("value") is None}


def uses(path: Path, name: str) -> List[Use]:
    """Returns the elements that contain the value of an argument."""
    reference = re.compile(rf"\$\(arg {name}\)|arg\('{name}'\)")
    return [
        Use(element, parent)
        for parent in parsed(path).iter()
        for element in parent
        if reference.search(" ".join([*element.attrib.values(), element.text or ""]))
    ]


def is_passed_on(element: Element, name: str) -> bool:
    """Whether the element takes exactly the value of the argument, perhaps under a condition on it."""
    others = [value for key, value in element.attrib.items() if key not in ("if", "value")]
    value = element.get("value", (element.text or "").strip())
    return value == f"$(arg {name})" and not any("arg" in each for each in others)


def kind_of(node: Element) -> Optional[str]:
    """Returns the name of the node in doc/reference/nodes.md; None: not one of Sextant."""
    nodelet = re.search(r"load sextant/(\w+)", node.get("args", ""))
    if nodelet:
        return snake_case(nodelet[1])
    return node.get("type") if node.get("pkg") == "sextant" else None


def text_of(path: Path, name: str) -> str:
    """Returns the text of an argument: generated if possible, otherwise its own."""
    arg = declared(path)[name]
    text = None if name in OWN.get(path.name, ()) else passed_text(path, name) or parameter_text(path, name)
    if text is None:
        return arg.get("doc", "")
    return text if arg.get("default") == "" else re.sub(r"; empty: [^;]*", "", text)


def included(element: Element) -> Optional[Path]:
    """Returns the launch file that an element includes; None: it includes none of Sextant."""
    found = re.fullmatch(r"\$\(find sextant\)/launch/(\w+\.launch)", element.get("file", ""))
    return ROOT / "launch" / found[1] if element.tag == "include" and found else None


def passed_text(path: Path, name: str) -> Optional[str]:
    """Returns the text of the included file's argument that this one is passed to."""
    for include in parsed(path).iter("include"):
        other = included(include)
        if include.get("pass_all_args") == "true" and other and name in declared(other):
            return text_of(other, name)
    target, found = passed_to(path, name), uses(path, name)
    if target is None or len(found) > 1:
        return None
    defaults = [declared(file)[key].get("default") == "" for file, key in ((path, name), target)]
    return text_of(*target) if len(set(defaults)) == 1 else None


def passed_to(path: Path, name: str) -> Optional[Tuple[Path, str]]:
    """Returns file and name of the included file's argument that an argument is first passed to."""
    for element, parent in uses(path, name):
        other = included(parent)
        if other and is_passed_on(element, name):
            return other, element.get("name")
    return None


def parameter_text(path: Path, name: str) -> Optional[str]:
    """Returns the description of the parameter that an argument sets, and what it is without the argument."""
    found = uses(path, name)
    if len(found) != 1 or found[0].parent.tag != "node" or not is_passed_on(found[0].element, name):
        return None
    element, node = found[0]
    kind, parameter = kind_of(node), element.get("name", element.get("param"))
    presets = presets_of(node, parameter)
    if kind not in {*STRUCTS, *records()} or any("if" in each.attrib for each in presets):
        return None
    row = next(row for row in rows_of(kind) if row.name == parameter)
    default = yaml.safe_load(presets[-1].text)[parameter] if presets else row.default
    return with_default(plain(row, node.get("name")), default)


def presets_of(node: Element, parameter: str) -> List[Element]:
    """Returns the elements in which the launch file itself sets a parameter of a node."""
    written = [each for each in node.iter("rosparam") if not {"command", "param"} & set(each.attrib)]
    return [each for each in written if parameter in yaml.safe_load(each.text)]


def with_default(text: str, default: Any) -> str:
    """Adds what an empty argument means, unless the text has it or the default is empty, too."""
    is_known = "; empty: " in text or default in ("", [], {})
    return text if is_known else f"{text}; empty: {literal(default)}"


def files() -> Dict[Path, str]:
    """Returns the text of each launch file."""
    parsed.cache_clear()
    return {path: with_texts(path) for path in sorted((ROOT / "launch").glob("*.launch"))}


def with_texts(path: Path) -> str:
    """Returns a launch file with the texts of its arguments."""
    content = path.read_text(encoding="utf-8")
    for name in declared(path):
        text = text_of(path, name).replace("&", "&amp;").replace("<", "&lt;")
        doc = re.compile(rf'(<arg name="{name}"[^>]*?\bdoc=")[^"]*"')
        content = doc.sub(lambda found, text=text: f'{found[1]}{text}"', content, count=1)
    return content
