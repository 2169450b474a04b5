# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page for placing photos, served in this process, and what its changes leave in the map's file."""

import asyncio
import json
import threading
import urllib.error
import urllib.request

import cv2
from aiohttp import web
from made_photos import picture

from sextant.place_maps.place_map_file import read_place_map
from sextant.place_maps.place_map_page import ADDRESS, map_page

PATIENCE = 20.0  # seconds


class Served:
    """The page of a draft, on a port of its own."""

    def __init__(self, draft):
        self._loop = asyncio.new_event_loop()
        self._runner = web.AppRunner(map_page(draft))
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.port = self._wait(self._start())
        self.address = f"http://{ADDRESS}:{self.port}"

    async def _start(self):
        await self._runner.setup()
        site = web.TCPSite(self._runner, ADDRESS, 0)
        await site.start()
        return self._runner.addresses[0][1]

    def _wait(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(PATIENCE)

    def close(self):
        self._wait(self._runner.cleanup())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(PATIENCE)

    def ask(self, path, headers=None, body=None):
        """(status, text) of an answer."""
        request = urllib.request.Request(self.address + path, body, headers or {})
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                return answer.status, answer.read().decode("utf-8", "replace")
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode()

    def change(self, path, values, **headers):
        headers = {"Origin": self.address, "Content-Type": "application/json", **headers}
        return self.ask(
            path, {key: value for key, value in headers.items() if value}, json.dumps(values).encode()
        )


def written_picture(path, seed, size=(64, 48)):
    cv2.imwrite(str(path), picture(seed, size))
    return path


def photos_in(folder):
    path = folder / "map.txt"
    return {photo.image: (photo.x, photo.y) for photo in read_place_map(path).photos} if path.exists() else {}
