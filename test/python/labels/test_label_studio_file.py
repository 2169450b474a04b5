# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels in JSON files of Label Studio."""

import copy
import json

import numpy as np
import pytest
from made_labels import write_photos

from sextant.labels.label_studio_file import read_label_studio_file, write_label_studio_file

RESULT = {
    "type": "rectanglelabels", "original_width": 80, "original_height": 60,
    "value": {"x": 25, "y": 50, "width": 50, "height": 10, "rotation": 0, "rectanglelabels": ["ball"]},
}  # fmt: skip
TASK = {"id": 5, "data": {"image": "/data/local-files/?d=0.png"}, "annotations": [{"result": [RESULT]}]}


@pytest.fixture()
def read(tmp_path):
    """Reads tasks from a file beside a photo."""
    write_photos(tmp_path, 1)

    def run(*tasks):
        (tmp_path / "tasks.json").write_text(json.dumps(tasks))
        return read_label_studio_file(tmp_path / "tasks.json")

    return run


def changed(part, **values):
    return {**copy.deepcopy(part), **values}


def with_value(**values):
    return changed(
        TASK, annotations=[{"result": [changed(RESULT, value=changed(RESULT["value"], **values))]}]
    )


def test_percent_are_of_the_photo(read):
    found = read(TASK)
    assert found.classes == ("ball",) and found.photos[0].path.name == "0.png"
    np.testing.assert_allclose(found.photos[0].boxes, [[20, 30, 60, 36]])


def test_a_turned_rectangle_has_a_box_around_it(read):
    """By 90 degrees about its upper left corner, clockwise."""
    (photo,) = read(with_value(rotation=90, width=25, height=10)).photos
    np.testing.assert_allclose(photo.boxes, [[14, 30, 20, 50]], atol=1e-9)


@pytest.mark.parametrize("image", ["0.png", "/data/upload/3/1a2b3c4d-0.png", "/data/local-files/?d=./0.png"])
def test_names_of_photos(read, image):
    assert read(changed(TASK, data={"image": image})).photos[0].path.name == "0.png"


def test_the_newest_annotation_counts_and_unlabelled_tasks_do_not(read):
    empty = changed(TASK, annotations=[{"result": [RESULT]}, {"result": []}])
    cancelled = changed(TASK, annotations=[{"result": [RESULT], "was_cancelled": True}])
    found = read(empty, cancelled, changed(TASK, annotations=[]), TASK)
    assert [len(photo.boxes) for photo in found.photos] == [0, 1]


@pytest.mark.parametrize(
    ("task", "reason"),
    [
        (changed(TASK, data={}), "task 5: has no field 'image'"),
        (changed(TASK, data={"image": "1.png"}), "task 5: there is no photo .*1.png"),
        (changed(TASK, annotations=3), "its annotations must be a list"),
        (with_value(x="a"), "its field 'x' is 'a'"),
        (with_value(width=0), "must not be empty"),
        (with_value(x=90), "leaves the photo"),
        (with_value(rectanglelabels=[]), "must have one label, it has 0"),
        (
            changed(TASK, annotations=[{"result": [changed(RESULT, original_width=81)]}]),
            "labels are for 81 × 60",
        ),
        (7, "task 0: must be a table with the fields data and annotations"),
        (
            changed(TASK, annotations=[{"result": [changed(RESULT, type="polygonlabels")]}]),
            "has polygonlabels",
        ),
        (changed(TASK, data={"image": "left-0.png"}), "there is no photo .*left-0.png"),
    ],
)
def test_wrong_tasks_are_refused(read, task, reason):
    with pytest.raises(ValueError, match=reason):
        read(task)


def test_errors_have_the_line_of_the_task(read, tmp_path):
    with pytest.raises(ValueError, match="tasks.json:1: task 6"):
        read(TASK, changed(TASK, id=6, annotations=3))
    text = (
        "[\n"
        + ",\n".join(json.dumps(each) for each in (TASK, TASK, changed(TASK, id=6, annotations=3)))
        + "]"
    )
    (tmp_path / "tasks.json").write_text(text)
    with pytest.raises(ValueError, match="tasks.json:4: task 6: its annotations must be a list"):
        read_label_studio_file(tmp_path / "tasks.json")


def test_predictions_are_not_labels(tmp_path):
    """They are proposals that a person corrects."""
    photos = write_photos(tmp_path, 3)
    scores = [np.full(len(photo.boxes), 0.625) for photo in photos.photos]
    write_label_studio_file(tmp_path / "tasks.json", photos, scores)
    tasks = json.loads((tmp_path / "tasks.json").read_text())
    assert [len(task["predictions"][0]["result"]) for task in tasks] == [0, 1, 2]
    assert tasks[2]["predictions"][0]["score"] == 0.625
    with pytest.raises(ValueError, match="no task has labels"):
        read_label_studio_file(tmp_path / "tasks.json")
