# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx configuration, used by tools/docs.sh."""

import re

project = "Sextant"
extensions = ["sphinx.ext.autodoc", "sphinx.ext.graphviz", "myst_parser"]
graphviz_output_format = "svg"
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
    """Shows the indented examples of module docstrings as they are, and draws node graphs by graphviz."""
    app.connect("source-read", _draw_node_graphs)
    app.connect("autodoc-process-docstring", _mark_examples)


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
