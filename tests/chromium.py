"""Debian's Chromium without a window, for the tests of pages."""

import os
import shutil
from contextlib import contextmanager

import pytest

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
ARGUMENTS = (
    "--headless=new",
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
        pytest.skip("needs Debian's chromium and chromium-driver")
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
