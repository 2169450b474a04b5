# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tables and the page of evaluations of detectors."""

from pathlib import Path
from typing import List, Sequence, Tuple

import cv2
import numpy as np

from sextant.base.html_report import PagePlot, Row, Table, embedded, embedded_photo, write_report
from sextant.detection_scores.average_precision import recall_and_precision
from sextant.detection_scores.object_evaluation import CONFIDENCES, ObjectEvaluation
from sextant.images.photo_file import read_rgb
from sextant.labels.labelled_photos import LabelledPhotos
from sextant.objects.detection_image import detection_image
from sextant.objects.detections import Detections, Detector

WORST = 24  # photos on the page
SIDE = 260  # longer side of a photo on the page, pixels

_TEMPLATE = """{% extends "report" %}
{% from "macros" import gallery, table %}
{% block content %}
<h1>{{ title }}</h1>
<p class="verdict">{{ verdict }}</p>
{{ table(figures) }}
<p class="note">mAP50: mean over the classes of the area under the precision-recall curve; a box is right if
it overlaps an object of its class by at least 0.5 (intersection over union). mAP50-95: mean over overlaps of
0.5, 0.55, ... 0.95. Recall, precision and false alarms at the confidence. Time: on this machine.</p>
<h2>Classes</h2>
{{ table(classes) }}
<h2>Plots</h2>
{%- for plot in plots %}
<p><img alt="{{ plot.name }}" src="{{ plot.source }}"></p>
{%- endfor %}
<p class="note">Numbers in the reliability diagram: detections. Below the line, scores promise too much.</p>
<h2>Photos with most mistakes of {{ first }}</h2>
<p class="note">Left: labels. Right: detections.</p>
{{ gallery(worst) }}
{% endblock %}
"""


def figure_table(evaluations: Sequence[ObjectEvaluation], false_alarms: float) -> Table:
    """Figures of each detector.

    :param false_alarms: wanted number per photo, for the recommended confidence
    """
    heads = (
        "network", "input", "mAP50", "mAP50-95", "confidence", "recall", "precision",
        "false alarms\nper photo", f"confidence for\n{false_alarms:g} per photo", "recall\nthere",
        "ms, median", "95 %",
    )  # fmt: skip
    return Table(heads, [Row(tuple(_cells(each, false_alarms))) for each in evaluations])


def _cells(each: ObjectEvaluation, false_alarms: float) -> List[str]:
    best = each.recommended(false_alarms)
    figures = [each.score.mean, each.map_50_95, each.confidence, each.matched.recall(each.confidence)]
    figures += [each.matched.precision(each.confidence)]
    figures += [each.matched.false_alarms(each.confidence, each.photos), best]
    figures += [each.matched.recall(best) if np.isfinite(best) else np.nan]
    times = np.percentile(each.milliseconds, [50, 95])
    texts = ["–" if np.isnan(value) else f"{value:.3f}" for value in figures]
    return [each.name, "×".join(map(str, each.size)), *texts, *(f"{value:.1f}" for value in times)]


def class_table(evaluations: Sequence[ObjectEvaluation]) -> Table:
    """AP50, recall and precision of each class, for each detector."""
    heads = ["class", "objects"]
    for each in evaluations:
        heads += [f"{each.name}\n{what}" for what in ("AP50", "recall", "precision")]
    rows = []
    for index, name in enumerate(evaluations[0].classes):
        cells = [name, str(evaluations[0].score.table[index].sum())]
        for each in evaluations:
            cells += ["–" if np.isnan(value) else f"{value:.3f}" for value in _of_class(each, name)]
        rows.append(Row(tuple(cells)))
    return Table(tuple(heads), rows)


def _of_class(each: ObjectEvaluation, name: str) -> Tuple[float, float, float]:
    """AP50, recall and precision of a class; NaN: unknown."""
    if name not in each.classes:
        return np.nan, np.nan, np.nan
    index = each.classes.index(name)
    recall, precision = recall_and_precision(each.score.table)
    return each.score.precision[index], recall[index], precision[index]


def verdict(evaluations: Sequence[ObjectEvaluation], false_alarms: float) -> str:
    """The recommended network and confidence, in words: that with the highest recall at its confidence."""
    few = [each for each in evaluations if np.isfinite(each.recommended(false_alarms))]
    if not few:
        who = evaluations[0].name if len(evaluations) == 1 else "Each network"
        most = f"more than {false_alarms:g} false alarms per photo"
        return f"{who} has {most} at all confidences up to {CONFIDENCES[-1]:g}."
    best = max(few, key=lambda each: np.nan_to_num(each.matched.recall(each.recommended(false_alarms))))
    confidence = best.recommended(false_alarms)
    recall = best.matched.recall(confidence)
    finds = "" if np.isnan(recall) else f"finds {recall:.1%} of the objects, with at most "
    what = finds or "has at most "
    return f"{best.name} with confidence {confidence:.2f} {what}{false_alarms:g} false alarms per photo."


def write_evaluation_page(
    path: Path,
    title: str,
    photos: LabelledPhotos,
    evaluations: Sequence[ObjectEvaluation],
    detector: Detector,
    plots: Sequence[Path],
    false_alarms: float,
) -> None:
    """Writes the page.

    :param detector: of the first evaluation, for the photos with most mistakes
    :param plots: PNG files, which are embedded
    :raises OSError: the page cannot be written, or a file cannot be read
    """
    first = evaluations[0]
    content = {
        "title": title,
        "verdict": verdict(evaluations, false_alarms),
        "figures": figure_table(evaluations, false_alarms),
        "classes": class_table(evaluations),
        "plots": [PagePlot(plot.stem, embedded(plot.read_bytes())) for plot in plots],
        "first": first.name,
        "worst": [_worst_photo(photos, index, detector, first.confidence) for index in first.worst[:WORST]],
    }
    write_report(path, _TEMPLATE, content)


def _worst_photo(photos: LabelledPhotos, index: int, detector: Detector, confidence: float) -> PagePlot:
    photo = photos.photos[index]
    image = read_rgb(photo.path)
    found = detector.detect(image)
    found = found.of(found.scores >= confidence)
    labels = Detections(photo.boxes, np.ones(len(photo.boxes)), photo.classes)
    scale = min(2.0, SIDE / max(photo.size))
    size = tuple(max(1, round(side * scale)) for side in photo.size)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    drawn = [
        detection_image(small, each._replace(boxes=each.boxes * scale), photos.classes, with_scores)
        for each, with_scores in ((labels, False), (found, True))
    ]
    both = np.hstack([drawn[0], np.full((size[1], 6, 3), 255, np.uint8), drawn[1]])
    return PagePlot(photo.path.name, embedded_photo(both))
