# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map that is made step by step: what is in its file after each."""

import cv2
import numpy as np
import pytest
from made_photos import picture
from PIL import Image

from sextant.place_maps.place_map import GeoCorners, MetricFrame, Photo
from sextant.place_maps.place_map_draft import PlaceMapDraft
from sextant.place_maps.place_map_file import read_place_map, write_place_map

CORNERS = GeoCorners((55.61, 13.00), (55.60, 13.02))


def encoded(seed, size=(64, 48)):
    return cv2.imencode(".png", picture(seed, size))[1].tobytes()


@pytest.fixture
def path(tmp_path):
    (tmp_path / "whole.png").write_bytes(encoded(0, (400, 200)))
    for i in (1, 2):
        (tmp_path / f"{i}.png").write_bytes(encoded(i))
    (tmp_path / "notes.txt").write_text("no photo")
    return tmp_path / "map.txt"


@pytest.fixture
def draft(path):
    draft = PlaceMapDraft(path)
    draft.choose_overview("whole.png")
    return draft


def photos(path):
    return read_place_map(path).photos


def test_it_begins_with_the_overview(path):
    draft = PlaceMapDraft(path)
    assert draft.images() == ["1.png", "2.png", "whole.png"] and draft.place_map is None
    with pytest.raises(ValueError, match="choose the overview first"):
        draft.place("1.png", 1, 1)
    draft.choose_overview("whole.png")
    assert path.read_text() == "whole.png;400;200\n"
    assert draft.images() == ["1.png", "2.png"]
    with pytest.raises(ValueError, match="already has the overview whole.png"):
        draft.choose_overview("1.png")


def test_every_step_is_in_the_file(draft, path):
    draft.place("2.png", 30, 40)
    assert photos(path) == (Photo(0, "2.png", 30, 40),)
    draft.place("1.png", 5, 6)
    draft.place("2.png", 31, 41)
    assert photos(path) == (Photo(0, "2.png", 31, 41), Photo(1, "1.png", 5, 6))
    draft.remove("2.png")
    assert photos(path) == (Photo(1, "1.png", 5, 6),)


def test_every_step_can_be_undone(draft, path):
    draft.place("2.png", 30, 40)
    draft.place("2.png", 31, 41)
    draft.remove("2.png")
    for expected in ((Photo(0, "2.png", 31, 41),), (Photo(0, "2.png", 30, 40),), ()):
        assert draft.can_undo
        draft.undo()
        assert photos(path) == expected
    draft.undo()
    assert photos(path) == () and not draft.can_undo


def test_it_goes_on_where_it_was_left(draft, path):
    write_place_map(path, draft.place_map._replace(photos=(Photo(7, "2.png", 30, 40, 0.5),)))
    again = PlaceMapDraft(path)
    again.place("2.png", 50, 60)
    again.place("1.png", 1, 2)
    assert photos(path) == (Photo(7, "2.png", 50, 60, 0.5), Photo(8, "1.png", 1, 2))


def test_a_georeference_is_kept(path):
    draft = PlaceMapDraft(path, CORNERS)
    draft.choose_overview("whole.png")
    draft.place("1.png", 1, 2)
    assert read_place_map(path).georeference == CORNERS


def test_exif_makes_a_guess(path):
    exif = Image.Exif()
    exif[0x8825] = {1: "N", 2: (55.0, 36.0, 18.0), 3: "E", 4: (13.0, 0.0, 36.0)}  # 55.605, 13.01
    Image.fromarray(np.zeros((48, 64), np.uint8)).save(path.parent / "3.jpg", exif=exif)
    draft = PlaceMapDraft(path, CORNERS)
    assert draft.guess("3.jpg") is None
    draft.choose_overview("whole.png")
    assert draft.guess("3.jpg") == pytest.approx((200, 100))
    assert draft.guess("1.png") is None
    metric = draft.place_map._replace(georeference=MetricFrame("map", 0.1, (0.0, 0.0, 0.0)))
    write_place_map(path, metric)
    assert PlaceMapDraft(path).guess("3.jpg") is None


@pytest.mark.parametrize(
    "image, x, y, reason",
    [
        ("1.png", 401, 1, "x is 401, outside the overview"),
        ("3.png", 1, 1, "3.png: there is no such photo"),
        ("../1.png", 1, 1, "'../1.png' is outside of the map's folder"),
        ("notes.txt", 1, 1, "there is no such photo"),
        ("whole.png", 1, 1, "is the overview"),
    ],
)
def test_what_cannot_be_placed(draft, path, image, x, y, reason):
    before = path.read_text()
    with pytest.raises(ValueError, match=reason):
        draft.place(image, x, y)
    assert path.read_text() == before and not draft.can_undo


