# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Place maps of photos whose EXIF has their positions."""

from pathlib import Path

import numpy as np
import pytest
from made_photos import picture
from PIL import Image
from place_map_command import CORNERS, photo, printed

from sextant.place_maps.place_map import GeoCorners, Overview
from sextant.place_maps.place_map_file import read_place_map

LUND = Path(__file__).resolve().parents[4] / "shared" / "data" / "places" / "lund"


@pytest.fixture
def photos(tmp_path):
    """Two photos with coordinates, and one without."""
    folder = tmp_path / "photos"
    photo(folder / "a.jpg", 55.605, 13.01)
    photo(folder / "b.jpg", 55.608, 13.005)
    photo(folder / "c.jpg")
    return folder


def test_photos_are_placed_on_a_sheet_that_is_drawn(photos, capsys):
    left_out, summary = printed(capsys, "exif", photos)
    assert left_out == f"{photos}/c.jpg: its EXIF has no GPS position"
    assert summary == f"{photos}/map.txt: 2 photos of 2 places; 1 left out"
    made = read_place_map(photos / "map.txt")
    assert Image.open(photos / "map.png").size == (made.overview.width, made.overview.height)
    places = [made.georeference.coordinates(made.overview, p.x, p.y) for p in made.photos]
    np.testing.assert_allclose(places, [(55.605, 13.01), (55.608, 13.005)], atol=1e-7)


def test_photos_are_placed_on_an_overview_with_corners(photos, tmp_path, capsys):
    Image.fromarray(picture(2, (400, 200))).save(tmp_path / "park.png")
    printed(capsys, "exif", photos, "--overview", tmp_path / "park.png", *CORNERS)
    made = read_place_map(photos / "map.txt")
    assert made.overview == Overview("park.png", 400, 200)
    assert made.georeference == GeoCorners((55.61, 13.0), (55.6, 13.02))
    assert [(p.image, p.x, p.y) for p in made.photos] == [("a.jpg", 200, 100), ("b.jpg", 100, 40)]
    assert (photos / "park.png").read_bytes() == (tmp_path / "park.png").read_bytes()


def test_corners_of_a_world_file(photos, capsys):
    Image.fromarray(picture(2, (400, 200))).save(photos / "park.png")
    (photos / "park.pgw").write_text("5e-5\n0\n0\n-5e-5\n13.000025\n55.609975\n")
    lines = printed(capsys, "exif", photos, "--overview", photos / "park.png")
    assert "park.png" not in " ".join(lines)  # it is no photo
    assert [(p.x, p.y) for p in read_place_map(photos / "map.txt").photos] == [(200, 100), (100, 40)]


def test_new_photos_are_added(photos, capsys):
    printed(capsys, "exif", photos)
    before = read_place_map(photos / "map.txt")
    photo(photos / "d.jpg", 55.606, 13.006)
    photo(photos / "e.jpg", 56.606, 13.006)
    lines = printed(capsys, "exif", photos, "--add")
    assert lines[-1].endswith("3 photos of 3 places; 2 left out")
    assert not any("a.jpg" in line for line in lines)
    assert any("e.jpg" in line and "outside the overview" in line for line in lines)
    after = read_place_map(photos / "map.txt")
    assert after.photos[:2] == before.photos and after.photos[2].id == 2
    assert after.georeference == before.georeference


@pytest.mark.skipif(not LUND.is_dir(), reason="external test data")
def test_all_photos_of_the_street_are_placed(tmp_path, capsys):
    for path in LUND.glob("*.jpg"):
        (tmp_path / path.name).symlink_to(path)
    (summary,) = printed(capsys, "exif", tmp_path, "-o", tmp_path / "street.txt")
    assert summary.startswith(f"{tmp_path}/street.txt: 29 photos")
