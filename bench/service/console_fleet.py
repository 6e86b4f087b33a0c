"""The console of a fleet in Chromium: a cold load over a slow line, and how fluent it stays.

The line is measured while the guards are away: 1,000 of them need the processor, too.

The line is emulated by the browser: 400 kbit/s each way, 600 ms until an answer begins. It adds
the latency to each request, but not to the connection before it.
"""

import shutil
import time
from collections.abc import Iterator
from typing import Any

from bench.common.testbed import ReportProgress, Testbed
from bench.service.console import log_in, open_browser, wait
from bench.service.fleet import create_tokens, run_fleet
from bench.service.service_process import ServiceProcess
from figures.figure import Figure

_ROBOTS = 1000
_CONNECT_S = 60.0
_WATCH_S = 15.0
_STOPS = 50
_BYTES_PER_SECOND = 400_000 / 8
_LATENCY_MS = 600
_SLOW_LINE = {
    "offline": False,
    "latency": _LATENCY_MS,
    "downloadThroughput": _BYTES_PER_SECOND,
    "uploadThroughput": _BYTES_PER_SECOND,
}
_FAST_LINE = {"offline": False, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
_AT_MOST_MS, _LONGEST_TASK_MS = 3000.0, 200.0
_COUNT_TASKS = """
window.longest = 0; window.frames_drawn = 0;
new PerformanceObserver((list) => list.getEntries().forEach((task) => {
  window.longest = Math.max(window.longest, task.duration);
})).observe({ type: "longtask" });
const draw = () => { window.frames_drawn += 1; requestAnimationFrame(draw); };
draw();
"""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the figures; without Chromium none."""
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        return
    folder = testbed.folder / "console"
    folder.mkdir()
    tokens = create_tokens(folder / "service.sqlite", _ROBOTS)
    with (
        ServiceProcess(folder, folder / "service.sqlite", "--log-level", "warning") as service,
        open_browser() as browser,
    ):
        progress(f"{_ROBOTS} guards connect")
        with run_fleet(testbed, service.port, tokens) as fleet:
            fleet.wait_connected(time.monotonic(), _CONNECT_S)
        progress("the console over a slow line")
        yield from _load_figures(service, browser, "cold_login", "main.login")
        log_in(service, browser)
        yield from _load_figures(service, browser, "cold_table", ".fleet td.name a")
        progress("a stop of all robots")
        yield _stop_figure(service, list(tokens))
        with run_fleet(testbed, service.port, tokens) as fleet:
            fleet.wait_connected(time.monotonic(), _CONNECT_S)
            progress("the console beside a fleet")
            yield from _fluency_figures(service, browser)


def _load_figures(
    service: ServiceProcess,
    browser: Any,  # noqa: ANN401 - selenium has no types
    name: str,
    selector: str,
) -> Iterator[Figure]:
    """Load the console with an empty cache until an element is there."""
    browser.get("about:blank")
    browser.execute_cdp_cmd("Network.enable", {})
    browser.execute_cdp_cmd("Network.clearBrowserCache", {})
    browser.execute_cdp_cmd("Network.emulateNetworkConditions", _SLOW_LINE)
    browser.get(service.url)
    wait(browser, selector)
    took = float(browser.execute_script("return performance.now()"))
    browser.execute_cdp_cmd("Network.emulateNetworkConditions", _FAST_LINE)
    requests, size = browser.execute_script(
        "const all = [...performance.getEntriesByType('navigation'),"
        " ...performance.getEntriesByType('resource')];"
        "return [all.length, all.reduce((sum, each) => sum + each.transferSize, 0)];"
    )
    unit = f"ms with {requests} requests, 400 kbit/s and 600 ms"
    yield Figure(f"console.{name}", took, None, unit, at_most=_AT_MOST_MS)
    yield Figure(f"console.{name}_size", size / 1000, None, "kB")


def _stop_figure(service: ServiceProcess, robots: list[str]) -> Figure:
    """Stop all robots as the console does: so many with each request, one after the other."""
    begin = time.monotonic()
    for first in range(0, len(robots), _STOPS):
        body = {"robots": robots[first : first + _STOPS], "reason": "a fire"}
        service.request("/api/v1/robots/stop", "POST", body)
    took = time.monotonic() - begin
    return Figure("console.stop_all", took, None, f"s until {len(robots)} stops were stored")


def _fluency_figures(
    service: ServiceProcess,
    browser: Any,  # noqa: ANN401 - selenium has no types
) -> Iterator[Figure]:
    """Look at the table while each robot tells an event and a state a second."""
    browser.get(service.url)
    wait(browser, ".fleet td.name a")
    browser.execute_script(_COUNT_TASKS)
    begin = time.monotonic()
    while time.monotonic() - begin < _WATCH_S:
        browser.execute_script("document.getElementById('content').scrollBy(0, 400)")
        time.sleep(0.25)
    seconds = time.monotonic() - begin
    longest, frames = browser.execute_script("return [window.longest, window.frames_drawn]")
    unit = f"ms, the longest of {seconds:.0f} s beside {_ROBOTS} guards"
    yield Figure("console.longest_task", longest, None, unit, at_most=_LONGEST_TASK_MS)
    yield Figure("console.frames", frames / seconds, None, "frames drawn a second")
