"""Chromium without a window, for the tests of pages: Debian's headless shell, which costs least."""

import os
import shutil
from contextlib import contextmanager

import pytest

CHROMIUM, DRIVER = shutil.which("chromium-headless-shell"), shutil.which("chromedriver")
ARGUMENTS = (
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    # Each renderer takes a second of processor time, and a test shows one page.
    "--renderer-process-limit=1",
    "--disable-features=SpareRendererForSitePerProcess",
)


@contextmanager
def open_chromium(width=1600, height=1000):
    """Yield a browser with a window of so many pixels; skip where there is none."""
    if not (CHROMIUM and DRIVER):
        pytest.skip("needs Debian's chromium-headless-shell and chromium-driver")
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs Selenium")
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    as_root = ("--no-sandbox",) if os.geteuid() == 0 else ()
    for argument in (*ARGUMENTS, f"--window-size={width},{height}", *as_root):
        options.add_argument(argument)
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    try:
        yield browser
    finally:
        browser.quit()
