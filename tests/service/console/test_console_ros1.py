"""A person at the console, a real ROS 1 app under guard, and an attack: seen, and put an end to."""

import pytest
from console_page import Page
from harness import wait_for
from linked_app import FLOW1, FLOW2, ROBOT, LinkedApp

from bench.service.service_process import ServiceProcess

pytestmark = pytest.mark.ros1


@pytest.fixture
def app(ros1, tmp_path):
    with ServiceProcess(tmp_path) as service:
        yield LinkedApp(ros1, service)


@pytest.fixture
def page(app, chromium):
    chromium.delete_all_cookies()
    page = Page(chromium, app.service.url, app.service.password)
    page.login_by_form("admin")
    yield page
    chromium.get("about:blank")


@pytest.mark.long
def test_an_attack_is_seen_and_the_policy_that_ends_it_is_selected(app, page):
    nav = app.navigate()
    page.wait_for_text("/nav", "table")
    nav.kill()
    app.attack()
    wait_for(lambda: app.driven.turns() > 10, what="the rogue at the driver")
    page.wait_for_text("/rogue", "table")
    page.go(f"robots/{ROBOT}/nodes/grcn_cmd_vel")
    page.control("block of flow2").click()
    page.press("Review and put in force …")
    page.reason("it turns in circles")
    page.press("Put in force", "dialog")
    page.wait_for_text("applied")
    wait_for(app.rests, what="the driver's rest")
    turned = app.driven.turns()
    before = app.ros1.received("/rtron/grcn_cmd_vel", FLOW2)
    wait_for(
        lambda: app.ros1.received("/rtron/grcn_cmd_vel", FLOW2) > before + 50, what="the rogue"
    )
    assert app.driven.turns() == turned
    page.wait_for_text("block")
    page.go(f"robots/{ROBOT}/events")
    page.wait_for_text("flow2")


@pytest.mark.long
def test_a_stranger_is_seen_while_one_looks(app, page):
    app.navigate()
    page.wait_for_text("/nav", "table")
    app.attack_by_hand()
    page.go(f"robots/{ROBOT}/events")
    page.wait_for_text("unapproved")
    assert app.driven.turns() == 0


def test_the_emergency_stop_stops_the_base_until_it_is_taken_back(app, page):
    app.navigate()
    page.wait_for_text("/nav", "table")
    page.find("#stop").click()
    page.press(f"Stop {ROBOT} now", "dialog")
    wait_for(app.rests, what="the driver's rest")
    before = app.ros1.received("/rtron/grcn_cmd_vel", FLOW1)
    wait_for(lambda: app.ros1.received("/rtron/grcn_cmd_vel", FLOW1) > before + 5, what="nav")
    assert app.rests()
