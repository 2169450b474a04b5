# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Serves a page on which photos are placed on an overview picture by clicks; every click is saved at once.

place_map_maker photos/            photos/map.txt, begun or gone on with, at http://127.0.0.1:8080
"""

import argparse
import asyncio
import signal
import webbrowser
from pathlib import Path
from typing import Optional, Sequence

from aiohttp import web

from sextant.commands.command_line import Answer, CommandParser, run
from sextant.commands.georeference_options import add_corner_options, corners_of
from sextant.place_maps.map_draft import MapDraft
from sextant.place_maps.map_page import ADDRESS, map_page


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0 after Ctrl-C, 2 when nothing could be served"""
    return run(_parser(), arguments, _serve)


def _parser() -> CommandParser:
    parser = CommandParser(prog="place_map_maker", description=__doc__)
    parser.add_argument(
        "folder", metavar="FOLDER", help="of the photos and the overview; more can be added on the page"
    )
    parser.add_argument(
        "--map", default="map.txt", metavar="NAME", help="file in the folder (default: %(default)s)"
    )
    parser.add_argument("--port", type=int, default=8080, help="default: %(default)s; 0: a free one")
    parser.add_argument("--open", action="store_true", help="open it in the browser")
    add_corner_options(parser)
    return parser


def _serve(options: argparse.Namespace) -> Answer:
    if Path(options.map).name != options.map:
        raise ValueError(f"--map is '{options.map}', expected the name of a file in the folder")
    if not 0 <= options.port <= 65535:
        raise ValueError(f"--port is {options.port}, allowed are 0 to 65535")
    draft = MapDraft(Path(options.folder) / options.map, corners_of(options))
    asyncio.run(_serve_until_stopped(draft, options.port, options.open))
    place_map = draft.place_map
    count = len(place_map.photos) if place_map else 0
    return Answer([f"{draft.path}: {count} photos" if place_map else "nothing was made"])


async def _serve_until_stopped(draft: MapDraft, port: int, open_browser: bool) -> None:
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
