# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Web page for placing photos with clicks; served to the browser of this machine only."""

import io
from pathlib import Path
from typing import Any, Awaitable, Callable, Dict, Tuple

from aiohttp import web
from PIL import Image

from sextant.images.photo_file import read_rgb
from sextant.place_maps.place_map_draft import PlaceMapDraft

ADDRESS = "127.0.0.1"
LEAFLET = Path("/usr/share/javascript/leaflet")  # Debian's libjs-leaflet
PAGE = Path(__file__).parent / "page"
MAX_UPLOAD = 100 * 1024 * 1024  # of an added image, bytes
THUMBNAIL = (128, 96)  # maximum width and height in the list, pixels
FULL_SIZE = (4096, 4096)  # maximum width and height of other images, pixels

_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; connect-src 'self'",
    "Cross-Origin-Resource-Policy": "same-origin",  # requests for images have no Origin header
    "X-Content-Type-Options": "nosniff",
}

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


def map_page(draft: PlaceMapDraft) -> web.Application:
    """Returns a web application that edits a draft.

    :raises FileNotFoundError: Leaflet is not installed
    """
    if not (LEAFLET / "leaflet.js").is_file():
        raise FileNotFoundError(2, "is missing: apt install libjs-leaflet", str(LEAFLET / "leaflet.js"))
    page = _Page(draft)
    application = web.Application(
        middlewares=[_from_this_machine_only, _report_errors], client_max_size=MAX_UPLOAD
    )
    application.on_response_prepare.append(_add_headers)
    application.add_routes(
        [
            web.get("/", page.index),
            web.get("/state", page.state),
            web.get("/image", page.image),
            web.post("/overview", page.choose_overview),
            web.post("/place", page.place),
            web.post("/remove", page.remove),
            web.post("/undo", page.undo),
            web.post("/add", page.add),
            web.static("/page", PAGE),
            web.static("/leaflet", LEAFLET, follow_symlinks=True),
        ]
    )
    return application


@web.middleware
async def _from_this_machine_only(request: web.Request, handler: Handler) -> web.StreamResponse:
    """Rejects requests from other origins (cross-site requests) and to other host names (DNS rebinding)."""
    port = request.transport.get_extra_info("sockname")[1]
    hosts = {f"{ADDRESS}:{port}", f"localhost:{port}"}
    origin = request.headers.get("Origin")
    is_cross_origin = origin is not None and origin not in {f"http://{host}" for host in hosts}
    if request.host not in hosts or is_cross_origin:
        return web.json_response({"error": "only the page of this machine is served"}, status=403)
    if request.method == "POST" and origin is None:
        return web.json_response({"error": "a POST request needs an Origin header"}, status=403)
    return await handler(request)


async def _add_headers(_request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(_HEADERS)


@web.middleware
async def _report_errors(request: web.Request, handler: Handler) -> web.StreamResponse:
    """Answers with the error as JSON."""
    try:
        return await handler(request)
    except web.HTTPException as error:
        return web.json_response({"error": error.reason}, status=error.status)
    except (ValueError, OSError) as error:
        return web.json_response({"error": str(error)}, status=400)


class _Page:
    """Request handlers; those that change the draft return the new state."""

    def __init__(self, draft: PlaceMapDraft):
        self._draft = draft
        self._thumbnails: Dict[Tuple[str, int], bytes] = {}

    async def index(self, request: web.Request) -> web.StreamResponse:
        return web.FileResponse(PAGE / "index.html")

    async def state(self, request: web.Request) -> web.StreamResponse:
        """Returns the state after reading the map file again; called when the page is loaded."""
        self._draft.reload()
        return self._answer()

    async def image(self, request: web.Request) -> web.StreamResponse:
        """Returns an image as JPEG; with the query field small a thumbnail."""
        image = request.query.get("image", "")
        path = self._draft.file(image)
        small = "small" in request.query
        key = (image, path.stat().st_mtime_ns)
        if not small:
            return web.Response(body=_jpeg(path, FULL_SIZE), content_type="image/jpeg")
        if key not in self._thumbnails:
            self._thumbnails[key] = _jpeg(path, THUMBNAIL)
        return web.Response(body=self._thumbnails[key], content_type="image/jpeg")

    async def choose_overview(self, request: web.Request) -> web.StreamResponse:
        self._draft.choose_overview(await _value(request, "image", str))
        return self._answer()

    async def place(self, request: web.Request) -> web.StreamResponse:
        image, x, y = [await _value(request, *each) for each in (("image", str), ("x", float), ("y", float))]
        self._draft.place(image, x, y)
        return self._answer()

    async def remove(self, request: web.Request) -> web.StreamResponse:
        self._draft.remove(await _value(request, "image", str))
        return self._answer()

    async def undo(self, request: web.Request) -> web.StreamResponse:
        self._draft.undo()
        return self._answer()

    async def add(self, request: web.Request) -> web.StreamResponse:
        form = await request.post()
        for field in form.values():
            if not isinstance(field, web.FileField):
                raise ValueError("expected an image")
            self._draft.add_file(field.filename, field.file.read())
        return self._answer()

    def _answer(self) -> web.Response:
        """The state of the draft as JSON."""
        place_map, placed = self._draft.place_map, self._draft.placed()
        photos = [
            {
                **{name: getattr(placed.get(image), name, None) for name in ("id", "x", "y")},
                "image": image,
                "guess": None if image in placed else self._draft.guess(image),
            }
            for image in self._draft.images()
        ]
        state = {
            "file": self._draft.path.name,
            "overview": place_map.overview._asdict() if place_map else None,
            "photos": photos,
            "undo": self._draft.can_undo,
        }
        return web.json_response(state)


async def _value(request: web.Request, name: str, kind: type) -> Any:
    """A value of the request's JSON body; raises ValueError if it is missing or of another type."""
    if request.content_type != "application/json":
        raise ValueError("expected JSON")
    values = await request.json()
    value = values.get(name) if isinstance(values, dict) else None
    if isinstance(value, bool) or not isinstance(value, (int, float) if kind is float else kind):
        raise ValueError(f"{name} is {value!r}, expected {kind.__name__}")
    try:
        return kind(value)
    except OverflowError:
        raise ValueError(f"{name} is too large") from None


def _jpeg(path: Path, size: Tuple[int, int]) -> bytes:
    """The upright image as JPEG, reduced to size."""
    upright, file = Image.fromarray(read_rgb(path, max(size))), io.BytesIO()
    upright.thumbnail(size)
    upright.save(file, "JPEG", quality=88)
    return file.getvalue()
