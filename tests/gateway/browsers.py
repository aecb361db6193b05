"""A real browser for the tests of the web console: Debian's Chromium through playwright. Without them those tests skip by name."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from pluto_bt.runtime.clock import wall_ns

PATIENCE_MS = 60_000
DESK, PHONE, ACROSS = (1440, 900), (390, 844), (844, 390)


@contextmanager
def chromium() -> Iterator[Any]:
    """The browser, once for a test file."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("Chromium is not installed")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


class Screen:
    """One page in a context of its own. `complaints`: what the page wrote as an error to its console, or threw."""

    def __init__(self, browser: Any, url: str, size: tuple[int, int] = DESK) -> None:
        self.context = browser.new_context(viewport={"width": size[0], "height": size[1]}, has_touch=size == PHONE)
        self.page = self.context.new_page()
        self.page.set_default_timeout(PATIENCE_MS)
        self.complaints: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text) if message.type == "error" else None)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(url)

    def text(self, selector: str) -> str:
        """What a person reads there."""
        return str(self.page.inner_text(selector))

    def waits_for(self, selector: str, *words: str) -> None:
        """Until the text there holds all the words."""
        self.page.wait_for_function(
            "([selector, words]) => words.every((one) => document.querySelector(selector)?.textContent.includes(one))",
            arg=[selector, list(words)],
        )

    def until(self, is_so: Callable[[], bool]) -> None:
        """Until the robot has what the page sent; a page that sends nothing ends the test by its time."""
        until_ns = wall_ns() + PATIENCE_MS * 1_000_000
        while not is_so():
            assert wall_ns() < until_ns, "the page did not do it"
            self.page.wait_for_timeout(5)

    def click(self, selector: str) -> None:
        self.page.click(selector)

    def taps(self, x_m: float, y_m: float) -> None:
        """Tap the map at a place, given in metres."""
        x, y = self.page.evaluate("([x, y]) => window.pluto.map.view.toScreen(x, y)", [x_m, y_m])
        self.page.click("#map", position={"x": x, "y": y})

    def close(self) -> None:
        self.context.close()
