# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Atomic writing of files.

A temporary file is locked while it is being written. An unlocked one was left by a killed program; it is
removed when the next file is written.
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
    """Opens a temporary file beside path, which replaces path when the block ends without an exception.

    :param mode: "w" (UTF-8 text) or "wb"
    :raises OSError: the file cannot be written; the error names it, and an existing file is left unchanged
    """
    path = Path(path)
    try:
        number, temporary = _temporary_file(path)
    except OSError as error:  # it names the temporary file
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
    """Creates a temporary folder; its files are moved to folder when the block ends without an exception.

    :raises OSError: folder does not exist or cannot be written to, or contains a folder with the name of a
        file; existing files are left unchanged
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
    """Creates a locked temporary file beside path; returns its descriptor and name."""
    begin = f".{path.name}.part_"
    _remove_left(path.parent.glob(f"{glob.escape(begin)}????????{glob.escape(path.suffix)}"))
    while True:
        number, temporary = tempfile.mkstemp(dir=path.parent, prefix=begin, suffix=path.suffix)
        _lock(number)
        if os.fstat(number).st_nlink:
            return number, temporary
        os.close(number)  # another program removed it as left over, before it was locked


@contextmanager
def _locked_folder(folder: str) -> Iterator[None]:
    number = os.open(folder, os.O_RDONLY)
    try:
        _lock(number)
        yield
    finally:
        os.close(number)


def _lock(number: int) -> None:
    with suppress(OSError):  # a file system without locks: then no left-over file is ever removed
        fcntl.flock(number, fcntl.LOCK_EX)


def _remove_left(paths: Iterable[Path]) -> None:
    for path in paths:
        with suppress(OSError):  # another program is writing it, or another user owns it
            number = os.open(path, os.O_RDONLY)
            try:
                fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            finally:
                os.close(number)


def _mode_of(path: Path) -> int:
    """Returns the permissions of the file to replace, or those of a new file."""
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
