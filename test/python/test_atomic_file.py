# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest

from sextant.atomic_file import atomic_file, atomic_files


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
