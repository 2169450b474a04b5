# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pages of labelled photos."""

import base64
import re

import cv2
import numpy as np
from made_labels import write_photos

from sextant.labels.contact_sheet import remarks, write_contact_sheet
from sextant.landmarks.landmark_colours import colour_of_class


def test_a_page_has_all_photos_with_their_boxes(tmp_path):
    photos = write_photos(tmp_path, 4)
    write_contact_sheet(tmp_path / "sheet.html", "hall", photos)
    page = (tmp_path / "sheet.html").read_text()
    assert "4 photos, 6 objects; 1 photos have none" in page and "<h1>hall</h1>" in page
    images = re.findall(r'src="data:image/jpeg;base64,([^"]+)" alt="(\d).png"', page)
    assert [name for _, name in images] == ["0", "1", "2", "3"]
    pixels = cv2.imdecode(np.frombuffer(base64.b64decode(images[3][0]), np.uint8), cv2.IMREAD_COLOR)
    assert pixels.shape == (60, 80, 3)
    photo = photos.photos[3]
    left, top, right, bottom = photo.boxes[1].astype(int)
    colour = 255 * np.array(colour_of_class(photos.classes[photo.classes[1]]))[::-1]
    assert np.abs(pixels[bottom - 1, left + 3 : right - 3] - colour).mean() < 60


def test_labels_that_are_often_wrong_are_pointed_out(tmp_path):
    photos = write_photos(tmp_path, 2)
    _, one = photos.photos
    double = one._replace(boxes=np.repeat(one.boxes, 2, axis=0), classes=np.zeros(2, int))
    tiny = one._replace(boxes=np.array([[5.0, 5, 6.4, 6.4]]), classes=np.zeros(1, int))
    assert remarks(photos._replace(photos=(double, tiny))) == [
        "no photo has a goal", "1.png: two boxes at the same place", "1.png: 1 very small boxes",
    ]  # fmt: skip
