# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""HTML template (jinja2, sextant.base.html_report) of the report on a marker map."""

TEMPLATE = """\
{% extends "report" %}
{% from "macros" import findings_list, table %}
{% block content %}
<h1>Marker map</h1>
<p class="verdict">{{ verdict }}</p>
{{ findings_list(findings) }}
<h2>Top view</h2>
<p class="note">Lines are markers, squares are horizontal markers; the short stroke is a marker's normal.
Names of markers with findings are bold.</p>
<img alt="the map from above" src="{{ plan }}">
<h2>Markers</h2>
<p class="note">Position and rotation are standard deviations along and about each marker's worst axis,
relative to the markers that define the frame. Observations that are neither used nor left out are in images
that add no information. "Images linking to the frame": the fewest images whose removal would disconnect the
marker from the markers that define the frame.</p>
{{ table(markers) }}
{% if wrong.rows %}
<h2>Entries that were wrong</h2>
<p class="note">Observed minus known position, along the axes of the map.</p>
{{ table(wrong) }}
{% endif %}
<h2>Links</h2>
<p class="note">{{ links_note }}</p>
{{ table(links) }}
<h2>Residuals</h2>
<p class="note">Reprojection error of each observation of a marker; boxes show the quartiles, whiskers 5 and
95 %. A box that stands out is a marker that is bent, loose or of another size than set; many dots above a
box, one that was moved.</p>
<img alt="residuals of every marker" src="{{ residuals }}">
<h2>Noise</h2>
{{ table(cameras) }}
{%- for note in notes %}
<p class="note">{{ note }}</p>
{%- endfor %}
<h2>How the map was made</h2>
{{ table(origin) }}
{% endblock %}
"""
