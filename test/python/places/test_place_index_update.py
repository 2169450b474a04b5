# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The index of a map: found again, brought up to date, and built anew where its cache cannot be used."""

import os
import shutil

import cv2
import numpy as np
import pytest
from made_photos import picture, shifted, written_photos

import sextant
from sextant.places.index_params import IndexParams, content_digest, default_features, plain_features
from sextant.places.photo_features import KeypointExtractor
from sextant.places.place_index import SEARCHED
from sextant.places.place_index_file import VERSION, CacheError, cache_path, read_cache
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_scores import photo_scores
from sextant.places.place_votes import count_votes

SETTINGS = IndexParams()


@pytest.fixture
def place_map(tmp_path):
    return written_photos(tmp_path, 6)


def index_of(place_map, settings=SETTINGS, **more):
    lines = []
    path = place_map.folder / "park.txt"
    return PlaceIndexer(path, place_map, settings, report=lines.append, **more).index(), lines


def image_of(index, seed):
    """The photo that is found for a picture: by votes, or by comparison with each."""
    keypoints = KeypointExtractor(index.params).extract(shifted(picture(seed), 5, 3))
    if index.params.matcher is None:
        scores = photo_scores(index, np.arange(len(index.photos)), index.encode(keypoints))
        return index.photos[scores.logs.argmax()].image
    distances, image_ids, _ = index.descriptors.search(keypoints[0].descriptors, 2)
    image_id = count_votes(distances, image_ids, 1, 1)[0][0]
    return next(photo.image for photo in index.photos if photo.image_id == image_id)


def is_same(one, other):
    """Whether two indices have the same photos and features."""
    kinds = zip(one.keypoints, other.keypoints)
    return (
        one.photos == other.photos
        and np.array_equal(one.compared.scores, other.compared.scores, equal_nan=True)
        and all(
            np.array_equal(a.codes, b.codes) and np.array_equal(a.positions, b.positions) for a, b in kinds
        )
    )


def cache_of(place_map):
    return cache_path(place_map.folder / "park.txt")


def test_a_second_start_describes_nothing(place_map):
    first, lines = index_of(place_map)
    assert lines == [f"{place_map.folder / 'park.txt'}: describing 6 photos"]
    second, lines = index_of(place_map)
    assert lines == []
    assert is_same(second, first)


@pytest.mark.slow
@pytest.mark.skipif(not sextant.has_faiss(), reason="built without faiss")
def test_a_large_map_is_searched_for_candidates(place_map, monkeypatch):
    monkeypatch.setattr("sextant.places.place_index.EXHAUSTIVE", 5)
    monkeypatch.setattr("sextant.places.place_scores.CANDIDATES", 2)
    index_of(place_map)
    index, lines = index_of(place_map)
    assert lines == [] and len(index.descriptors) == np.minimum(index.keypoints[0].counts, SEARCHED).sum()
    assert [image_of(index, seed) for seed in range(6)] == [f"{seed}.png" for seed in range(6)]
    few = place_map._replace(photos=place_map.photos[:5])
    index, lines = index_of(few)
    assert index.descriptors is None and lines[-1].endswith("describing 5 photos")


@pytest.mark.slow
def test_photos_come_and_go_without_a_rebuild(place_map):
    index_of(place_map)
    changed = written_photos(place_map.folder, 6, first=2)
    index, lines = index_of(changed)
    path = place_map.folder / "park.txt"
    assert lines == [
        f"{path}: 2 photos removed or changed: 0.png, 1.png",
        f"{path}: 2 photos to be described: 6.png, 7.png",
    ]
    for each in (index, index_of(changed)[0]):
        assert [image_of(each, seed) for seed in range(2, 8)] == [f"{seed}.png" for seed in range(2, 8)]
        (kind,) = each.keypoints
        assert len(kind.codes) == sum(photo.count for photo in each.photos) == len(kind.positions)


