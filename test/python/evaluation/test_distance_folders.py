# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sextant.evaluation.distance_folders import distance_bags


def made(folder, *names):
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(b"")
    return folder


def test_bags_by_distance(tmp_path):
    made(tmp_path, "2/a.bag", "0.757/b.bag", "0.757/a.bag", "0.757/notes.txt", ".git/x.bag", "README")
    found = distance_bags(tmp_path)
    names = [(each.distance, each.path[len(str(tmp_path)) + 1 :]) for each in found.bags]
    assert names == [(0.757, "0.757/a.bag"), (0.757, "0.757/b.bag"), (2.0, "2/a.bag")]
    assert found.problems == []


def test_what_is_no_distance_is_reported(tmp_path):
    made(tmp_path, "1.0/a.bag", "near/a.bag", "2.0/notes.txt", "lost.bag", "1000/a.bag")
    problems = distance_bags(tmp_path).problems
    assert len(problems) == 4
    for reason in ("'near': its name is not a distance", "'2.0': there is no bag", "lost.bag: is not in"):
        assert sum(reason in problem for problem in problems) == 1
    assert sum("folder '1000': more than 100 m" in problem for problem in problems) == 1


def test_angles_are_limited_by_half_a_turn(tmp_path):
    made(tmp_path, "1.5/a.bag", "90/a.bag")
    assert "is it in rad" in distance_bags(tmp_path, "yaw").problems[0]


def test_nothing_to_read(tmp_path):
    with pytest.raises(ValueError, match="no such folder"):
        distance_bags(tmp_path / "absent")
    with pytest.raises(ValueError, match="it has no folders"):
        distance_bags(tmp_path)
    with pytest.raises(ValueError, match="folder 'near': its name is not a distance"):
        distance_bags(made(tmp_path, "near/a.bag"))


def test_what_else_lies_beside_bags(tmp_path):
    made(tmp_path, "1/a.bag", "1/a.orig.bag", "1/._b.bag", "1/B.BAG", "1/lost.orig.bag", "1/c.bag.active")
    made(tmp_path, "1/more/d.bag", "1/pictures/1.png")
    found = distance_bags(tmp_path)
    assert [each.path.rpartition("/")[2] for each in found.bags] == ["B.BAG", "a.bag", "lost.orig.bag"]
    assert len(found.problems) == 2
    assert any("c.bag.active: the recording was not finished" in each for each in found.problems)
    assert any("more: folders in a folder of bags" in each for each in found.problems)
