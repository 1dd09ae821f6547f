"""Pages in a headless Chromium, where the machine has one."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect, sync_playwright

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
WIDE, NARROW = (1440, 900), (390, 844)
PATIENCE = 20_000.0  # ms
AXE = Path(__file__).parent / "axe" / "axe.min.js"
needs_chromium = pytest.mark.skipif(
    CHROMIUM is None, reason="no chromium here: apt-get install chromium"
)


@contextmanager
def launched() -> Iterator[Browser]:
    """Return a browser."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(ARGUMENTS))
        try:
            yield browser
        finally:
            browser.close()


@dataclass
class Tab:
    """A page that is open, what it asked for, and what went wrong in it."""

    page: Page
    asked: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def __call__(self, selector: str) -> Locator:
        return self.page.locator(selector)

    def text(self, selector: str) -> str:
        return self.page.locator(selector).first.inner_text()

    def shows(self, selector: str, text: str) -> None:
        """Wait until an element has exactly this text."""
        expect(self.page.locator(selector).first).to_have_text(text, timeout=PATIENCE)

    def has(self, selector: str) -> None:
        """Wait until there is such an element."""
        self.page.locator(selector).first.wait_for(state="attached")

    def now(self) -> float:
        """Return the time (s) of the page's clock."""
        return self.page.evaluate("() => Date.now()") / 1000.0

    def pause(self) -> None:
        """Let the page's clock run only when the test says so."""
        self.page.clock.pause_at(self.now() + 1.0)

    def until(self, wanted: Callable[[], bool]) -> None:
        """Wait until something holds."""
        for _ in range(1000):
            if wanted():
                return
            self.page.wait_for_timeout(20)
        raise AssertionError(f"never true; errors of the page: {self.errors}")


@contextmanager
def opened(
    browser: Browser,
    address: str,
    size: tuple[int, int] = WIDE,
    *,
    shows: str = "#state",
    clock: bool = False,
    **options: Any,
) -> Iterator[Tab]:
    """Open a page in a browser of its own.

    Args:
        browser: where.
        address: of the page.
        size: of the window, px.
        shows: what is waited for.
        clock: the page's clock can be paused.
        options: further options of the context.
    """
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, **options)
    context.set_default_timeout(PATIENCE)
    tab = Tab(context.new_page())
    context.on("request", lambda it: tab.asked.append(it.url))
    tab.page.on("websocket", lambda it: tab.asked.append(it.url))
    tab.page.on("pageerror", lambda it: tab.errors.append(str(it)))
    tab.page.on("console", lambda it: it.type == "error" and tab.errors.append(it.text))
    if clock:
        tab.page.clock.install()
    try:
        tab.page.goto(address)
        tab.has(shows)
        yield tab
    finally:
        context.close()
