# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of clusters of another map's places."""

import pytest
from made_photos import written_photos
from place_map_command import printed, refused

from sextant.place_maps.place_map import MetricFrame
from sextant.place_maps.place_map_file import read_place_map, write_place_map


@pytest.fixture
def park(tmp_path):
    """Eight places 10 pixels apart, without files of their photos."""
    made = written_photos(tmp_path, 0)
    line = "{0};{0}.png;{1};50\n".format
    (tmp_path / "park.txt").write_text(
        "park.png;1000;100\n" + "".join(line(i, 10 * i + 300 * (i > 4)) for i in range(8))
    )
    return made.folder


def test_a_map_of_so_many_parts_shares_the_photos(park, capsys):
    (summary,) = printed(capsys, "clusters", park / "park.txt", "-o", park / "parts.txt", "--count", 2)
    assert summary == f"{park}/parts.txt: 8 photos of 2 places"
    made = read_place_map(park / "parts.txt")
    assert [photo.x for photo in made.photos] == [20.0] * 5 + [360.0] * 3
    assert [photo.image for photo in made.photos] == [f"{i}.png" for i in range(8)]


def test_the_size_is_in_metres_where_the_map_has_a_scale(park, capsys):
    metric = read_place_map(park / "park.txt")._replace(georeference=MetricFrame("map", 0.1, (0, 0, 0)))
    write_place_map(park / "metric.txt", metric)
    for size, places in ((0.9, 8), (4.0, 2), (100, 1)):
        printed(capsys, "clusters", park / "metric.txt", "-o", park / "a.txt", "--size", size, "--force")
        assert len(read_place_map(park / "a.txt").places()) == places


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--count", "9"], "8 places cannot be divided into 9 clusters"),
        (["--size", "-1"], "size of a cluster is -1"),
        ([], "one of the arguments --count --size is required"),
        (["--count", "2", "--size", "2"], "not allowed with"),
    ],
)
def test_what_cannot_be_divided_is_refused(park, capsys, arguments, reason):
    assert reason in refused(capsys, park, "clusters", park / "park.txt", "-o", park / "b.txt", *arguments)


def test_the_map_stays_beside_the_photos_and_others_are_kept(park, capsys, tmp_path_factory):
    away = tmp_path_factory.mktemp("away")
    call = ["clusters", park / "park.txt", "--count", 2, "-o"]
    assert "the folder of its photos" in refused(capsys, park, *call, away / "b.txt")
    assert "already exists" in refused(capsys, park, *call, park / "park.txt")
    (park / "none.txt").write_text("park.png;1000;100\n")
    assert "has no photos" in refused(
        capsys, park, "clusters", park / "none.txt", "--count", 1, "-o", park / "b.txt"
    )
