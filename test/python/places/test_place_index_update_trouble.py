# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The index of a map when programs are killed, disks are full, several start at once, and photos are odd."""

import os
import shutil
import signal
import subprocess
import sys

import cv2
import numpy as np
import pytest
from full_disk import full_disk
from made_photos import picture, shifted, written_photos

from sextant.places import place_index_file
from sextant.places.index_params import IndexParams
from sextant.places.place_index_file import CacheError, cache_path, read_cache
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import PlaceLocalizationParams, PlaceLocalizer, Status

SETTINGS, COUNT = IndexParams(), 6
BUILD = """
import os, signal, sys
from pathlib import Path
from sextant.places import place_index_file, place_index_update
from sextant.places.index_params import IndexParams
from sextant.place_maps.place_map_file import read_place_map

def die(*_):
    os.kill(os.getpid(), signal.SIGKILL)

path, killed_at = Path(sys.argv[1]), sys.argv[2]
if killed_at:
    module, name = killed_at.split(".")
    modules = {"place_index_file": place_index_file, "place_index_update": place_index_update}
    setattr(modules[module], name, die)
place_index_update.PlaceIndexer(path, read_place_map(path), IndexParams(), report=print).index()
"""


@pytest.fixture
def place_map(tmp_path):
    return written_photos(tmp_path, COUNT)


def path_of(place_map):
    return place_map.folder / "park.txt"


def index_of(place_map, settings=SETTINGS):
    lines = []
    return PlaceIndexer(path_of(place_map), place_map, settings, report=lines.append).index(), lines


def building(place_map, killed_at=""):
    command = [sys.executable, "-c", BUILD, str(path_of(place_map)), killed_at]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def found(place_map, index, seed, mode="single"):
    localizer = PlaceLocalizer(place_map, index, PlaceLocalizationParams(mode=mode))
    return localizer.localize(shifted(picture(seed), 5, 3))


def names(place_map):
    return {path.name for path in place_map.folder.iterdir()}


# before the first photo is described, and when the cache is half written
@pytest.mark.slow
@pytest.mark.parametrize("killed_at", ["place_index_update.extract_all", "place_index_file._table"])
@pytest.mark.parametrize("is_first", [True, False])
def test_after_a_kill_the_next_start_works(place_map, killed_at, is_first):
    if not is_first:
        index_of(place_map)
        cv2.imwrite(str(place_map.folder / "2.png"), picture(22))
    wanted = names(place_map) | {"park.txt.index"}
    for _ in range(2):  # what the first one left, the second one cleans
        build = building(place_map, killed_at)
        build.communicate(timeout=60)
        assert build.returncode == -signal.SIGKILL
        assert len(names(place_map) - wanted) == (killed_at == "place_index_file._table")
    index, lines = index_of(place_map)
    assert lines[-1].endswith(f"describing {COUNT} photos" if is_first else "1 photos to be described: 2.png")
    assert names(place_map) == wanted
    assert found(place_map, index, 2 if is_first else 22).hypotheses[0].photo.image == "2.png"
    assert index_of(place_map)[1] == []


@pytest.mark.slow
def test_two_that_start_at_once_leave_a_good_cache(place_map):
    for build in [building(place_map) for _ in range(2)]:
        output, _ = build.communicate(timeout=60)
        assert build.returncode == 0, output
    assert index_of(place_map)[1] == []
    assert names(place_map) == {"park.txt", "park.txt.index", *(f"{i}.png" for i in range(COUNT))}


def test_a_cache_that_is_replaced_while_it_is_read_is_not_mixed_up(place_map, monkeypatch):
    good, _ = index_of(place_map)
    cache, other = cache_path(path_of(place_map)), place_map.folder / "other"
    shutil.copy(cache, other)
    other.write_bytes(other.read_bytes().replace(b"SEXTANT", b"ANOTHER")[:5000])

    def replaced(*given, checked=place_index_file._index):
        os.replace(other, cache)
        return checked(*given)

    monkeypatch.setattr(place_index_file, "_index", replaced)
    index = read_cache(cache, SETTINGS)
    assert np.array_equal(index.keypoints[0].codes, good.keypoints[0].codes)
    assert found(place_map, index, 3).hypotheses[0].photo.image == "3.png"


