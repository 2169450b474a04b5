# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cache of the index of a map's photos: a binary file beside the map.

  magic and version | arrays | index | table (JSON) | length and checksum of the table, magic

The table contains the parameters, the photos, and offset, length and checksum of the other parts. The arrays
are the vectors (global descriptors), the scores of compared photos and, for each kind of keypoints, the mean
and the basis of the codes, positions and codes. The index, if there is one, has the format of
DescriptorIndex.append. Arrays and a faiss index are memory-mapped. The file contains no code. A file of
another version, or that is truncated or corrupted, is rejected.
"""

import json
import struct
import zlib
from pathlib import Path
from typing import IO, Any, Dict, List, Tuple

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.places.descriptor_codes import DescriptorCodes
from sextant.places.index_params import IndexParams
from sextant.places.photo_keypoints import PhotoKeypoints
from sextant.places.place_index import ComparedPhotos, IndexedPhoto, PlaceIndex

MAGIC = b"SEXTANT PLACES\n\0"
VERSION = 5
_BEGIN = struct.Struct("<16sI")  # magic, version
_END = struct.Struct("<QI16s")  # length and checksum of the table, magic
_CHUNK = 1 << 22  # bytes read at once for a checksum


class CacheError(ValueError):
    """Reason why a cache is not used."""


def cache_path(map_path: Path) -> Path:
    """Path of a map's cache."""
    return map_path.with_name(map_path.name + ".index")


def write_cache(path: Path, index: PlaceIndex) -> None:
    """Writes an index atomically.

    :raises OSError: it cannot be written
    """
    with atomic_file(path, "wb") as file:
        file.write(_BEGIN.pack(MAGIC, VERSION))
        parts = {}
        for name, values in _arrays(index).items():
            parts[name] = (file.tell(), values.nbytes)
            file.write(np.ascontiguousarray(values).data)
        file.flush()
        fd_path = _fd_path(file)
        if index.descriptors is not None:
            begin = file.tell()
            try:
                index.descriptors.append(fd_path)
            except RuntimeError as error:
                raise OSError(str(error).replace(fd_path, str(path))) from None
            parts["index"] = (begin, file.seek(0, 2) - begin)
        table = _table(index, {name: (*part, _checksum(fd_path, *part)) for name, part in parts.items()})
        file.write(table)
        file.write(_END.pack(len(table), zlib.crc32(table), MAGIC))


def read_cache(path: Path, params: IndexParams) -> PlaceIndex:
    """Reads an index that was written with these parameters.

    :raises OSError: it cannot be read
    :raises CacheError: it is not a cache, is damaged, or has another version or other parameters
    """
    with open(path, "rb") as file:
        _check_begin(path, file.read(_BEGIN.size))
        try:
            table = _read_table(path, file)
            if table["settings"] != params.as_json():
                raise CacheError(f"{path}: has other parameters")
            for name, (begin, length, checksum) in table["parts"].items():
                if _checksum(_fd_path(file), begin, length) != checksum:
                    raise CacheError(f"{path}: its part '{name}' is damaged")
            return _index(_fd_path(file), table, params)
        except (KeyError, TypeError, ValueError, RuntimeError) as error:
            if isinstance(error, CacheError):
                raise
            raise CacheError(f"{path}: cannot be read: {error}") from None


def _fd_path(file: IO) -> str:
    """A path that leads to this open file even if another process replaces the file."""
    return f"/dev/fd/{file.fileno()}"


def _arrays(index: PlaceIndex) -> Dict[str, np.ndarray]:
    """All arrays by name; those of larger elements first, so that each is aligned."""
    arrays = {"vectors": index.vectors}
    if index.compared:
        arrays["compared"] = index.compared.scores
    kinds = list(enumerate(index.keypoints))
    arrays.update({f"mean{number}": kind.coder.mean for number, kind in kinds})
    arrays.update({f"basis{number}": kind.coder.basis for number, kind in kinds})
    arrays.update({f"positions{number}": kind.positions for number, kind in kinds})
    arrays.update({f"codes{number}": kind.codes for number, kind in kinds})
    return arrays


