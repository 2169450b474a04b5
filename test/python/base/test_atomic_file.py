# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess
import sys

import pytest
from full_disk import full_disk

from sextant.base.atomic_file import atomic_file, atomic_files


def contents(folder):
    return {path.name: path.read_text() if path.is_file() else None for path in folder.iterdir()}


def test_a_file_takes_its_name_when_it_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    os.chmod(path, 0o600)
    with pytest.raises(RuntimeError), atomic_file(path) as file:
        file.write("half")
        raise RuntimeError
    assert contents(tmp_path) == {"a.txt": "old"}
    with atomic_file(path) as file:
        file.write("new")
        assert path.read_text() == "old"
    assert contents(tmp_path) == {"a.txt": "new"} and path.stat().st_mode & 0o777 == 0o600


def test_files_take_their_names_together(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(RuntimeError), atomic_files(tmp_path) as folder:
        (folder / "a.txt").write_text("new")
        raise RuntimeError
    assert contents(tmp_path) == {"a.txt": "old"}
    with atomic_files(tmp_path) as folder:
        for name in ("a.txt", "b.txt"):
            (folder / name).write_text("new")
    assert contents(tmp_path) == {"a.txt": "new", "b.txt": "new"}


def test_a_folder_in_the_way_of_one_file_stops_all(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "b.txt").mkdir()
    with pytest.raises(IsADirectoryError, match="b.txt"), atomic_files(tmp_path) as folder:
        for name in ("a.txt", "b.txt"):
            (folder / name).write_text("new")
    assert contents(tmp_path) == {"a.txt": "old", "b.txt": None}


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(OSError, match="absent"), atomic_file(tmp_path / "absent/a.txt"):
        pass
    with pytest.raises(OSError, match="absent"), atomic_files(tmp_path / "absent"):
        pass


KILLED = """
import os, signal, sys
from sextant.base.atomic_file import atomic_file, atomic_files
with atomic_file(sys.argv[1]) as file, atomic_files(os.path.dirname(sys.argv[1])) as folder:
    file.write("half")
    file.flush()
    (folder / "b.txt").write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def kill_a_writer(path):
    done = subprocess.run([sys.executable, "-c", KILLED, str(path)], timeout=60)
    assert done.returncode == -signal.SIGKILL


def test_what_a_killed_writer_left_goes_with_the_next_write(tmp_path):
    path = tmp_path / "a[1].txt"
    path.write_text("old")
    others = {".a[1].txt.20240101.txt": "a user's", ".b.txt.part_12345678.txt": "another file's"}
    for name, text in others.items():
        (tmp_path / name).write_text(text)
    kill_a_writer(path)
    assert path.read_text() == "old" and len(contents(tmp_path)) == 5
    kill_a_writer(path)
    assert path.read_text() == "old" and len(contents(tmp_path)) == 5
    with atomic_file(path) as file, atomic_files(tmp_path):
        file.write("new")
    assert contents(tmp_path) == {path.name: "new", **others}


def test_what_is_being_written_is_not_taken_for_left(tmp_path):
    path = tmp_path / "a.txt"
    with atomic_file(path) as slow, atomic_files(tmp_path) as folder:
        (folder / "b.txt").write_text("slow")
        with atomic_file(path) as file, atomic_files(tmp_path):
            file.write("fast")
        assert path.read_text() == "fast"
        slow.write("slow")
    assert contents(tmp_path) == {"a.txt": "slow", "b.txt": "slow"}


def test_a_full_disk_is_reported_and_the_old_file_stays(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    failure = pytest.raises(OSError, match=r"cannot be written: File too large: '.*/a\.txt'")
    with failure, full_disk(1000), atomic_file(path) as file:
        file.write(2000 * "x")
    assert contents(tmp_path) == {"a.txt": "old"}
