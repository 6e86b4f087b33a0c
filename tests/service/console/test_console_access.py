"""axe-core finds nothing serious in any view, in light, in dark and on a phone."""

from importlib.resources import files
from importlib.util import find_spec

import pytest
from asked_guard import AskedGuard
from console_fleet import alarm, stored_fleet
from console_page import VIEWS
from incident_reports import a_report
from leased_base import AGENT, NAV
from leased_guard import LeasedGuard

from rtron.wire.common.link_protocol import IncidentSaved

pytestmark = pytest.mark.skipif(
    find_spec("axe_core_python") is None, reason="needs axe-core: pip install axe-core-python"
)
RUN = """
const done = arguments[arguments.length - 1];
const runOnly = arguments[0].length ? { runOnly: arguments[0] } : {};
axe.run(document, { resultTypes: ["violations"], ...runOnly }).then((found) => done(found.violations
  .filter((each) => ["serious", "critical"].includes(each.impact))
  .map((each) => [each.id, each.nodes.map((node) => node.html.slice(0, 200))])),
  (error) => done([String(error)]));
"""


@pytest.fixture(scope="module")
def axe():
    return (files("axe_core_python") / "axe.min.js").read_text(encoding="utf-8")


def findings(page, axe, *rules):
    """Return what is serious by these rules of axe's, by all if none is named."""
    if not page.browser.execute_script("return 'axe' in window"):
        page.browser.execute_script(axe)
    return page.browser.execute_async_script(RUN, rules)


def show_theme(page, theme):
    """Show a theme; its colours are there at once, not after a while."""
    page.browser.execute_script(
        "document.documentElement.dataset.theme = arguments[0];"
        "document.getAnimations().filter((each) => each.transitionProperty)"
        ".forEach((each) => each.finish());",
        theme,
    )


def on_all_screens(page, axe):
    """Return what is serious on a phone and on a wide screen."""
    found = []
    for width in (360, 1440):
        page.resize(width)
        found += findings(page, axe)
    return found


def test_no_view_has_a_serious_finding(console, guard, page, axe):
    """What is dark differs in its colours alone."""
    console.upload()
    guard.attack()
    guard.send(IncidentSaved(report=a_report()))
    settings = {
        "revision": 0,
        "reason": "mine first",
        "nodes": {"grcn_cmd_vel": {"policy": "Block"}},
    }
    assert console.call("PATCH", "/robots/turtle1/settings", json=settings).status_code == 200
    rollout = {
        "robots": {"names": ["turtle1"]},
        "reason": "visitors",
        "nodes": {"grcn_cmd_vel": {"policy": "FIFO_Queue"}},
    }
    assert console.call("POST", "/rollouts", json=rollout).status_code == 201
    page.login()
    found = {}
    for view in VIEWS:
        page.go(view)
        page.until(lambda: not page.all("[aria-busy]"), f"{view} is loaded")
        show_theme(page, "light")
        serious = findings(page, axe)
        show_theme(page, "dark")
        if serious := serious + findings(page, axe, "color-contrast"):
            found[view] = serious
    assert found == {}


def test_who_is_in_command_has_no_serious_finding(console, page, axe):
    leased = console.connect(LeasedGuard, every=0.5)
    leased.ask(NAV, "acquire a goal")
    page.login("ada", "robots/turtle1/command")
    page.wait_for_text("acquired: a goal")
    assert on_all_screens(page, axe) == []
    page.press(f"Give to {AGENT} …")
    page.wait_for_text("loses it", "dialog")
    assert on_all_screens(page, axe) == []


def test_a_request_has_no_serious_finding(console, page, axe):
    console.connect(AskedGuard, every=0.5).ask_person()
    page.login("ada", "robots/turtle1/command")
    page.wait_for_text("publish /goal")
    assert on_all_screens(page, axe) == []
    page.press("Approve request 1 …")
    page.wait_for_text("exactly this once", "dialog")
    assert on_all_screens(page, axe) == []


def test_the_table_and_its_dialogs_have_no_serious_finding(console, page, axe):
    fleet = stored_fleet(console.app.state.service, [f"robot{n}" for n in range(60)])
    fleet.state("robot5", alarms=(alarm(),))
    fleet.disconnect("robot6")
    page.login()
    page.wait_for_text("60 robots")
    assert on_all_screens(page, axe) == []
    page.press("Acknowledge 1 alarm …")
    page.wait_for_text("Your name and the note", "dialog")
    assert on_all_screens(page, axe) == []
    page.press("Cancel", "dialog")
    page.press("Emergency stop")
    page.wait_for_text("Stop 60 robots", "dialog")
    assert on_all_screens(page, axe) == []


def test_the_login_has_no_serious_finding(console, page, axe):
    page.browser.get(console.base)
    page.find("main.login")
    assert findings(page, axe) == []
