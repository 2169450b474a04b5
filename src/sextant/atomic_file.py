# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files that are there whole or not at all."""

import errno
import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Iterator, Union


@contextmanager
def atomic_file(path: Union[str, Path], mode: str = "w") -> Iterator[IO]:
    """A temporary file beside path that takes its name when the block ends without an exception.

    :param mode: "w" (UTF-8 text) or "wb"
    :raises OSError: it cannot be written, the error names it; an old file is left as it was
    """
    path = Path(path)
    try:
        number, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    except OSError as error:  # names the temporary file
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(path)) from None
    try:
        with os.fdopen(number, mode, **({} if "b" in mode else {"encoding": "utf-8"})) as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, _mode_of(path))
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


@contextmanager
def atomic_files(folder: Union[str, Path]) -> Iterator[Path]:
    """A temporary folder, all files of which go to the other one when the block ends without an exception.

    :raises OSError: the folder is not there, or cannot be written to, or a folder has the name of a file; old
        files are left as they were
    """
    with tempfile.TemporaryDirectory(dir=folder, prefix=".sextant_") as temporary:
        yield Path(temporary)
        moves = {path: Path(folder) / path.name for path in sorted(Path(temporary).iterdir())}
        for path in moves.values():
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, "cannot be written: there is a folder", str(path))
        for temporary_path, path in moves.items():
            os.replace(temporary_path, path)


def _mode_of(path: Path) -> int:
    """Permissions of the file that is replaced, or those that a new file would have."""
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
