# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collects pictures for labelling from bags and videos: sharp ones that differ in view and light.

collect_pictures hall.bag evening.bag -o pictures/                        of the only camera of the bags
collect_pictures hall.bag -o pictures/ --image /front/image_raw --depth /depth/image_raw
collect_pictures phone.mp4 -o pictures/ --every 5 --count 300

Pictures of an earlier collection in the folder stay; an interrupted collection can be repeated. The node
picture_collector collects from a topic.
"""

import argparse
from pathlib import Path
from typing import Dict, List, Optional, Sequence

from tqdm import tqdm

from sextant.bags.bag_pictures import depth_of_pictures, recorded_pictures
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.labels.picture_collection import CollectionParams, PictureCollection


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid options or files"""
    return run(_parser(), arguments, _collect)


def _parser() -> CommandParser:
    parser = CommandParser(prog="collect_pictures", description=__doc__)
    add, default = parser.add_argument, CollectionParams()
    add("recordings", nargs="+", metavar="BAG|VIDEO", help="with colour images")
    add("-o", "--output", type=Path, required=True, metavar="FOLDER", help="of the pictures")
    add("--image", default="", metavar="TOPIC", help="image topic of bags (default: the only one)")
    text = "depth images with camera_info beside them, aligned with the images or with tf (default: none)"
    add("--depth", default="", metavar="TOPIC", help=text)
    add("--every", type=int, default=1, metavar="N", help="use every n-th image only")
    text = f"maximum number of new pictures (default: {default.count})"
    add("--count", type=int, default=default.count, metavar="N", help=text)
    text = f"minimum difference from every other picture, grey levels (default: {default.difference:g})"
    add("--difference", type=float, default=default.difference, metavar="LEVELS", help=text)
    text = f"minimum sharpness relative to the usual one (default: {default.min_sharpness:g})"
    add("--sharpness", type=float, default=default.min_sharpness, metavar="FRACTION", help=text)
    return parser


def _collect(options: argparse.Namespace) -> Answer:
    if options.every < 1:
        raise ValueError(f"--every is {options.every}, must be a whole number from 1 on")
    params = CollectionParams(options.count, options.difference, options.sharpness)
    collection = PictureCollection(options.output, params)
    notes: List[str] = []
    try:
        for path in options.recordings:
            notes += _collect_from(path, collection, options)
    finally:
        collection.write_counts()
    return Answer([*notes, *collection.summary()])


def _collect_from(path: str, collection: PictureCollection, options: argparse.Namespace) -> List[str]:
    """Returns notes on the recording."""
    stamps: Dict[str, int] = {}
    notes: List[str] = []
    pictures = recorded_pictures(path, notes, options.image, options.every)
    for picture in tqdm(pictures, disable=None, desc=Path(path).name, unit=" pictures"):
        collection.offer(picture.name, picture.image)
        if picture.stamp and collection.has(picture.name):
            stamps[picture.name] = picture.stamp
    stamps = {name: stamp for name, stamp in stamps.items() if collection.has(name)}
    if options.depth:
        depths, more = depth_of_pictures(path, options.image, options.depth, list(stamps.values()))
        notes += more
        for name, stamp in stamps.items():
            if stamp in depths:
                collection.add_depth(name, depths[stamp])
    return [f"{path}: {note}" for note in notes]
