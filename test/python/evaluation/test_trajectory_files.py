# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sextant.evaluation.trajectory_files import read_trajectory, write_trajectory

HALF = np.sqrt(0.5)
CSV = "stamp,x,y,z,qx,qy,qz,qw\n"
ROW = "3.5,1,2,3,0,0,0,1\n"
QUARTER_TURN = np.array([[0, -1, 0, 1], [1, 0, 0, -2], [0, 0, 1, 0.5], [0, 0, 0, 1]], dtype=float)


def read(tmp_path, name, text, encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return read_trajectory(str(path))


def refused(tmp_path, name, text):
    with pytest.raises(ValueError) as caught:
        read(tmp_path, name, text)
    return str(caught.value).replace(str(tmp_path) + "/", "")


@pytest.mark.parametrize("name", ["a.tum", "b.txt", "C.TUM"])
def test_tum(tmp_path, name):
    first = f"1700000000.123456789 1 -2 0.5 0 0 {HALF} {HALF}\t# turned"
    text = f"# stamp tx ty tz qx qy qz qw\n\n{first}\n  5 0 0 0 0 0 0 -1\r\n"
    trajectory = read(tmp_path, name, text)
    assert list(trajectory) == [1700000000123456789, 5 * 10**9]
    assert trajectory[1700000000123456789] == pytest.approx(QUARTER_TURN, abs=1e-12)
    assert trajectory[5 * 10**9] == pytest.approx(np.eye(4))


HEADERS = [
    ("qw,qz,qy,qx,z,y,x,speed,time", "{h},{h},0,0,0.5,-2,1,9,0.25"),
    (" Timestamp , tx,ty,tz, qx,qy,qz,qw", "0.25, 1,-2,0.5, 0,0,{h},{h}"),
    (
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []",
        "250000000,1,-2,0.5,{h},0,0,{h}",
    ),
    (
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.child_frame_id,"
        + ",".join(f"field.pose.pose.{name}" for name in ("position.x", "position.y", "position.z"))
        + ","
        + ",".join(f"field.pose.pose.orientation.{axis}" for axis in "xyzw"),
        "9,1,250000000,map,base,1,-2,0.5,0,0,{h},{h}",
    ),
]


@pytest.mark.parametrize("header, row", HEADERS)
def test_csv_by_the_names_of_its_columns(tmp_path, header, row):
    trajectory = read(tmp_path, "truth.csv", f"{header}\n{row.format(h=HALF)}\n")
    assert list(trajectory) == [250000000]
    assert trajectory[250000000] == pytest.approx(QUARTER_TURN, abs=1e-12)


def test_csv_of_a_spreadsheet(tmp_path):
    assert list(read(tmp_path, "a.csv", CSV + "\n# a remark\n" + ROW, "utf-8-sig")) == [3500000000]


def test_rotations_are_made_exact(tmp_path):
    q = Rotation.from_rotvec([0.3, -0.8, 1.9]).as_quat() * (1.0 + 9e-4)
    trajectory = read(tmp_path, "a.tum", "0 0 0 0 " + " ".join(map(str, q)))
    R = trajectory[0][:3, :3]
    assert pytest.approx(np.eye(3), abs=1e-14) == R @ R.T
    assert Rotation.from_matrix(R).as_rotvec() == pytest.approx([0.3, -0.8, 1.9])


@pytest.mark.parametrize(
    "name, text, reason",
    [
        ("a.tum", "# nothing\n", "a.tum: contains no pose"),
        ("a.tum", "\n0 1 2 3 0 0 1\n", "a.tum:2: 7 values, expected 8"),
        ("a.tum", "0 1 2 x 0 0 0 1", "a.tum:1: z is 'x', not a number"),
        ("a.tum", "0 nan 2 3 0 0 0 1", "a.tum:1: x is 'nan', not finite"),
        ("a.tum", "0 1 2 3 0 0 0 -inf", "a.tum:1: qw is '-inf', not finite"),
        ("a.tum", "0 1 2 3 0 0 0 0", "a.tum:1: the quaternion is not a rotation: its norm is 0, not 1"),
        ("a.tum", "0 1 2 3 0 0 0 1.0011", "a.tum:1: the quaternion is not a rotation: its norm is 1.0011"),
        ("a.tum", "then 1 2 3 0 0 0 1", "a.tum:1: stamp is 'then', not a number"),
        ("a.tum", "nan 1 2 3 0 0 0 1", "a.tum:1: stamp is 'nan', not a time in seconds"),
        ("a.tum", "1e999999 1 2 3 0 0 0 1", "a.tum:1: stamp is '1e999999', not a time in seconds"),
        ("a.tum", "-1 1 2 3 0 0 0 1", "a.tum:1: stamp is '-1', not a time in seconds"),
        ("a.tum", "170000000012345 1 2 3 0 0 0 1", "a.tum:1: stamp is '170000000012345', not a time in sec"),
        ("a.tum", "1 1 2 3 0 0 0 1\n\n1.0 1 2 3 0 0 0 1", "a.tum:3: duplicate stamp, as in line 1"),
        ("a.csv", "", "a.csv:1: no column 'stamp'; the header must be stamp,x,y,z,qx,qy,qz,qw"),
        ("a.csv", CSV, "a.csv: contains no pose"),
        ("a.csv", CSV.replace(",qy", ""), "a.csv:1: no column 'qy'; the header must be"),
        ("a.csv", CSV.replace(",", ";"), "a.csv:1: no column 'stamp'; the header must be"),
        ("a.csv", CSV.replace("qx", "time"), "a.csv:1: more than one column for 'stamp': stamp, time"),
        ("a.csv", CSV + ROW + "4.5,1,2\n", "a.csv:3: 3 values, expected 8"),
        ("a.csv", CSV + "3.5,1,2,3,,0,0,1\n", "a.csv:2: qx is '', not a number"),
        ("a.bag", ROW, "a.bag: the file name of a trajectory must end in .csv, .tum, .txt"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_reported_with_its_line(tmp_path, name, text, reason):
    assert refused(tmp_path, name, text).startswith(reason)


def test_what_is_no_text(tmp_path):
    (tmp_path / "a.tum").write_bytes(b"\xff\xfe\x00#ROSBAG")
    with pytest.raises(ValueError, match="a.tum: is not UTF-8 text"):
        read_trajectory(tmp_path / "a.tum")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(OSError):
        read_trajectory(tmp_path / "absent.tum")


@pytest.mark.parametrize("name", ["a.csv", "a.tum", "a.TXT"])
def test_what_is_written_is_read_again(tmp_path, name):
    moved = np.eye(4)
    moved[:3, 3] = [0.1, -2e-7, 1e6 / 3]
    trajectory = {1_700_000_000_123_456_789: QUARTER_TURN, 5: moved}
    write_trajectory(tmp_path / name, trajectory)
    again = read_trajectory(tmp_path / name)
    assert list(again) == [5, 1_700_000_000_123_456_789]
    assert again[5].tolist() == moved.tolist()
    assert again[1_700_000_000_123_456_789] == pytest.approx(QUARTER_TURN, abs=1e-15)
    with pytest.raises(ValueError, match="a.bag: the file name of a trajectory must end in .csv, .tum, .txt"):
        write_trajectory(tmp_path / "a.bag", trajectory)
