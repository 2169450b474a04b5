# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page for placing photos, in a real browser; and what its server refuses."""

import asyncio
import json
import threading
import time
import urllib.error
import urllib.request

import cv2
import pytest
from aiohttp import web
from made_photos import picture
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from sextant.places.map_draft import MapDraft
from sextant.places.map_page import ADDRESS, map_page
from sextant.places.place_map_file import read_place_map

PATIENCE = 20.0  # seconds
CHROMIUM = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1200,800",
)


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


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "photos"
    folder.mkdir()
    return folder


@pytest.fixture
def served(folder):
    served = Served(MapDraft(folder / "map.txt"))
    yield served
    served.close()


@pytest.fixture
def browser():
    options = webdriver.ChromeOptions()
    for argument in CHROMIUM:
        options.add_argument(argument)
    browser = webdriver.Chrome(options=options)
    yield browser
    browser.quit()


def until(condition):
    """What condition() gives as soon as it is true."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError("it did not come true in time")


def written_picture(path, seed, size=(64, 48)):
    cv2.imwrite(str(path), picture(seed, size))
    return path


class Page:
    """What a user sees and does."""

    def __init__(self, browser, served):
        self.browser = browser
        browser.get(served.address)
        until(lambda: self.hint())

    def hint(self):
        return self.browser.find_element(By.ID, "hint").text

    def count(self):
        return self.browser.find_element(By.ID, "count").text

    def error(self):
        return self.browser.find_element(By.ID, "error").text

    def lines(self):
        script = "return [...document.querySelectorAll('#photos li')].map(line => line.dataset.image)"
        return self.browser.execute_script(script)

    def add(self, *paths):
        self.browser.find_element(By.ID, "files").send_keys("\n".join(map(str, paths)))

    def click_line(self, image):
        self.browser.find_element(By.CSS_SELECTOR, f"#photos li[data-image='{image}']").click()

    def overview(self):
        """Left, top, width and height on the screen."""
        box = self.browser.find_element(By.CSS_SELECTOR, ".leaflet-image-layer").rect
        return box["x"], box["y"], box["width"], box["height"]

    def click(self, x, y):
        """At parts of the overview's width and height."""
        left, top, width, height = self.overview()
        actions = ActionChains(self.browser)
        actions.w3c_actions.pointer_action.move_to_location(int(left + x * width), int(top + y * height))
        actions.w3c_actions.pointer_action.click()
        actions.perform()

    def drag_chosen(self, dx, dy):
        _, _, width, height = self.overview()
        dot = self.browser.find_element(By.CSS_SELECTOR, ".dot.chosen")
        ActionChains(self.browser).drag_and_drop_by_offset(dot, int(dx * width), int(dy * height)).perform()

    def press(self, *keys):
        actions = ActionChains(self.browser)
        for key in keys[:-1]:
            actions.key_down(key)
        actions.send_keys(keys[-1])
        for key in keys[:-1]:
            actions.key_up(key)
        actions.perform()


def photos_in(folder):
    path = folder / "map.txt"
    return {photo.image: (photo.x, photo.y) for photo in read_place_map(path).photos} if path.exists() else {}


def near(xy):
    return pytest.approx(xy, abs=4)  # a pixel of the screen is some of the overview


def test_from_an_empty_folder_to_a_finished_map(browser, served, folder, tmp_path):
    page = Page(browser, served)
    assert page.hint() == "Add an overview picture and photos: drop them here."
    paths = [written_picture(tmp_path / f"{i}.png", i) for i in range(1, 6)]
    page.add(written_picture(tmp_path / "whole.png", 0, (800, 600)), *paths)
    until(lambda: len(page.lines()) == 6)
    page.click_line("whole.png")
    until(lambda: page.count() == "0 of 5 photos placed")
    until(lambda: page.overview()[2] > 100)
    for i in range(1, 6):  # the next photo is chosen by itself
        page.click(0.1 * i, 0.5)
        until(lambda i=i: page.count() == f"{i} of 5 photos placed")
        assert photos_in(folder)[f"{i}.png"] == near((80 * i, 300))
    assert page.hint() == "All photos are placed. Drag a dot to correct it."

    page.click_line("2.png")
    page.drag_chosen(0.2, 0.25)
    until(lambda: photos_in(folder)["2.png"] == near((160 + 160, 300 + 150)))
    page.press(Keys.CONTROL, "z")
    until(lambda: photos_in(folder)["2.png"] == near((160, 300)))
    before = photos_in(folder)["2.png"]
    page.press(Keys.SHIFT, Keys.ARROW_UP)
    until(lambda: photos_in(folder)["2.png"] == pytest.approx((before[0], before[1] - 1)))
    page.press(Keys.ARROW_DOWN)
    page.press(Keys.DELETE)
    until(lambda: "3.png" not in photos_in(folder))
    page.press(Keys.CONTROL, "z")
    until(lambda: "3.png" in photos_in(folder))

    browser.save_screenshot(str(tmp_path / "page.png"))
    again = Page(browser, served)
    until(lambda: again.count() == "5 of 5 photos placed")
    assert again.error() == ""
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_what_is_no_picture_is_told_and_left_out(browser, served, folder, tmp_path):
    page = Page(browser, served)
    (tmp_path / "text.png").write_text("text")
    page.add(tmp_path / "text.png")
    until(lambda: page.error() == "text.png: is no picture")
    assert list(folder.iterdir()) == []


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
    "path", ["/", "/state", "/page/page.js", "/leaflet/leaflet.js", "/picture?image=1.png&small=1"]
)
def test_the_page_and_what_it_needs_is_served(begun, path):
    assert begun.ask(path)[0] == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example:80"},
        {"Host": "evil.example"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
    ],
)
@pytest.mark.parametrize("path", ["/state", "/picture?image=1.png"])
def test_other_origins_get_nothing(begun, headers, path):
    assert begun.ask(path, headers) == (403, '{"error": "only this machine\'s own page is served"}')


@pytest.mark.parametrize("origin", ["http://evil.example", "null", f"http://{ADDRESS}:1", None])
def test_other_origins_change_nothing(begun, folder, origin):
    assert begun.change("/place", {"image": "1.png", "x": 1, "y": 1}, Origin=origin)[0] == 403
    assert photos_in(folder) == {}


@pytest.mark.parametrize(
    "path", ["../secret.png", "%2e%2e/secret.png", "..%2fsecret.png", "/etc/passwd", "map.txt", ""]
)
def test_files_outside_are_not_served(begun, folder, path):
    written_picture(folder.parent / "secret.png", 9)
    assert begun.ask(f"/picture?image={path}")[0] == 400
    assert begun.ask(f"/page/{path}")[0] in (403, 404)


@pytest.mark.parametrize(
    "values, reason",
    [
        ({"image": "2.png", "x": 1, "y": 1}, "2.png: there is no such photo"),
        ({"image": "1.png", "x": 801, "y": 1}, "x is 801, outside the overview"),
        ({"image": "1.png", "x": "1", "y": 1}, "x is '1', expected float"),
        ({"image": "1.png", "x": True, "y": 1}, "x is True, expected float"),
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
