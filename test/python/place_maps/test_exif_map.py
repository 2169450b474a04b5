# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of photos with coordinates."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sextant.images.photo_file import GeoPosition, find_photos
from sextant.place_maps.exif_map import corners_around, exif_map, positions_of
from sextant.place_maps.place_map import GeoCorners, Overview, Photo, PlaceMap

LUND = Path(__file__).resolve().parents[4] / "shared" / "data" / "places" / "lund"
OVERVIEW = Overview("park.png", 400, 200)
CORNERS = GeoCorners((55.61, 13.00), (55.60, 13.02))


def photo(path, latitude=None, longitude=None):
    exif = Image.Exif()
    if latitude is not None:
        exif[0x8825] = {1: "N", 2: (latitude, 0.0, 0.0), 3: "E", 4: (longitude, 0.0, 0.0), 17: 90.0}
    path.parent.mkdir(exist_ok=True)
    Image.fromarray(np.zeros((8, 8), np.uint8)).save(path, exif=exif)
    return path


def test_photos_are_placed_by_their_exif(tmp_path):
    photo(tmp_path / "b.jpg", 55.605, 13.01)
    photo(tmp_path / "a" / "c.jpg", 55.61, 13.0)
    made, left_out = exif_map(PlaceMap(tmp_path, OVERVIEW, (), CORNERS), find_photos(tmp_path))
    assert [(p.id, p.image) for p in made.photos] == [(0, "a/c.jpg"), (1, "b.jpg")]
    assert [(p.x, p.y) for p in made.photos] == [pytest.approx((0, 0)), pytest.approx((200, 100))]
    assert [p.yaw for p in made.photos] == pytest.approx([0, 0])
    assert left_out == {}
    made.check()


def test_photos_that_cannot_be_placed_are_named(tmp_path):
    nowhere, far = photo(tmp_path / "a.jpg"), photo(tmp_path / "b.jpg", 55.7, 13.01)
    (tmp_path / "c.jpg").write_text("text")
    made, left_out = exif_map(PlaceMap(tmp_path, OVERVIEW, (), CORNERS), find_photos(tmp_path))
    assert made.photos == ()
    reasons = {path.name: reason for path, reason in left_out.items()}
    assert reasons["a.jpg"] == f"{nowhere}: its EXIF has no GPS position"
    assert reasons["b.jpg"].startswith(f"{far}: photo 0: y is -1800, outside the overview")
    assert reasons["c.jpg"] == f"{tmp_path / 'c.jpg'}: is not an image"


def test_ids_go_on_and_photos_of_the_map_stay(tmp_path):
    begun = PlaceMap(tmp_path, OVERVIEW, (Photo(7, "b.jpg", 1, 2),), CORNERS)
    photos = [photo(tmp_path / name, 55.605, 13.01) for name in ("b.jpg", "c.jpg")]
    made, left_out = exif_map(begun, photos)
    assert made.photos == (*begun.photos, Photo(8, "c.jpg", 200, 100, 0))
    assert left_out == {photos[0]: f"{photos[0]}: is already in the map"}


def test_photos_elsewhere_are_refused(tmp_path):
    path = photo(tmp_path / "a.jpg", 55.605, 13.01)
    with pytest.raises(ValueError, match="a.jpg: photos must be in"):
        exif_map(PlaceMap(tmp_path / "map", OVERVIEW, (), CORNERS), [path])


def test_a_map_without_corners_is_refused(tmp_path):
    with pytest.raises(ValueError, match="are unknown"):
        exif_map(PlaceMap(tmp_path, OVERVIEW), [])


def test_corners_leave_a_margin_all_around():
    positions = [GeoPosition(55.6, 13.0), GeoPosition(55.7, 13.2)]
    width, height = corners_around(positions, 50).extent()
    # a degree of latitude is 111.32 km; of longitude less by the cosine of 55.65 degrees
    assert height == pytest.approx(0.1 * 111_320 + 100, rel=1e-3)
    assert width == pytest.approx(0.2 * 111_320 * 0.56425 + 100, rel=1e-3)


def test_no_position_has_no_corners():
    with pytest.raises(ValueError, match="no photo has a GPS position"):
        corners_around([], 10)


@pytest.mark.skipif(not LUND.is_dir(), reason="external test data")
def test_all_street_photos_are_placed():
    photos = find_photos(LUND)
    positions, unknown = positions_of(photos)
    assert unknown == {}
    corners = corners_around(list(positions.values()), 20)
    assert corners.extent() == pytest.approx((56 + 40, 170 + 40), abs=12)
    made, left_out = exif_map(PlaceMap(LUND, Overview("street.png", 1000, 2000), (), corners), photos)
    assert len(made.photos) == 29 and left_out == {}
