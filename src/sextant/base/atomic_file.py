# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files that are there whole or not at all.

Who writes holds a lock on what is not yet whole. What has none was left by a program that was killed; it goes
when the next file is written.
"""

import errno
import fcntl
import glob
import os
import shutil
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Iterable, Iterator, Tuple, Union

_FOLDERS = ".sextant_"


@contextmanager
def atomic_file(path: Union[str, Path], mode: str = "w") -> Iterator[IO]:
    """A temporary file beside path that takes its name when the block ends without an exception.

    :param mode: "w" (UTF-8 text) or "wb"
    :raises OSError: it cannot be written, the error names it; an old file is left as it was
    """
    path = Path(path)
    try:
        number, temporary = _temporary_file(path)
    except OSError as error:  # names the temporary file
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(path)) from None
    try:
        with os.fdopen(number, mode, **({} if "b" in mode else {"encoding": "utf-8"})) as file:
            yield file
            file.flush()
            os.fsync(number)
            os.fchmod(number, _mode_of(path))
            os.replace(temporary, path)
    except BaseException as error:
        with suppress(FileNotFoundError):
            os.unlink(temporary)
        if isinstance(error, OSError) and error.errno is not None and error.filename is None:  # a full disk
            raise OSError(error.errno, f"cannot be written: {error.strerror}", str(path)) from None
        raise


@contextmanager
def atomic_files(folder: Union[str, Path]) -> Iterator[Path]:
    """A temporary folder, all files of which go to the other one when the block ends without an exception.

    :raises OSError: the folder is not there, or cannot be written to, or a folder has the name of a file; old
        files are left as they were
    """
    _remove_left(Path(folder).glob(f"{_FOLDERS}????????"))
    with tempfile.TemporaryDirectory(dir=folder, prefix=_FOLDERS) as temporary, _locked_folder(temporary):
        yield Path(temporary)
        moves = {path: Path(folder) / path.name for path in sorted(Path(temporary).iterdir())}
        for path in moves.values():
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, "cannot be written: there is a folder", str(path))
        for temporary_path, path in moves.items():
            os.replace(temporary_path, path)


def _temporary_file(path: Path) -> Tuple[int, str]:
    """A new one beside path, open and locked, and its name."""
    begin = f".{path.name}.part_"
    _remove_left(path.parent.glob(f"{glob.escape(begin)}????????{glob.escape(path.suffix)}"))
    while True:
        number, temporary = tempfile.mkstemp(dir=path.parent, prefix=begin, suffix=path.suffix)
        _lock(number)
        if os.fstat(number).st_nlink:
            return number, temporary
        os.close(number)  # another program took it for one that was left, before there was a lock


@contextmanager
def _locked_folder(folder: str) -> Iterator[None]:
    number = os.open(folder, os.O_RDONLY)
    try:
        _lock(number)
        yield
    finally:
        os.close(number)


def _lock(number: int) -> None:
    with suppress(OSError):  # a file system without locks: then nothing is ever taken for left
        fcntl.flock(number, fcntl.LOCK_EX)


def _remove_left(paths: Iterable[Path]) -> None:
    for path in paths:
        with suppress(OSError):  # somebody writes it, or it is somebody else's
            number = os.open(path, os.O_RDONLY)
            try:
                fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            finally:
                os.close(number)


def _mode_of(path: Path) -> int:
    """Permissions of the file that is replaced, or those that a new file would have."""
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