@pytest.mark.slow
def test_no_bit_of_a_cache_can_be_wrong_unseen(place_map):
    index_of(place_map)
    cache = cache_path(path_of(place_map))
    good = cache.read_bytes()
    rng = np.random.default_rng(1)
    ends = [*range(24), *range(len(good) - 32, len(good))]
    for at in [*ends, *rng.integers(0, len(good), 60)]:
        damaged = bytearray(good)
        damaged[at] ^= 1 << rng.integers(8)
        cache.write_bytes(damaged)
        with pytest.raises(CacheError, match=f"^{cache}: "):
            read_cache(cache, SETTINGS)
    for length in [0, 1, 19, 20, 51, 52, len(good) - 1, *rng.integers(0, len(good), 20)]:
        cache.write_bytes(good[:length])
        with pytest.raises(CacheError, match=f"^{cache}: (is truncated|is not a place index)$"):
            read_cache(cache, SETTINGS)


@pytest.mark.slow
@pytest.mark.parametrize("size", [1000, 60_000])  # within the basis, and within the codes
def test_a_full_disk_is_reported_with_the_cache_name(place_map, size):
    with full_disk(size):
        index, lines = index_of(place_map)
    assert (
        lines[1].startswith("the index cannot be cached, every start has to rebuild it: ") and len(lines) == 2
    )
    assert str(cache_path(path_of(place_map))) in lines[1] and "File too large" in lines[1]
    assert found(place_map, index, 3).hypotheses[0].photo.image == "3.png"
    assert len(names(place_map)) == COUNT + 1


def test_a_folder_in_place_of_the_cache_is_reported(place_map):
    cache_path(path_of(place_map)).mkdir()
    index, lines = index_of(place_map)
    assert "Is a directory" in lines[0] and lines[-1].startswith("the index cannot be cached")
    assert found(place_map, index, 3).hypotheses[0].photo.image == "3.png"


def test_photos_that_show_nothing_are_reported_and_the_others_found(place_map):
    cv2.imwrite(str(place_map.folder / "1.png"), np.full((1, 1), 128, np.uint8))
    cv2.imwrite(str(place_map.folder / "4.png"), np.full((240, 320), 128, np.uint8))
    index, lines = index_of(place_map)
    assert lines[1:] == [f"{path_of(place_map)}: 2 photos without a keypoint: 1.png, 4.png"]
    for each in (index, index_of(place_map)[0]):
        assert found(place_map, each, 5).hypotheses[0].photo.image == "5.png"


@pytest.mark.parametrize("is_first", [True, False])
def test_photos_that_show_nothing_at_all_are_refused(place_map, is_first):
    if not is_first:
        index_of(place_map)
    for photo in place_map.photos:
        cv2.imwrite(str(place_map.path(photo)), np.full((1, 1), 128, np.uint8))
    with pytest.raises(ValueError, match="park.txt: no keypoint in any photo of the map"):
        index_of(place_map)


@pytest.mark.slow
def test_photos_of_very_different_sizes_are_found(place_map):
    for seed, size in ((1, (160, 120)), (2, (4000, 3000))):
        image = cv2.resize(picture(seed), size, interpolation=cv2.INTER_AREA)
        cv2.imwrite(str(place_map.folder / f"{seed}.png"), image)
    index, _ = index_of(place_map)
    for seed in range(COUNT):
        assert found(place_map, index, seed).hypotheses[0].photo.image == f"{seed}.png"


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["filter", "sequence", "single", "votes"])
def test_small_maps_work(tmp_path, mode):
    one = written_photos(tmp_path, 1)
    params = IndexParams(matcher="BruteForce" if mode == "votes" else None)
    index, _ = index_of(one, params)
    assert [answer.photo.id for answer in found(one, index, 0, mode).hypotheses] == [0]
    two = written_photos(tmp_path, 2)
    two = two._replace(photos=tuple(photo._replace(x=5.0) for photo in two.photos))
    index, _ = index_of(two, params)
    answer = found(two, index, 1, mode)
    assert answer.hypotheses[0].photo.id == 1
    empty = PlaceLocalizer(two, index, PlaceLocalizationParams(mode=mode)).localize(
        np.zeros((1, 1), np.uint8)
    )
    assert empty.status == Status.UNUSABLE
