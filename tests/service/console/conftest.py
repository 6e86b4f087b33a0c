"""The real service with a simulated guard, and Debian's chromium to look at it."""

import json
import shutil
import time
from pathlib import Path

import httpx
import pytest
from app_graphs import AUTORACE
from console_fleet import NAMES, Fleet, store_robots
from console_guard import SimulatedGuard
from console_robot import plan
from harness import wait_for
from server_thread import bound_socket
from service_app import PASSWORD, TLS, AccountFactory, serve_in_thread

from chromium import open_chromium
from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app
from rtron.service.store.database import Database
from rtron.sources.graph_json import graph_to_json


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
        return self.connect(SimulatedGuard, guard_plan or plan(), robot=robot)

    def connect(self, guard_class, *values, robot="turtle1", **more):
        """Connect a guard of a class, and wait until the service has its state."""
        headers = self.people.token_headers(robot, "guard", robot=robot)
        guard = guard_class(self.port, headers, *values, **more)
        self.guards.append(guard)
        hub = self.app.state.service.hub
        wait_for(lambda: hub.state(robot) is not None, what="the guard's state")
        return guard

    def upload(self, robot="turtle1", data=None):
        """Upload the robot's interaction graph."""
        data = data or json.dumps(graph_to_json(AUTORACE)).encode()
        answer = self.call("PUT", f"/robots/{robot}/graph", content=data)
        assert answer.status_code == 200, answer.text

    def call(self, method, path, name="ada", **more):
        """Call the API in the name of somebody."""
        url = f"{self.base}/api/v1{path}"
        headers = self.people.session_headers(name)
        return httpx.request(method, url, headers=headers, timeout=60, verify=TLS, **more)

    def close(self):
        for guard in self.guards:
            guard.close()


@pytest.fixture(scope="session")
def fleet_file(migrated_file, tmp_path_factory):
    """Make a database file with 1,000 robots for tests to copy: each takes milliseconds."""
    path = Path(shutil.copy(migrated_file, tmp_path_factory.mktemp("fleet")))
    database = Database(path)
    store_robots(database, NAMES, time.time_ns())
    database.close()
    return path


@pytest.fixture(scope="session")
def console_port():
    """Have one port for all consoles: the browser keeps scripts that it has read from there."""
    with bound_socket() as holder:
        yield holder.getsockname()[1]


@pytest.fixture
def console(request, database_file, console_port):
    if "silent_fleet" in request.fixturenames:
        shutil.copy(request.getfixturevalue("fleet_file"), database_file)
    app = create_app(ServiceConfig(database=database_file))
    with serve_in_thread(app, port=console_port) as port:
        made = Console(app, port)
        yield made
        made.close()


@pytest.fixture
def guard(console):
    """The guard of turtle1."""
    return console.guard()


@pytest.fixture
def silent_fleet(console):
    """A fleet of 1,000 robots, each of which has told its state once."""
    return Fleet(console.app.state.service)


@pytest.fixture
def fleet(silent_fleet):
    """A fleet of 1,000 robots that tell their states each second."""
    with silent_fleet.speaking():
        yield silent_fleet


@pytest.fixture(scope="session")
def chromium():
    with open_chromium(1440, 950) as browser:
        yield browser


@pytest.fixture
def page(console, chromium):
    """The console in the browser; after the test nothing was refused or thrown there."""
    from console_page import Page  # noqa: PLC0415 - needs selenium

    chromium.get_log("browser")
    chromium.execute_cdp_cmd("Network.clearBrowserCookies", {})
    opened = Page(chromium, console.base, PASSWORD, console.people)
    yield opened
    chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    messages = [line for line in chromium.get_log("browser") if not opened.is_expected_log(line)]
    chromium.get("about:blank")
    assert messages == []


@pytest.fixture
def cold(page):
    """A browser with nothing in its cache, in which somebody is logged in."""
    page.login()
    page.browser.get("about:blank")
    page.browser.execute_cdp_cmd("Network.clearBrowserCache", {})
    return page
