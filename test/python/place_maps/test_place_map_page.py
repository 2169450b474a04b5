# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page for placing photos, in a real browser."""

import inspect
import shutil
import time

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from served_page import PATIENCE, photos_in, written_picture

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


@pytest.fixture
def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for argument in CHROMIUM:
        options.add_argument(argument)
    driver = (
        shutil.which("chromedriver") or ""
    )  # given, because new versions of selenium look for one to download
    if "service" in inspect.signature(webdriver.Chrome.__init__).parameters:
        browser = webdriver.Chrome(options=options, service=Service(driver))
    else:  # Debian 11
        browser = webdriver.Chrome(driver, options=options)
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


def near(xy):
    return pytest.approx(xy, abs=4)  # a pixel of the screen is some of the overview


@pytest.mark.slow
def test_from_an_empty_folder_to_a_finished_map(browser, served, folder, tmp_path):
    page = Page(browser, served)
    assert page.hint() == "Add an overview image and photos: drop them here."
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


@pytest.mark.slow
def test_what_is_no_image_is_reported_and_left_out(browser, served, folder, tmp_path):
    page = Page(browser, served)
    (tmp_path / "text.png").write_text("text")
    page.add(tmp_path / "text.png")
    until(lambda: page.error() == "text.png: is not an image")
    assert list(folder.iterdir()) == []


@pytest.mark.slow
def test_what_another_program_wrote_is_kept_and_shown_when_the_page_is_reloaded(browser, served, folder):
    written_picture(folder / "whole.png", 0, (800, 600))
    for i in (1, 2):
        written_picture(folder / f"{i}.png", i)
    served.change("/overview", {"image": "whole.png"})
    page = Page(browser, served)
    until(lambda: page.overview()[2] > 100)
    (folder / "map.txt").write_text("whole.png;800;600\n4;2.png;100;200\n")
    page.click(0.5, 0.5)
    until(lambda: "map.txt: was changed by another program, so this step is not saved" in page.error())
    assert photos_in(folder) == {"2.png": (100, 200)} and page.count() == "0 of 2 photos placed"
    page = Page(browser, served)
    until(lambda: page.count() == "1 of 2 photos placed")
    until(lambda: page.overview()[2] > 100)
    page.click(0.5, 0.5)
    until(lambda: page.count() == "2 of 2 photos placed")
    assert photos_in(folder) == {"1.png": near((400, 300)), "2.png": (100, 200)} and page.error() == ""