def _table(index: PlaceIndex, parts: Dict[str, Tuple[int, int, int]]) -> bytes:
    table = {
        "settings": index.params.as_json(),
        "photos": [photo._asdict() for photo in index.photos],
        "widths": [kind.codes.shape[1] for kind in index.keypoints],
        "vector": index.vectors.shape[1],
        "compared": index.compared.rows.tolist() if index.compared else None,
        "counts": [kind.counts.tolist() for kind in index.keypoints],
        "learned_from": index.learned_from,
        "parts": parts,
    }
    return json.dumps(table, separators=(",", ":")).encode()


def _check_begin(path: Path, begin: bytes) -> None:
    if len(begin) < _BEGIN.size or not begin.startswith(MAGIC):
        raise CacheError(f"{path}: is not a place index")
    version = _BEGIN.unpack(begin)[1]
    if version != VERSION:
        raise CacheError(f"{path}: has version {version}, expected {VERSION}")


def _read_table(path: Path, file: IO) -> Dict[str, Any]:
    truncated, size = CacheError(f"{path}: is truncated"), file.seek(0, 2)
    if size < _BEGIN.size + _END.size:
        raise truncated
    file.seek(size - _END.size)
    length, checksum, magic = _END.unpack(file.read(_END.size))
    if magic != MAGIC or length > size - _BEGIN.size - _END.size:
        raise truncated
    file.seek(size - _END.size - length)
    text = file.read(length)
    if zlib.crc32(text) != checksum:
        raise CacheError(f"{path}: its table is damaged")
    return json.loads(text)


def _checksum(path: str, begin: int, length: int) -> int:
    """CRC-32 of a part of the file, which ends early if the file does."""
    checksum, end = 0, begin + length
    with open(path, "rb") as file:
        file.seek(begin)
        while chunk := file.read(min(end - file.tell(), _CHUNK)):
            checksum = zlib.crc32(chunk, checksum)
    return checksum


def _index(path: str, table: Dict[str, Any], params: IndexParams) -> PlaceIndex:
    photos = [IndexedPhoto(**{**photo, "state": tuple(photo["state"])}) for photo in table["photos"]]
    kinds = enumerate(zip(table["counts"], table["widths"]))
    keypoints = [_keypoints(path, table, number, *kind) for number, kind in kinds]
    vectors = _mapped(path, table, "vectors", np.float32, (len(photos), table["vector"]))
    index, rows, compared = table["parts"].get("index"), table["compared"], None
    descriptors = sextant.DescriptorIndex.read(path, index[0]) if index else None
    if rows is not None:
        shape = (len(keypoints), len(rows), len(photos))
        compared = ComparedPhotos(np.array(rows, int), _mapped(path, table, "compared", np.float32, shape))
    return PlaceIndex(params, photos, keypoints, descriptors, table["learned_from"], vectors, compared)


def _keypoints(
    path: str, table: Dict[str, Any], number: int, counts: List[int], width: int
) -> PhotoKeypoints:
    mean = _mapped(path, table, f"mean{number}", np.float32, (-1,))
    basis = _mapped(path, table, f"basis{number}", np.float32, (len(mean), width))
    positions = _mapped(path, table, f"positions{number}", np.uint16, (sum(counts), 2))
    codes = _mapped(path, table, f"codes{number}", np.int8, (sum(counts), width))
    return PhotoKeypoints(DescriptorCodes(mean, basis), positions, codes, counts)


def _mapped(path: str, table: Dict[str, Any], name: str, kind: type, shape: Tuple[int, ...]) -> np.ndarray:
    """A part of the file as a memory-mapped array."""
    begin, length, _ = table["parts"][name]
    if not length:  # an empty part cannot be mapped
        return np.zeros(shape, kind)
    return np.memmap(path, kind, "r", begin, length // np.dtype(kind).itemsize).reshape(shape)
