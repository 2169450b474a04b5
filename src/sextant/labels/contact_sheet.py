# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A page of small photos with their labels drawn in, to check labels by eye."""

from pathlib import Path
from typing import Dict, List, Optional, Sequence

import cv2
import numpy as np

from sextant.base.html_report import PagePlot, Row, Table, embedded_photo, write_report
from sextant.images.photo_file import read_rgb
from sextant.labels.labelled_photos import LabelledPhoto, LabelledPhotos
from sextant.objects.detection_image import detection_image
from sextant.objects.detections import Detections

SIDE = 320  # longer side of a photo on the page, pixels
SMALL = 0.0005  # fraction of the photo's area, below which a box is pointed out

_TEMPLATE = """{% extends "report" %}
{% from "macros" import gallery, table %}
{% block content %}
<h1>{{ title }}</h1>
<p>{{ summary }}</p>
{{ table(classes) }}
{%- if remarks %}
<h2>Look at these first</h2>
<ul class="findings">
{%- for remark in remarks %}
<li>{{ remark }}</li>
{%- endfor %}
</ul>
{%- endif %}
<h2>Photos</h2>
{{ gallery(photos) }}
{% endblock %}
"""


def write_contact_sheet(
    path: Path, title: str, photos: LabelledPhotos, scores: Optional[Sequence[np.ndarray]] = None
) -> None:
    """Writes an HTML page.

    :param scores: (n,) of the boxes of each photo; None: they are labels of a person
    :raises OSError: a photo cannot be read, or the page cannot be written
    :raises ValueError: a photo cannot be read
    """
    counts = photos.counts()
    rows = [Row((name, str(count))) for name, count in zip(photos.classes, counts)]
    empty = sum(not len(photo.boxes) for photo in photos.photos)
    shown = [
        PagePlot(photo.path.name, _drawn(photo, photos.classes, None if scores is None else scores[i]))
        for i, photo in enumerate(photos.photos)
    ]
    content: Dict[str, object] = {
        "title": title,
        "summary": f"{len(photos.photos)} photos, {counts.sum()} objects; {empty} photos have none",
        "classes": Table(("class", "objects"), rows),
        "remarks": remarks(photos),
        "photos": shown,
    }
    write_report(path, _TEMPLATE, content)


def remarks(photos: LabelledPhotos) -> List[str]:
    """Labels that are often wrong: tiny boxes, one object with two boxes, classes without objects."""
    found = [f"no photo has a {name}" for name, count in zip(photos.classes, photos.counts()) if not count]
    for photo in photos.photos:
        areas = np.prod(photo.boxes[:, 2:] - photo.boxes[:, :2], axis=1) / np.prod(photo.size)
        if np.any(areas < SMALL):
            found.append(f"{photo.path.name}: {np.count_nonzero(areas < SMALL)} very small boxes")
        if len(np.unique(photo.boxes.round(), axis=0)) < len(photo.boxes):
            found.append(f"{photo.path.name}: two boxes at the same place")
    return found


def _drawn(photo: LabelledPhoto, classes: Sequence[str], scores: Optional[np.ndarray]) -> str:
    """The photo with its boxes, as the src of an img element."""
    image = read_rgb(photo.path)
    scale = min(1.0, SIDE / max(photo.size))
    size = tuple(max(1, round(side * scale)) for side in photo.size)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    known = np.ones(len(photo.boxes)) if scores is None else scores
    found = Detections(photo.boxes * scale, known, photo.classes)
    drawn = detection_image(small, found, classes, with_scores=scores is not None)
    return embedded_photo(drawn)
