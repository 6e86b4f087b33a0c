"""The real service with a simulated guard, and Debian's chromium to look at it."""

import os
import shutil

import httpx
import pytest
from console_guard import SimulatedGuard
from console_robot import FIXTURE, plan
from harness import wait_for
from service_app import PASSWORD, AccountFactory, serve_in_thread

from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
ARGUMENTS = (
    "--headless=new",
    "--window-size=1440,950",
    "--disable-gpu",
    "--disable-dev-shm-usage",
)


class Console:
    """A running service with people and a robot, for a browser to look at."""

    def __init__(self, app, port):
        self.app, self.port = app, port
        self.people = AccountFactory(app.state.service)
        self.base = f"http://127.0.0.1:{port}"
        self.guards = []
        for name, roles in (
            ("ada", ("admin", "developer", "end_user")),
            ("dev", ("developer",)),
            ("eva", ("end_user",)),
        ):
            self.people.add_user(name, *roles)

    def guard(self, robot="turtle1", guard_plan=None):
        """Connect a simulated guard, and wait until the service has its state."""
        headers = self.people.token_headers(robot, "guard", robot=robot)
        guard = SimulatedGuard(self.port, headers, guard_plan or plan())
        self.guards.append(guard)
        hub = self.app.state.service.hub
        wait_for(lambda: hub.state(robot) is not None)
        return guard

    def upload(self, robot="turtle1", data=None):
        """Upload the robot's interaction graph."""
        answer = self.call("PUT", f"/robots/{robot}/graph", content=data or FIXTURE.read_bytes())
        assert answer.status_code == 200, answer.text

    def call(self, method, path, name="ada", **more):
        """Call the API in the name of somebody."""
        url = f"{self.base}/api/v1{path}"
        return httpx.request(
            method, url, headers=self.people.session_headers(name), timeout=60, **more
        )

    def close(self):
        for guard in self.guards:
            guard.close()


@pytest.fixture
def console(tmp_path):
    app = create_app(ServiceConfig(database=tmp_path / "rtron.db"))
    with serve_in_thread(app) as port:
        made = Console(app, port)
        yield made
        made.close()


@pytest.fixture
def guard(console):
    """The guard of turtle1."""
    return console.guard()


@pytest.fixture(scope="session")
def chromium():
    if not (CHROMIUM and DRIVER):
        pytest.skip("needs Debian's chromium and chromium-driver")
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs Selenium")
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    for argument in (*ARGUMENTS, *(["--no-sandbox"] if os.geteuid() == 0 else [])):
        options.add_argument(argument)
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield browser
    browser.quit()


@pytest.fixture
def page(console, chromium):
    """The console in the browser; after the test nothing was refused or thrown there."""
    from console_page import Page  # noqa: PLC0415 - needs selenium

    chromium.get_log("browser")
    chromium.delete_all_cookies()
    opened = Page(chromium, console.base, PASSWORD)
    yield opened
    chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    messages = [line for line in chromium.get_log("browser") if not opened.is_expected_log(line)]
    chromium.get("about:blank")
    assert messages == []
