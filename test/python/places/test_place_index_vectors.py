# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The index of a map with a global descriptor: a vector of every photo, kept in line with the photos."""

import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest
from made_network import pooling_network, projection_network
from made_photos import picture, written_photos

from sextant.places.global_descriptor import GlobalDescriptor, GlobalDescriptorParams
from sextant.places.index_params import IndexParams, default_features
from sextant.places.photo_features import photo_features
from sextant.places.place_index_file import CacheError, cache_path, read_cache
from sextant.places.place_index_update import PlaceIndexer


@pytest.fixture
def place_map(tmp_path):
    return written_photos(tmp_path, 5)


@pytest.fixture
def settings(tmp_path):
    model = pooling_network(tmp_path / "net.onnx")
    return IndexParams(global_descriptor=GlobalDescriptorParams(model, std=[1.0, 1.0, 1.0]))


def index_of(place_map, settings, **more):
    lines = []
    path = place_map.folder / "park.txt"
    return PlaceIndexer(path, place_map, settings, report=lines.append, **more).index(), lines


def vectors_of(settings, seeds):
    descriptor = GlobalDescriptor(settings.global_descriptor)
    return np.array([descriptor.describe(picture(seed)) for seed in seeds])


def test_every_photo_has_its_vector(place_map, settings):
    index, _ = index_of(place_map, settings)
    assert index.vectors.dtype == np.float32
    assert np.array_equal(index.vectors, vectors_of(settings, range(5)))


def test_a_second_start_maps_them_from_the_cache(place_map, settings):
    first, _ = index_of(place_map, settings)
    second, lines = index_of(place_map, settings)
    assert lines == [] and second.params == settings
    assert isinstance(second.vectors, np.memmap) and second.vectors.flags.aligned
    assert np.array_equal(second.vectors, first.vectors)


def test_they_come_and_go_with_the_photos(place_map, settings):
    index_of(place_map, settings)
    changed = written_photos(place_map.folder, 5, first=2)
    for _ in range(2):  # brought up to date, then as stored
        index, lines = index_of(changed, settings)
        order = [int(photo.image.split(".")[0]) for photo in index.photos]
        assert sorted(order) == list(range(2, 7))
        assert np.array_equal(index.vectors, vectors_of(settings, order))
    assert lines == []


@pytest.mark.slow
def test_several_processes_make_the_same(place_map, settings):
    one, _ = index_of(place_map, settings)
    cache_path(place_map.folder / "park.txt").unlink()
    two, _ = index_of(place_map, settings, jobs=2)
    assert np.array_equal(two.vectors, one.vectors)
    assert np.array_equal(two.keypoints[0].codes, one.keypoints[0].codes)
    assert two.photos == one.photos


def test_another_network_under_the_same_name_is_another_index(place_map, settings):
    index_of(place_map, settings)
    pooling_network(place_map.folder / "net.onnx", size=(64, 64))
    index, lines = index_of(place_map, settings)
    assert lines[0].endswith("park.txt.index: has other parameters; the index is rebuilt")
    assert np.array_equal(index.vectors, vectors_of(settings, range(5)))


def test_the_same_network_elsewhere_or_run_by_another_is_the_same_index(place_map, settings):
    index_of(place_map, settings)
    elsewhere = shutil.copy(settings.global_descriptor.model, place_map.folder / "other.onnx")
    moved = replace(settings.global_descriptor, model=str(elsewhere), backend="opencv")
    assert index_of(place_map, replace(settings, global_descriptor=moved))[1] == []


def test_with_and_without_are_two_indices(place_map, settings):
    index_of(place_map, IndexParams())
    assert len(index_of(place_map, settings)[1]) == 2
    index, lines = index_of(place_map, IndexParams())
    assert len(lines) == 2 and index.vectors.shape == (5, 0)


def test_a_flipped_bit_is_noticed(place_map, settings):
    index_of(place_map, settings)
    path = cache_path(place_map.folder / "park.txt")
    content = bytearray(path.read_bytes())
    content[100] ^= 4
    path.write_bytes(content)
    with pytest.raises(CacheError, match="its part 'vectors' is damaged"):
        read_cache(path, settings)
    assert np.array_equal(index_of(place_map, settings)[0].vectors, vectors_of(settings, range(5)))


def test_a_network_that_cannot_be_used_is_refused_before_any_photo_is_read(place_map, settings):
    (place_map.folder / "net.onnx").write_bytes(b"no network")
    with pytest.raises(ValueError, match="net.onnx: is no ONNX file"):
        index_of(place_map, settings)
    (place_map.folder / "net.onnx").unlink()
    with pytest.raises(FileNotFoundError, match="net.onnx"):
        index_of(place_map, settings)


def test_networks_see_colours_that_are_one_grey(tmp_path):
    model = projection_network(tmp_path / "net.onnx", np.eye(3, dtype=np.float32))
    shown = GlobalDescriptorParams(model, width=32, height=32, mean=[0, 0, 0], std=[1, 1, 1])
    path = tmp_path / "red.png"
    cv2.imwrite(str(path), np.full((48, 64, 3), (0, 0, 255), np.uint8))  # BGR
    vector = photo_features(IndexParams(global_descriptor=shown), path).vector
    assert vector == pytest.approx([1, 0, 0], abs=1e-6)


def test_a_large_photo_is_read_as_large_as_the_network_wants_it(tmp_path):
    path = tmp_path / "large.jpg"
    cv2.imwrite(str(path), cv2.resize(picture(1), (2048, 1536)))
    shown = GlobalDescriptorParams(pooling_network(tmp_path / "net.onnx", (1024, 768)), backend="opencv")
    small = IndexParams({**default_features(), "max_side": 256}, global_descriptor=shown)
    found = photo_features(small, path)
    whole = GlobalDescriptor(shown).describe(cv2.imread(str(path)))
    assert found.vector == pytest.approx(whole, abs=1e-3)
