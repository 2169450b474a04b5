# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""HTML template (jinja2) of the report on a marker map; it has no external resources."""

TEMPLATE = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>Marker map</title>
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
tr.highlighted td { background: #fdebdc; }
p.note { color: #555; max-width: 60rem; }
</style>
</head>
<body>
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
<h1>Marker map</h1>
<p class="verdict">{{ verdict }}</p>
{% if findings %}
<h2>Findings</h2>
<ol class="findings">
{%- for finding in findings %}
<li><b>{{ finding.fact }}</b>: <span class="advice">{{ finding.advice }}</span></li>
{%- endfor %}
</ol>
{% endif %}
<h2>Top view</h2>
<p class="note">Lines are markers, squares are horizontal markers; the short stroke is a marker's normal.
Names of markers with findings are bold.</p>
<img alt="the map from above" src="data:image/png;base64,{{ plan }}">
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
<img alt="residuals of every marker" src="data:image/png;base64,{{ residuals }}">
<h2>Noise</h2>
{{ table(cameras) }}
{%- for note in notes %}
<p class="note">{{ note }}</p>
{%- endfor %}
<h2>How the map was made</h2>
{{ table(origin) }}
</body>
</html>
"""
