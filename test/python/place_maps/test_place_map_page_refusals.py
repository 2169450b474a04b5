# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the server of the page for placing photos gives, and what it refuses."""

import http.client
import json

import pytest
from served_page import PATIENCE, photos_in, written_picture

from sextant.place_maps.place_map_page import ADDRESS


@pytest.fixture
def begun(served, folder):
    written_picture(folder / "whole.png", 0, (800, 600))
    written_picture(folder / "1.png", 1)
    assert served.change("/overview", {"image": "whole.png"})[0] == 200
    return served


def test_a_click_is_saved_at_once(begun, folder):
    status, text = begun.change("/place", {"image": "1.png", "x": 12.5, "y": 30})
    assert status == 200 and json.loads(text)["photos"][0]["x"] == 12.5
    assert photos_in(folder) == {"1.png": (12.5, 30)}


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example:80"},
        {"Host": "evil.example"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
    ],
)
@pytest.mark.parametrize("path", ["/state", "/image?image=1.png"])
def test_other_origins_get_nothing(begun, headers, path):
    assert begun.ask(path, headers) == (403, '{"error": "only the page of this machine is served"}')


@pytest.mark.parametrize(
    "path, status, host",
    [
        ("/", 200, None),
        ("/state", 200, None),
        ("/image?image=1.png", 200, None),
        ("/image?image=1.png&small=1", 200, None),
        ("/page/page.js", 200, None),
        ("/leaflet/leaflet.js", 200, None),
        ("/image?image=2.png", 400, None),
        ("/nowhere", 404, None),
        ("/state", 403, "evil.example"),
    ],
)
def test_what_is_served_is_for_no_page_of_another_origin(begun, path, status, host):
    connection = http.client.HTTPConnection(ADDRESS, begun.port, timeout=PATIENCE)
    connection.request("GET", path, headers={"Host": host} if host else {})
    answer = connection.getresponse()
    connection.close()
    assert answer.status == status
    assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["Content-Security-Policy"].startswith("default-src 'none'; ")


@pytest.mark.parametrize("origin", ["http://evil.example", "null", f"http://{ADDRESS}:1", None])
def test_other_origins_change_nothing(begun, folder, origin):
    assert begun.change("/place", {"image": "1.png", "x": 1, "y": 1}, Origin=origin)[0] == 403
    assert photos_in(folder) == {}


@pytest.mark.parametrize(
    "path", ["../secret.png", "%2e%2e/secret.png", "..%2fsecret.png", "/etc/passwd", "map.txt", ""]
)
def test_files_outside_are_not_served(begun, folder, path):
    written_picture(folder.parent / "secret.png", 9)
    assert begun.ask(f"/image?image={path}")[0] == 400
    assert begun.ask(f"/page/{path}")[0] in (403, 404)


@pytest.mark.parametrize(
    "values, reason",
    [
        ({"image": "2.png", "x": 1, "y": 1}, "2.png: there is no such photo"),
        ({"image": "1.png", "x": 801, "y": 1}, "x is 801, outside the overview"),
        ({"image": "1.png", "x": "1", "y": 1}, "x is '1', expected float"),
        ({"image": "1.png", "x": True, "y": 1}, "x is True, expected float"),
        ({"image": "1.png", "x": float("nan"), "y": 1}, "x is nan, outside the overview"),
        ({"image": "1.png", "x": 10**400, "y": 1}, "x is too large"),
        ({"x": 1, "y": 1}, "image is None, expected str"),
        ([], "image is None, expected str"),
    ],
)
def test_a_change_that_cannot_be_is_refused(begun, folder, values, reason):
    status, text = begun.change("/place", values)
    assert status == 400 and reason in json.loads(text)["error"]
    assert photos_in(folder) == {}


def test_a_form_of_another_page_is_no_change(begun, folder):
    assert (
        begun.change("/place", {"image": "1.png", "x": 1, "y": 1}, **{"Content-Type": "text/plain"})[0] == 400
    )
    assert photos_in(folder) == {}


@pytest.mark.parametrize("name", ["../out.png", "map.txt", ".hidden.png", "a;b.png", "text.png"])
def test_a_file_that_is_no_image_or_leads_elsewhere_is_not_added(begun, folder, name):
    content = b"text" if name == "text.png" else (folder / "1.png").read_bytes() + b"other"
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    head = f'--edge\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n\r\n'
    headers = {"Origin": begun.address, "Content-Type": "multipart/form-data; boundary=edge"}
    status, text = begun.ask("/add", headers, head.encode() + content + b"\r\n--edge--\r\n")
    assert status == 400 and name in json.loads(text)["error"]
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert not (folder.parent / "out.png").exists()
