# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Output of the make_place_map commands: options, files and summary."""

import argparse
from pathlib import Path
from typing import Dict, Optional, Sequence

from sextant.base.atomic_file import atomic_files
from sextant.commands.command_line import Answer, check_output
from sextant.images.photo_depth import depth_path
from sextant.place_maps.photo_poses import PhotoPoses, poses_path, write_photo_poses
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.place_map_file import read_place_map, write_place_map


def add_output_options(parser: argparse.ArgumentParser, default: str = "") -> None:
    """Adds --output and --force.

    :param default: described in the help text; empty: --output is required
    """
    parser.add_argument(
        "-o", "--output", type=Path, metavar="MAP", required=not default,
        help="map to write" + (f" (default: {default})" if default else ""),
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite existing files")


def existing_map(options: argparse.Namespace) -> Optional[PlaceMap]:
    """The map that --add extends; None without --add.

    :raises OSError, ValueError: it cannot be read; or a map exists and there is no --force
    """
    if options.add:
        return read_place_map(options.output)
    check_output(options.output, options.force)
    return None


def write_map(
    options: argparse.Namespace,
    place_map: PlaceMap,
    files: Dict[str, bytes],
    left_out: Sequence[str] = (),
    notes: Sequence[str] = (),
    poses: Optional[PhotoPoses] = None,
) -> Answer:
    """Writes the images and poses, then the map, so that a map never refers to missing files.

    :param files: content by name in the map's folder; identical existing files are not written
    :param left_out: reasons for photos that are not in the map
    :param notes: other messages
    :param poses: of the photos, for metric poses; None: unchanged with --add, otherwise none
    :raises OSError, ValueError: the map was not written; images may have been
    """
    place_map.check()
    folder = options.output.parent
    new = {name: content for name, content in files.items() if not _has_content(folder / name, content)}
    for name in new:
        check_output(folder / name, options.force)
    is_new = not getattr(options, "add", False)
    if is_new:
        check_output(poses_path(options.output), options.force)
    with atomic_files(folder) as temporary:
        for name, content in new.items():
            (temporary / name).write_bytes(content)
    _remove_old_depth(folder, files)
    if poses or is_new:
        _write_poses(poses_path(options.output), poses)
    write_place_map(options.output, place_map)
    summary = _summary(place_map, len(left_out))
    summary += f"; {len(poses.photos)} with poses" if poses and poses.photos else ""
    return Answer([*notes, *left_out, f"{options.output}: {summary}"])


def _remove_old_depth(folder: Path, files: Dict[str, bytes]) -> None:
    """Removes depth images of an earlier map beside photos that are written without."""
    for name in files:
        old = depth_path(folder / name)
        if old.name not in files and old.exists():
            old.unlink()


def _write_poses(path: Path, poses: Optional[PhotoPoses]) -> None:
    if poses and poses.photos:
        write_photo_poses(path, poses)
    elif path.exists():
        path.unlink()


def _has_content(path: Path, content: bytes) -> bool:
    return path.is_file() and path.read_bytes() == content


def _summary(place_map: PlaceMap, left_out: int) -> str:
    photos, places = len(place_map.photos), len(place_map.places())
    text = f"{photos} photos of {places} places" if photos else f"no photo yet, on {place_map.overview.image}"
    return text + (f"; {left_out} left out" if left_out else "")
