"""What clients of a bridge ask for, in the console: seen word for word, answered by name."""

from functools import partial

import pytest
from asked_guard import GOAL, AskedGuard
from selenium.webdriver.common.keys import Keys

from rtron.bridge.protocol.approvals import WAITS_FOR
from rtron.bridge.rights.document import Approvers

VIEW = "robots/turtle1/command"
CONTENT = '{"pose":{"position":{"x":1,"y":3}}}'


@pytest.fixture
def connect(console):
    return partial(console.connect, AskedGuard, every=0.5)


@pytest.fixture
def guard(connect):
    return connect()


def test_a_person_is_led_to_a_request_and_approves_it_once(guard, page):
    page.login("eva")
    page.wait_without_text("for a person")
    guard.ask_person()
    page.wait_for_text("1 request of the bridge's clients waits for a person")
    page.press("1 request")
    page.wait_for_text(CONTENT, ".request")
    page.press("Approve request 1 …")
    page.wait_for_text(CONTENT, "dialog")
    page.wait_for_text("assistant may send exactly this once, within a minute.", "dialog")
    page.reason("the corridor is free")
    page.press("Approve", "dialog")
    page.wait_for_text("is approved by eva at the service", ".toasts")
    page.wait_for_text("No client of the bridge asks for anything.")
    assert guard.ask_person() == ""
    assert "request 2 waits" in guard.ask_person()


def test_a_person_refuses_with_the_keyboard_alone(guard, page):
    guard.ask_person()
    page.login("eva", VIEW)
    page.wait_for_text(CONTENT)
    refuse = page.all(".request button")[1]
    page.browser.execute_script("arguments[0].focus()", refuse)
    refuse.send_keys(Keys.ENTER)
    page.reason("not today")
    page.find("#dialog-reason").send_keys(Keys.ENTER)
    page.wait_for_text("is refused by eva at the service", ".toasts")
    assert "eva at the service has refused request 1" in guard.ask_person()


def test_a_dialog_that_stood_open_for_too_long_approves_nothing(guard, page):
    page.expect_log("status of 409")
    guard.ask_person()
    page.login("eva", VIEW)
    page.press("Approve request 1 …")
    guard.passed = WAITS_FOR
    assert "request 2 waits" in guard.ask_person()
    page.wait_for_text("Approve request 2 …", "#content")
    page.reason("an old click")
    page.press("Approve", "dialog")
    page.wait_for_text("this request does not wait any more", "dialog")
    assert guard.waiting() == [2]


@pytest.mark.parametrize("approvers", [Approvers(), Approvers(roles=("developer",))])
def test_whom_the_rights_do_not_name_only_looks(connect, page, approvers):
    connect(approvers).ask_person()
    page.login("eva", VIEW)
    page.wait_for_text(CONTENT)
    page.wait_for_text("You may not answer them here")
    assert not any(each.is_enabled() for each in page.all(".request button"))


def test_what_is_old_is_marked_and_cannot_be_answered(guard, page):
    guard.ask_person()
    page.login("eva", VIEW)
    page.until(lambda: all(x.is_enabled() for x in page.all(".request button")), "the buttons")
    guard.close()
    page.wait_without_text(CONTENT)


def test_more_requests_than_are_shown_are_counted(guard, page):
    for number in range(8):
        for client in ("rogue", "rogue_2", "assistant"):
            guard.ask_person({**GOAL, "number": number}, client)
    page.login("eva", VIEW)
    page.wait_for_text("24 requests wait")
    page.wait_for_text("8 more requests, shown when these are answered.")
    assert len(page.all(".request")) == 16


def test_the_table_of_a_fleet_has_who_waits_for_a_person(guard, console, page):
    guard.ask_person()
    for number in range(6):
        console.guard(f"other{number}")
    page.login("eva")
    page.wait_for_text("asked", ".fleet")
    page.wait_for_text("1 request of the bridge's clients waits for a person", ".fleet")
