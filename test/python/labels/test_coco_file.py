# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels in JSON files of COCO."""

import copy
import json

import pytest
from made_labels import write_photos

from sextant.labels.coco_file import read_coco_file

TABLE = {
    "images": [{"id": 7, "file_name": "0.png", "width": 80, "height": 60}],
    "annotations": [{"id": 3, "image_id": 7, "category_id": 2, "bbox": [10, 20, 30, 15.5]}],
    "categories": [{"id": 2, "name": "goal"}, {"id": 9, "name": "ball"}],
}


@pytest.fixture()
def read(tmp_path):
    """Reads a table, or text, from a file beside a photo."""
    write_photos(tmp_path / "images", 1)

    def run(table):
        path = tmp_path / "labels.json"
        path.write_text(table if isinstance(table, str) else json.dumps(table))
        return read_coco_file(path)

    return run


def test_boxes_are_left_top_width_and_height(read):
    found = read(TABLE)
    assert found.classes == ("goal", "ball")
    assert found.photos[0].boxes.tolist() == [[10, 20, 40, 35.5]] and found.photos[0].classes.tolist() == [0]


def changed(*keys, to):
    """TABLE with one value replaced; to None: removed."""
    table = copy.deepcopy(TABLE)
    place = table
    for key in keys[:-1]:
        place = place[key]
    if to is None:
        del place[keys[-1]]
    else:
        place[keys[-1]] = to
    return table


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ('{"images": [\n  }', "labels.json:2: is not JSON"),
        ("[" * 100000, "labels.json: is nested too deeply|labels.json:1: is not JSON"),
        ("7", "labels.json: has no field 'categories'"),
        (changed("images", to=None), "has no field 'images'"),
        (changed("images", to={}), "its field 'images' is '{}', it must be of type list"),
        (changed("images", 0, "id", to=True), "image 0: its field 'id' is 'True', it must be of type int"),
        (changed("images", 0, "file_name", to="1.png"), "image 0: there is no file .*1.png"),
        (
            changed("images", 0, "width", to=81),
            "image 0: 0.png has 81 × 60 pixels here, but 80 × 60 in its file",
        ),
        (changed("images", to=TABLE["images"] * 2), "image 1: its id 7 is there twice"),
        (changed("annotations", 0, "image_id", to=8), "annotation 3: there is no image 8"),
        (changed("annotations", 0, "category_id", to=1), "annotation 3: there is no category 1"),
        (changed("annotations", 0, "iscrowd", to=1), r"annotation 3: is of a crowd \(iscrowd\)"),
        (changed("annotations", 0, "bbox", to=[1, 2, 3]), "annotation 3: its bbox must be four numbers"),
        (changed("annotations", 0, "bbox", to=[1, 2, 3, "4"]), "its bbox must be four numbers"),
        (changed("annotations", 0, "bbox", to=[1, 2, 0, 4]), "annotation 3: its box has 0 × 4 pixels"),
        (changed("annotations", 0, "bbox", to=[60, 2, 30, 4]), "leaves the photo"),
        (changed("categories", to=[]), "at least one"),
        (changed("images", to=[]), "there are no images in it"),
        (changed("categories", 1, "id", to=2), "categories: an id is there twice"),
        (changed("categories", 1, "name", to="goal"), "goal is there twice"),
    ],
)
def test_wrong_files_are_refused(read, table, reason):
    with pytest.raises(ValueError, match=reason):
        read(table)


def test_errors_have_the_line_of_the_item(read):
    table = changed("annotations", to=[*TABLE["annotations"], {**TABLE["annotations"][0], "category_id": 5}])
    lines = json.dumps(table, indent=1).splitlines()
    line = max(number for number, text in enumerate(lines, 1) if text == "  {" and number < len(lines) - 14)
    assert "category_id" in "".join(lines[line : line + 4])
    with pytest.raises(ValueError, match=rf"labels.json:{line}: annotation 3: there is no category 5"):
        read("\n".join(lines))
    with pytest.raises(ValueError, match="labels.json:1: annotation 3"):
        read(table)