def test_a_damaged_photo_is_not_placed(draft, path):
    (path.parent / "1.png").write_bytes(encoded(1)[:200])
    with pytest.raises(ValueError, match="1.png: the image is damaged"):
        draft.place("1.png", 1, 1)


def test_a_photo_that_is_gone_can_be_taken_out(draft, path):
    draft.place("1.png", 1, 1)
    (path.parent / "1.png").unlink()
    assert "1.png" in draft.images()
    draft.remove("1.png")
    assert "1.png" not in draft.images() and photos(path) == ()


def test_images_are_added(draft, path):
    assert draft.add_file("4.png", encoded(4)) == "4.png"
    assert draft.images() == ["1.png", "2.png", "4.png"]
    assert (path.parent / "4.png").read_bytes() == encoded(4)
    draft.add_file("4.png", encoded(4))  # again


@pytest.mark.parametrize(
    "name, content, reason",
    [
        ("5.png", b"text", "5.png: is not an image"),
        ("5.png", encoded(5)[:300], "5.png: the image is damaged"),
        ("5.txt", encoded(5), "'5.txt' is not a valid image name"),
        ("../5.png", encoded(5), "'../5.png' is not a valid image name"),
        ("/5.png", encoded(5), "'/5.png' is not a valid image name"),
        (".5.png", encoded(5), "'.5.png' is not a valid image name"),
        ("5;6.png", encoded(5), "';', line ends and blanks"),
        ("1.png", encoded(5), "1.png: another file has this name"),
    ],
)
def test_what_cannot_be_added(draft, path, name, content, reason):
    before = sorted(path.parent.iterdir())
    with pytest.raises(ValueError, match=reason):
        draft.add_file(name, content)
    assert sorted(path.parent.iterdir()) == before


OTHER = "whole.png;400;200\n3;2.png;7;8\n"  # what another program wrote


@pytest.mark.parametrize("content", [OTHER, "whole.png;400\n", None])
def test_what_another_program_changed_is_not_overwritten(draft, path, content):
    draft.place("1.png", 5, 6)
    path.unlink() if content is None else path.write_text(content)
    steps = (lambda: draft.place("2.png", 1, 1), lambda: draft.remove("1.png"), draft.undo)
    for step in steps:
        with pytest.raises(ValueError, match="map.txt: was changed by another program.* reload the page"):
            step()
        assert (path.read_text() if path.exists() else None) == content
        assert list(draft.placed()) == ["1.png"] and draft.can_undo


def test_a_map_that_appears_meanwhile_is_not_overwritten(path):
    draft = PlaceMapDraft(path)
    path.write_text(OTHER)
    with pytest.raises(ValueError, match="map.txt: was changed by another program"):
        draft.choose_overview("whole.png")
    assert path.read_text() == OTHER


def test_it_goes_on_with_what_another_program_wrote(draft, path):
    draft.place("1.png", 5, 6)
    draft.reload()
    assert draft.can_undo  # nobody else was there
    path.write_text(OTHER)
    draft.reload()
    assert not draft.can_undo
    draft.place("1.png", 50, 60)
    assert photos(path) == (Photo(3, "2.png", 7, 8), Photo(4, "1.png", 50, 60))
    draft.undo()
    assert photos(path) == (Photo(3, "2.png", 7, 8),)


def test_a_file_that_is_no_map_any_more_leaves_the_draft_as_it_was(draft, path):
    draft.place("1.png", 5, 6)
    path.write_text("whole.png;400\n")
    with pytest.raises(ValueError, match="map.txt:1: the first line must be"):
        draft.reload()
    assert list(draft.placed()) == ["1.png"] and draft.can_undo
    path.write_text("whole.png;400;200\n0;1.png;5;6\n")  # as it was
    draft.undo()
    assert photos(path) == ()


def test_a_wrong_map_is_refused(path):
    path.write_text("whole.png;400\n")
    with pytest.raises(ValueError, match="map.txt:1: the first line must be"):
        PlaceMapDraft(path)
    with pytest.raises(NotADirectoryError):
        PlaceMapDraft(path.parent / "nowhere" / "map.txt")


def test_corners_that_the_map_does_not_have_are_refused(path):
    (path.parent / "over.png").write_bytes(encoded(1))
    PlaceMapDraft(path, CORNERS).choose_overview("over.png")
    assert PlaceMapDraft(path, CORNERS).place_map.georeference == CORNERS
    with pytest.raises(ValueError, match="exists with another georeference"):
        PlaceMapDraft(path, GeoCorners((10.0, 10.0), (9.0, 11.0)))