def test_a_photo_that_is_replaced_is_described_again(place_map):
    index_of(place_map)
    old = os.stat(place_map.folder / "3.png")
    cv2.imwrite(str(place_map.folder / "3.png"), picture(33))
    os.utime(place_map.folder / "3.png", ns=(old.st_atime_ns, old.st_mtime_ns))
    index, lines = index_of(place_map)
    assert [line.split(": ", 1)[1] for line in lines] == [
        "1 photos removed or changed: 3.png",
        "1 photos to be described: 3.png",
    ]
    assert image_of(index, 33) == "3.png"


def test_a_copied_map_takes_its_index_along(place_map, tmp_path_factory):
    index_of(place_map)
    folder = shutil.copytree(place_map.folder, tmp_path_factory.mktemp("copy") / "park")
    assert index_of(place_map._replace(folder=folder))[1] == []


@pytest.fixture
def read(monkeypatch):
    """Contents that were compared."""
    read = []

    def counted(content):
        read.append(content)
        return content_digest(content)

    monkeypatch.setattr("sextant.places.place_index_update.content_digest", counted)
    return read


def touched(place_map, *seeds):
    for seed in seeds:
        os.utime(place_map.folder / f"{seed}.png", (0, 0))


@pytest.mark.slow
def test_only_the_first_start_of_a_copied_map_reads_its_photos(place_map, read):
    first, _ = index_of(place_map)
    touched(place_map, 1, 4)
    for expected in (2, 0):
        read.clear()
        index, lines = index_of(place_map)
        assert (lines, len(read)) == ([], expected)
        assert [image_of(index, seed) for seed in range(6)] == [f"{seed}.png" for seed in range(6)]
        assert np.array_equal(index.keypoints[0].codes, first.keypoints[0].codes)
    touched(place_map, 1)
    cv2.imwrite(str(place_map.folder / "3.png"), picture(33))
    for expected, number_of_lines in ((2, 2), (0, 0)):
        read.clear()
        index, lines = index_of(place_map)
        assert (len(lines), len(read)) == (number_of_lines, expected)
        assert image_of(index, 33) == "3.png" and image_of(index, 1) == "1.png"


def test_a_copied_map_in_a_folder_that_cannot_be_written_to_is_used(place_map, read, monkeypatch):
    index_of(place_map)
    touched(place_map, *range(6))
    refuse_to_write(monkeypatch)
    for _ in range(2):
        read.clear()
        index, lines = index_of(place_map)
        assert len(read) == 6 and image_of(index, 1) == "1.png"
        (line,) = lines
        assert line.startswith("the index cannot be cached, every start has to rebuild it: ")


@pytest.mark.slow
def test_many_more_photos_make_an_index_anew(place_map):
    index_of(place_map)
    many = written_photos(place_map.folder, 25)
    assert index_of(many)[1] == [f"{place_map.folder / 'park.txt'}: describing 25 photos"]


@pytest.mark.slow
def test_other_settings_are_another_index(place_map):
    index_of(place_map)
    other = IndexParams({**default_features(), "support_scale": 1.5})
    _, lines = index_of(place_map, other)
    assert lines[0] == f"{cache_of(place_map)}: has other parameters; the index is rebuilt"
    assert index_of(place_map, other)[1] == []


def cut(path):
    path.write_bytes(path.read_bytes()[:-100])


def empty(path):
    path.write_bytes(b"")


def flipped(at):
    def flip(path):
        content = bytearray(path.read_bytes())
        content[at] ^= 4
        path.write_bytes(content)

    return flip


def aged(path):
    content = bytearray(path.read_bytes())
    content[16] = VERSION + 1
    path.write_bytes(content)


