# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The index of a map's photos in one binary file beside the map, so that a second start takes no build.

  magic and version | vectors | keypoints | index | table, JSON | length and checksum of the table, magic

The table at the end names parameters, photos, and where the other parts lie, with their checksums. The index
is faiss's own format; it, the vectors and the keypoints are mapped into memory where they lie. Nothing in the
file is run; a file of another version, cut short, or with a flipped bit is not read at all.
"""

import json
import struct
import zlib
from pathlib import Path
from typing import IO, Any, Dict, Tuple

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.places.place_index import IndexedPhoto, IndexParams, PlaceIndex

MAGIC = b"SEXTANT PLACES\n\0"
VERSION = 3
_MAPPED = {"vectors": np.float32, "keypoints": np.uint16}  # vectors first: their place is a multiple of 4
_BEGIN = struct.Struct("<16sI")
_END = struct.Struct("<QI16s")  # length and checksum of the table, magic
_CHUNK = 1 << 22


class CacheError(ValueError):
    """Why a cache is not used; the map's index is built anew."""


def cache_path(map_path: Path) -> Path:
    """Of the cache of a map."""
    return map_path.with_name(map_path.name + ".index")


def write_cache(path: Path, index: PlaceIndex) -> None:
    """Whole or not at all; only an index by faiss can be stored.

    :raises OSError: it cannot be written
    """
    with atomic_file(path, "wb") as file:
        file.write(_BEGIN.pack(MAGIC, VERSION))
        parts = {}
        for name in _MAPPED:
            values = getattr(index, name)
            parts[name] = (file.tell(), values.nbytes)
            file.write(np.ascontiguousarray(values).data)
        file.flush()
        begin, opened = file.tell(), _opened(file)
        try:
            index.descriptors.append(opened)
        except RuntimeError as error:
            raise OSError(str(error).replace(opened, str(path))) from None
        parts["index"] = (begin, file.seek(0, 2) - begin)
        table = _table(
            index,
            {name: (*part, _checksum(opened, *part)) for name, part in parts.items()},
        )
        file.write(table)
        file.write(_END.pack(len(table), zlib.crc32(table), MAGIC))


def read_cache(path: Path, params: IndexParams) -> PlaceIndex:
    """What write_cache() wrote of an index with these parameters.

    :raises OSError: it cannot be read
    :raises CacheError: it is no cache, or not all of one, or of another version or other parameters
    """
    with open(path, "rb") as file:
        _check_begin(path, file.read(_BEGIN.size))
        try:
            table = _read_table(path, file)
            if table["settings"] != params.as_json():
                raise CacheError(f"{path}: is of other settings")
            for name, (begin, length, checksum) in table["parts"].items():
                if _checksum(_opened(file), begin, length) != checksum:
                    raise CacheError(f"{path}: its part '{name}' is damaged")
            return _index(_opened(file), table, params)
        except (KeyError, TypeError, ValueError, RuntimeError) as error:
            if isinstance(error, CacheError):
                raise
            raise CacheError(f"{path}: cannot be read: {error}") from None


def _opened(file: IO) -> str:
    """A path to this very file, whichever other process gives its name to another one meanwhile."""
    return f"/dev/fd/{file.fileno()}"


def _table(index: PlaceIndex, parts: Dict[str, Tuple[int, int, int]]) -> bytes:
    table = {
        "settings": index.params.as_json(),
        "photos": [photo._asdict() for photo in index.photos],
        "learned_from": index.learned_from,
        "parts": parts,
    }
    return json.dumps(table, separators=(",", ":")).encode()


def _check_begin(path: Path, begin: bytes) -> None:
    if len(begin) < _BEGIN.size or not begin.startswith(MAGIC):
        raise CacheError(f"{path}: is no index of places")
    version = _BEGIN.unpack(begin)[1]
    if version != VERSION:
        raise CacheError(f"{path}: is of version {version}, this program's is {VERSION}")


def _read_table(path: Path, file: IO) -> Dict[str, Any]:
    short, size = CacheError(f"{path}: is cut short"), file.seek(0, 2)
    if size < _BEGIN.size + _END.size:
        raise short
    file.seek(size - _END.size)
    length, checksum, magic = _END.unpack(file.read(_END.size))
    if magic != MAGIC or length > size - _BEGIN.size - _END.size:
        raise short
    file.seek(size - _END.size - length)
    text = file.read(length)
    if zlib.crc32(text) != checksum:
        raise CacheError(f"{path}: its table is damaged")
    return json.loads(text)


def _checksum(path: str, begin: int, length: int) -> int:
    """Of as much as there is."""
    checksum = 0
    with open(path, "rb") as file:
        file.seek(begin)
        while length > 0:
            chunk = file.read(min(length, _CHUNK))
            if not chunk:
                break
            checksum = zlib.crc32(chunk, checksum)
            length -= len(chunk)
    return checksum


def _index(path: str, table: Dict[str, Any], params: IndexParams) -> PlaceIndex:
    photos = [IndexedPhoto(**{**photo, "state": tuple(photo["state"])}) for photo in table["photos"]]
    keypoints = _mapped(path, table, "keypoints").reshape(-1, 2)
    vectors = _mapped(path, table, "vectors").reshape(len(photos), -1)
    descriptors = sextant.DescriptorIndex.read(path, table["parts"]["index"][0])
    return PlaceIndex(params, photos, keypoints, descriptors, table["learned_from"], vectors)


def _mapped(path: str, table: Dict[str, Any], name: str) -> np.ndarray:
    begin, length, _ = table["parts"][name]
    if not length:  # nothing cannot be mapped
        return np.zeros(0, _MAPPED[name])
    return np.memmap(path, _MAPPED[name], "r", begin, length // np.dtype(_MAPPED[name]).itemsize)
