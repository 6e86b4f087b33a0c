"""Debian's Chromium without a window, for the tests of pages."""

import os
import shutil
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp
from time import monotonic

import pytest

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
REMOVAL_LIMIT_S = 10
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
    with _folder_of_its_own() as folder:
        service = webdriver.ChromeService(DRIVER, env=os.environ | {"TMPDIR": folder})
        browser = webdriver.Chrome(options=options, service=service)
        try:
            yield browser
        finally:
            browser.quit()


@contextmanager
def _folder_of_its_own():
    """Yield a folder for what a browser leaves behind; its processes end after the driver's."""
    folder = mkdtemp(prefix="rtron-")
    try:
        yield folder
    finally:
        until = monotonic() + REMOVAL_LIMIT_S
        while Path(folder).exists():
            shutil.rmtree(folder, ignore_errors=monotonic() < until)