@pytest.mark.slow
@pytest.mark.parametrize(
    "damage, reason",
    [
        (cut, "is truncated"),
        (empty, "is not a place index"),
        (flipped(0), "is not a place index"),
        (flipped(100), "its part 'compared' is damaged"),
        (flipped(-5000), "its part 'codes0' is damaged"),
        (flipped(-100), "its table is damaged"),
        (aged, f"has version {VERSION + 1}, expected {VERSION}"),
    ],
)
def test_a_cache_that_cannot_be_used_is_made_anew(place_map, damage, reason):
    good, _ = index_of(place_map)
    damage(cache_of(place_map))
    with pytest.raises(CacheError, match=reason):
        read_cache(cache_of(place_map), SETTINGS)
    index, lines = index_of(place_map)
    assert lines[0] == f"{cache_of(place_map)}: {reason}; the index is rebuilt"
    assert is_same(index, good)
    assert index_of(place_map)[1] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "left, reason",
    [
        (None, "park.txt: missing photos: 3.png"),
        (3, "3.png: is not an image"),
        (2000, "3.png: the image is damaged"),
    ],
)
def test_a_photo_that_cannot_be_used_is_named(place_map, left, reason):
    index_of(place_map)
    path = place_map.folder / "3.png"
    content = path.read_bytes()
    path.unlink() if left is None else path.write_bytes(content[:left])
    with pytest.raises(ValueError, match=reason):
        index_of(place_map)


def test_a_photo_with_more_keypoints_than_an_index_takes_is_named(place_map, monkeypatch):
    monkeypatch.setattr("sextant.places.photo_features.MAX_KEYPOINTS", 9)
    with pytest.raises(ValueError, match="0.png: .* keypoints, allowed are 9; set max_features"):
        index_of(place_map)


def refuse_to_write(monkeypatch):
    def refuse(path, index):
        raise PermissionError(13, "cannot be written", str(path))

    monkeypatch.setattr("sextant.places.place_index_update.write_cache", refuse)


@pytest.mark.slow
@pytest.mark.parametrize(
    "detector, extractor, matcher",
    [
        ("SIFT", "SIFT", "FlannBased"),
        ("SIFT", "SIFT", "BruteForce-L1"),
        ("SURF", "SURF", "faiss"),
        ("ORB", "ORB", "faiss"),
        ("ORB", "ORB", "BruteForce-Hamming"),
        ("AKAZE", "AKAZE", "faiss"),
        ("SIFT", "ORB", "BruteForce-Hamming"),
        ("ORB", "SIFT", "BruteForce"),
        ("AKAZE", "SURF", "FlannBased"),
        ("SURF", "SIFT", "faiss"),
    ],
)
def test_any_pair_finds_photos(place_map, detector, extractor, matcher):
    settings = IndexParams(plain_features(detector, extractor), matcher)
    for described in (["describing"], []):  # built, then as stored
        index, lines = index_of(place_map, settings)
        assert [line.split()[1] for line in lines] == described
        assert [image_of(index, seed) for seed in range(6)] == [f"{seed}.png" for seed in range(6)]


def test_a_large_map_without_faiss_is_reported(place_map, monkeypatch):
    monkeypatch.setattr(sextant, "has_faiss", lambda: False)
    for settings, limit in ((IndexParams(), "EXHAUSTIVE"), (IndexParams(matcher="faiss"), "MANY")):
        for many, reported in ((5, True), (100_000, False)):
            monkeypatch.setattr(f"sextant.places.place_index_update.{limit}", many)
            _, lines = index_of(place_map, settings)
            assert any("built without faiss" in line for line in lines) == reported
    _, lines = index_of(place_map, IndexParams(matcher="FlannBased"))
    assert not any("built without" in line for line in lines)


def test_an_invalid_pair_is_refused_before_anything_is_read(place_map):
    with pytest.raises(ValueError, match="extractor AKAZE needs detector AKAZE"):
        index_of(place_map, IndexParams(plain_features("SIFT", "AKAZE")))
    with pytest.raises(ValueError, match="matcher is 'FlannBased', for extractor ORB it must be one of"):
        index_of(place_map, IndexParams(plain_features("ORB", "ORB"), "FlannBased"))
    with pytest.raises(ValueError, match="^max_sides: unknown parameter; did you mean max_side"):
        index_of(place_map, IndexParams({"max_sides": 3}))


def test_an_empty_map_is_refused(place_map):
    with pytest.raises(ValueError, match="park.txt: the map has no photos"):
        index_of(place_map._replace(photos=()))
