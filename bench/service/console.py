"""How long the console takes to load in Chromium, with all the events of `ingest` stored.

From the start of the navigation until what the page is for can be read, with nothing in the
browser's cache.
"""

import shutil
import statistics
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bench.service.service_process import ServiceProcess, rtron_command
from figures.figure import Figure

_AT_MOST_MS = 1000.0
_PATIENCE_S = 30.0
_LOADS = 5
_VIEWS = {
    "overview": ("", "#content a[href*=robot0]"),
    "events": ("events", "#content .event"),
    "coordination": ("robots/robot0/nodes", "#content h1"),
}
_ARGUMENTS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--window-size=1440,950",
)


def page_loads(folder: Path, database: Path, unit: str) -> Iterator[Figure]:
    """Give how long each view takes; without Chromium nothing."""
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        return
    with (
        ServiceProcess(folder, database, "--log-level", "warning") as service,
        open_browser() as browser,
    ):
        log_in(service, browser)
        for name, (view, selector) in _VIEWS.items():
            spent = [_load(browser, f"{service.url}/#/{view}", selector) for _ in range(_LOADS)]
            took = statistics.median(spent)
            yield Figure(f"console.{name}", took, None, unit, at_most=_AT_MOST_MS)


def log_in(service: ServiceProcess, browser: Any) -> None:  # noqa: ANN401 - selenium has no types
    """Log in as a new user with all that the console shows."""
    password = service.folder / "viewer.password"
    words = ["user", "add", "viewer", "--role", "admin", "--role", "developer"]
    words += ["--password-file", str(password), "--database", service.database]
    subprocess.run(rtron_command(*words), check=True, capture_output=True)
    browser.get(service.url)
    wait(browser, "input[name=password]")
    browser.find_element("css selector", "input[name=name]").send_keys("viewer")
    field = browser.find_element("css selector", "input[name=password]")
    field.send_keys(password.read_text().strip() + "\n")
    wait(browser, "nav.side")


def _load(browser: Any, address: str, selector: str) -> float:  # noqa: ANN401
    """Return how long a page takes, ms."""
    browser.get("about:blank")
    browser.execute_cdp_cmd("Network.clearBrowserCache", {})
    browser.get(address)
    wait(browser, selector)
    return float(browser.execute_script("return performance.now()"))


def wait(browser: Any, selector: str) -> None:  # noqa: ANN401
    """Wait until an element is there."""
    deadline = time.monotonic() + _PATIENCE_S
    while not browser.find_elements("css selector", selector):
        if time.monotonic() > deadline:
            raise TimeoutError(f"{selector} does not appear")
        time.sleep(0.005)


@contextmanager
def open_browser() -> Iterator[Any]:
    """Run Chromium until the end of the block."""
    from selenium import webdriver  # noqa: PLC0415 - the other parts need no browser

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for argument in _ARGUMENTS:
        options.add_argument(argument)
    service = webdriver.ChromeService(shutil.which("chromedriver"))
    browser = webdriver.Chrome(options=options, service=service)
    try:
        yield browser
    finally:
        browser.quit()
