# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re

import numpy as np
import pytest

from sextant.evaluation.surveyed_points import SurveyedPoints, point_bags, read_points, write_points

HEADER = "bag,x,y,z,yaw\n"


@pytest.fixture
def table(tmp_path):
    def written(text):
        path = tmp_path / "points.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return written


def test_columns_in_any_order_with_blanks_and_a_byte_order_mark(table):
    points = read_points(table("\ufeffyaw, z,bag,y,x\n1.5, 0.2,a.bag,-1,2\n\nunknown,0,b,0,unknown\n"))
    assert [point.bag for point in points] == ["a.bag", "b"]
    truth = SurveyedPoints(points, {"roll": 0.0})
    np.testing.assert_array_equal(truth.at(1.0), [2.0, -1.0, 0.2, 0.0, np.nan, 1.5])
    np.testing.assert_array_equal(truth.at(2.0), [np.nan, 0.0, 0.0, 0.0, np.nan, np.nan])
    assert points[1].where.endswith("points.csv:4")


@pytest.mark.parametrize(
    "text, reason",
    [
        ("", "points.csv:1: no column 'bag'"),
        (
            "bag;x;y;z;yaw\n",
            "points.csv:1: no column 'bag'.*unknown column 'bag;x;y;z;yaw'; the first",
        ),
        ("bag,x,y,z,heading\n", "no column 'yaw'; unknown column 'heading'; the first line must be"),
        ("bag,x,y,z,yaw,x\n", "points.csv:1: two columns 'x'"),
        (HEADER, "points.csv:2: there is no point"),
        (HEADER + "a.bag,0,0,0\n", "points.csv:2: 4 values, there must be 5"),
        (
            HEADER + "a,0,0,0,0\nb,0,1,0,0,0\n",
            "points.csv:3: 6 values, there must be 5; write decimals",
        ),
        (HEADER + ",0,0,0,0\n", "points.csv:2: the bag is missing; name the bag"),
        (HEADER + "a.bag,left,0,0,0\n", "points.csv:2: x is 'left', not a number; write m, or unknown"),
        (HEADER + "a.bag,0,,0,0\n", "points.csv:2: y is '', not a number"),
        (HEADER + "a.bag,0,nan,0,0\n", "points.csv:2: y is nan, allowed is at most 10000 m"),
        (
            HEADER + "a.bag,0,0,0,90\n",
            "points.csv:2: yaw is 90, allowed is at most 6.28319 rad; is it in",
        ),
        (HEADER.encode() + b"\xff.bag,0,0,0,0\n", "points.csv: is not UTF-8 text"),
    ],
)
def test_a_wrong_table_is_refused_with_line_and_advice(table, text, reason):
    with pytest.raises(ValueError, match=reason):
        read_points(table(text))


def test_bags_and_folders_of_points(table, tmp_path):
    for name in ("a.bag", "b/2.bag", "b/1.bag", "c.bag", "notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "empty").mkdir()
    rows = ["a.bag", "b", "absent.bag", "./a.bag", "empty", "notes.txt", "c.bag"]
    points = read_points(table(HEADER + "".join(f"{name},0,0,0,0\n" for name in rows)))
    found = point_bags(points, tmp_path)
    names = [(number, path[len(str(tmp_path)) + 1 :]) for number, path in found.bags]
    assert names == [(1.0, "a.bag"), (2.0, "b/1.bag"), (2.0, "b/2.bag"), (7.0, "c.bag")]
    reasons = ["points.csv:4: there is no bag .*absent.bag; correct the name, or record it"]
    reasons += [r"points.csv:5: .*a.bag is also the bag of .*points.csv:2; name"]
    reasons += [
        "points.csv:6: folder 'empty': there is no bag",
        "points.csv:7: .*notes.txt is not a bag",
    ]
    assert len(found.problems) == len(reasons)
    for problem, reason in zip(found.problems, reasons):
        assert re.search(reason, problem)


def test_what_is_written_is_read(table, tmp_path):
    points = read_points(table(HEADER + 'a.bag,0.1,-2.5e-3,0,unknown\n"p, 2.bag",1,2,3,0.5\n'))
    write_points(tmp_path / "copy.csv", points)
    again = read_points(tmp_path / "copy.csv")
    assert [(each.bag, each.truth) for each in again] == [(each.bag, each.truth) for each in points]
