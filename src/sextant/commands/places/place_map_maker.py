# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Serves a web page on which photos are placed on an overview image by clicks; every click is saved at once.

place_map_maker photos/            creates or edits photos/map.txt at http://127.0.0.1:8080

make_place_map makes a map without clicks, from positions that are known.
"""

import argparse
import asyncio
import signal
import webbrowser
from pathlib import Path
from typing import Optional, Sequence

from aiohttp import web

from sextant.commands.command_line import Answer, CommandParser, run
from sextant.commands.places.georeference_options import add_corner_options, corners_of
from sextant.place_maps.place_map_draft import PlaceMapDraft
from sextant.place_maps.place_map_page import ADDRESS, map_page


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0 after Ctrl-C, 2 when nothing could be served"""
    return run(_parser(), arguments, _serve)


def _parser() -> CommandParser:
    parser = CommandParser(prog="place_map_maker", description=__doc__)
    add = parser.add_argument
    add("folder", metavar="FOLDER", help="folder of photos and overview; the page can add more")
    add("--map", default="map.txt", metavar="NAME", help="map file in the folder (default: %(default)s)")
    add("--port", type=int, default=8080, help="default: %(default)s; 0: any free one")
    add("--open", action="store_true", help="open the page in the browser")
    add_corner_options(parser)
    return parser


def _serve(options: argparse.Namespace) -> Answer:
    if Path(options.map).name != options.map:
        raise ValueError(f"--map is '{options.map}', expected the name of a file in the folder")
    if not 0 <= options.port <= 65535:
        raise ValueError(f"--port is {options.port}, allowed are 0 to 65535")
    draft = PlaceMapDraft(Path(options.folder) / options.map, corners_of(options))
    asyncio.run(_serve_until_stopped(draft, options.port, options.open))
    place_map = draft.place_map
    count = len(place_map.photos) if place_map else 0
    return Answer([f"{draft.path}: {count} photos" if place_map else "no map was made"])


async def _serve_until_stopped(draft: PlaceMapDraft, port: int, open_browser: bool) -> None:
    runner = web.AppRunner(map_page(draft))
    await runner.setup()
    try:
        await web.TCPSite(runner, ADDRESS, port).start()
        address = f"http://{ADDRESS}:{runner.addresses[0][1]}"
        print(f"{draft.path}: {address}   (Ctrl-C ends)", flush=True)
        if open_browser:
            webbrowser.open(address)
        stopped = asyncio.Event()
        for number in (signal.SIGINT, signal.SIGTERM):
            asyncio.get_running_loop().add_signal_handler(number, stopped.set)
        await stopped.wait()
    finally:
        await runner.cleanup()
