# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx configuration, used by tools/docs.sh."""

import dataclasses
import inspect
import re

project = "Sextant"
extensions = ["sphinx.ext.autodoc", "sphinx.ext.graphviz", "myst_parser"]
graphviz_output_format = "svg"
LINK = re.compile(r"\[([^]]*)\]\([^)]*\)")  # of Markdown
NODE_GRAPH = re.compile(r"^```mermaid\nflowchart LR\n(.*?)^```$", re.M | re.S)
root_doc = "doc/index"
autodoc_inherit_docstrings = False
autodoc_mock_imports = ["torch"]
myst_heading_anchors = 4
html_theme = "sphinx_rtd_theme"
html_static_path = ["style.css"]
html_css_files = ["style.css"]
html_show_copyright = False


def setup(app):
    """Shows examples of module docstrings as they are, describes fields, and draws node graphs."""
    app.connect("source-read", _draw_node_graphs)
    app.connect("autodoc-process-docstring", _mark_examples)
    app.connect("autodoc-process-docstring", _describe_fields)
    app.connect("autodoc-skip-member", _skip_listed_field)


def _draw_node_graphs(app, docname, source):
    source[0] = NODE_GRAPH.sub(lambda graph: _graphviz_of(graph[1]), source[0])


def _graphviz_of(mermaid):
    mermaid = re.sub(r"(\w+)\[(\w+)\]", r'\1 [label="\2"]', mermaid)  # a node
    mermaid = re.sub(r'(\w+)\(\["(.*?)"\]\)', r'\1 [label="\2", style="rounded,filled"]', mermaid)  # a topic
    head = 'digraph { rankdir=LR; node [shape=box, fontname=sans, fontsize=11, fillcolor="#eef3f8"];'
    return "\n".join(["```{graphviz}", head, mermaid.replace("-->", "->"), "}", "```"])


def _mark_examples(app, what, name, obj, options, lines):
    if what == "module":
        for i in range(len(lines) - 1, 0, -1):
            if lines[i].startswith("    ") and not lines[i - 1]:
                lines[i:i] = ["::", ""]


def _describe_fields(app, what, name, obj, options, lines):
    """Lists the fields of a dataclass or NamedTuple with their texts."""
    if what == "class" and (dataclasses.is_dataclass(obj) or hasattr(obj, "_fields")):
        names = [name for name in vars(obj).get("__annotations__", {}) if not name.startswith("_")]
        lines += ["", *(f":ivar {name}: {_rst(_text_of_field(obj, name))}" for name in names), ""]


def _skip_listed_field(app, what, name, obj, skip, options):
    return skip or (inspect.getdoc(obj) or "").startswith("Alias for field number")


def _text_of_field(cls, name):
    """Texts of the parameter, or the comment behind the field."""
    fields = {each.name: each for each in dataclasses.fields(cls)} if dataclasses.is_dataclass(cls) else {}
    about = fields[name].metadata if name in fields else {}
    if "what" in about:
        return "; ".join(filter(None, [LINK.sub(r"\1", about["what"]), about["check"].text, about["unit"]]))
    comment = re.search(rf"^    {name}: (?:.*\n        )*?.*?  # (.*)$", inspect.getsource(cls), re.M)
    return comment[1] if comment else ""


def _rst(text):
    """Plain text, in which only `names` are marked, as reStructuredText."""
    name_or_special = re.compile(r"(`[^`]+`)|([*|_\\`])")
    return name_or_special.sub(lambda found: f"`{found[1]}`" if found[1] else f"\\{found[2]}", text)
