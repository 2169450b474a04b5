# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Self-contained HTML reports: one file without external resources or scripts.

A template extends REPORT, and may import its macros:

    {% extends "report" %}
    {% from "macros" import table %}
    {% block content %}<h1>{{ title }}</h1>{{ table(part) }}{% endblock %}
"""

import base64
from dataclasses import dataclass
from pathlib import Path
from typing import List, Mapping, NamedTuple, Tuple, Union

import cv2
import numpy as np
from jinja2 import DictLoader, Environment, StrictUndefined

from sextant.base.atomic_file import atomic_file

REPORT = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>{{ title }}</title>
<style>
body { font-family: sans-serif; max-width: 82rem; margin: 1.5rem auto; padding: 0 1rem; color: #222; }
h1 { margin-bottom: 0.2rem; }
h2 { margin-top: 2.2rem; border-bottom: 1px solid #ccc; }
.verdict { font-size: 1.3rem; }
.findings li { margin: 0.5rem 0; }
.advice { color: #555; }
img { max-width: 100%; }
table { border-collapse: collapse; }
th, td { padding: 0.2rem 0.7rem; border-bottom: 1px solid #ddd; text-align: right; }
th { background: #f2f2f2; vertical-align: bottom; }
td.text, th.text { text-align: left; }
td:not(.text), td:first-child { white-space: nowrap; }
tr.highlighted td { background: #fdebdc; }
p.note { color: #555; max-width: 60rem; }
summary { cursor: pointer; margin: 0.5rem 0; }
.photos { display: flex; flex-wrap: wrap; gap: 0.7rem; }
.photos figure { margin: 0; }
</style>
</head>
<body>
{%- block content %}{% endblock %}
</body>
</html>
"""
MACROS = """\
{%- macro table(part) %}
<table>
<tr>
{%- for head in part.heads %}
<th{% if loop.index0 in part.text_columns %} class="text"{% endif %}>{{ head }}</th>
{%- endfor %}</tr>
{%- for row in part.rows %}
<tr{% if row.highlighted %} class="highlighted"{% endif %}>
{%- for cell in row.cells %}
<td{% if loop.index0 in part.text_columns %} class="text"{% endif %}>{{ cell }}</td>
{%- endfor %}</tr>
{%- endfor %}
</table>
{%- endmacro %}
{%- macro findings_list(findings) %}
{%- if findings %}
<h2>Findings</h2>
<ol class="findings">
{%- for finding in findings %}
<li><b>{{ finding.fact }}</b>: <span class="advice">{{ finding.advice }}</span></li>
{%- endfor %}
</ol>
{%- endif %}
{%- endmacro %}
{%- macro gallery(photos) %}
<div class="photos">
{%- for photo in photos %}
<figure><img src="{{ photo.source }}" alt="{{ photo.name }}">
<figcaption>{{ photo.name }}</figcaption></figure>
{%- endfor %}
</div>
{%- endmacro %}
"""
JPEG_QUALITY = 85


@dataclass(frozen=True)
class Row:
    """A row of a table."""

    cells: Tuple[str, ...]  # texts
    highlighted: bool = False  # coloured background


@dataclass(frozen=True)
class Table:
    """A table of a report."""

    heads: Tuple[str, ...]  # texts of the columns
    rows: List[Row]  # with as many cells
    text_columns: Tuple[int, ...] = (0,)  # indices, aligned to the left


class PagePlot(NamedTuple):
    """A plot or a photo of a report."""

    name: str  # below a photo, and for readers without images
    source: str  # src of an img element, see embedded() and embedded_photo()


def write_report(path: Union[str, Path], template: str, content: Mapping[str, object]) -> None:
    """Writes a report atomically.

    :param template: jinja2, extends "report"
    :param content: values of the template, escaped; among them title
    :raises OSError: the file cannot be written
    """
    loader = DictLoader({"report": REPORT, "macros": MACROS})
    environment = Environment(autoescape=True, undefined=StrictUndefined, loader=loader)
    page = environment.from_string(template).render(content)
    with atomic_file(path, "wb") as file:
        # File names need not be UTF-8: Python represents other bytes as surrogates.
        file.write(page.encode("utf-8", "backslashreplace"))


def embedded(png: bytes) -> str:
    """Returns the bytes of a PNG image as the src of an img element."""
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"


def embedded_photo(image: np.ndarray) -> str:
    """Returns an image, uint8 (height, width, 3) RGB, as the src of an img element, compressed."""
    jpeg = cv2.imencode(".jpg", image[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1]
    return f"data:image/jpeg;base64,{base64.b64encode(jpeg.tobytes()).decode()}"
