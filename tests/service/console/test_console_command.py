"""Who is in command, in the console: seen by all, changed by who may, by name and reason."""

from functools import partial

import pytest
from leased_base import AGENT, NAV, PLAN, TELEOP
from leased_guard import LeasedGuard

VIEW = "robots/turtle1/command"


@pytest.fixture
def connect(console):
    return partial(console.connect, LeasedGuard, every=0.5)


@pytest.fixture
def guard(connect):
    return connect()


def test_a_person_takes_over_by_rank_renews_and_ends_and_all_see_it(guard, page):
    guard.ask(NAV, "acquire a goal has come")
    page.login("eva", VIEW)
    page.wait_for_text("acquired: a goal has come")
    page.press(f"Give to {AGENT} …")
    page.wait_for_text(f"{NAV} (autonomy) loses it, and the robot stops.", "dialog")
    page.reason("the door is shut")
    page.press("Give", "dialog")
    page.wait_for_text("given by eva (remote_operator): the door is shut")
    assert guard.held().holder == AGENT
    page.press("Renew")
    page.wait_for_text("base is renewed for 2.00 s", ".toasts")
    page.press("Take it away …")
    page.reason("lunch")
    page.press("Take it away", "dialog")
    page.wait_for_text("nobody is in command", ".card")
    assert guard.held().holder == ""
    page.wait_for_text("end by eva (remote_operator): base is taken from /agent", ".events")
    page.wait_for_text("acquire by /nav", ".events")
    assert len(page.all(".event")) == 3


def test_what_the_guard_refuses_is_said_in_the_dialog(guard, page):
    page.expect_log("status of 409")
    guard.ask(TELEOP, "acquire docking")
    page.login("eva", VIEW)
    page.wait_for_text("acquired: docking")
    page.press(f"Give to {NAV} …")
    page.reason("a trial")
    page.press("Give", "dialog")
    page.wait_for_text("eva (remote_operator) has no higher rank", "dialog")
    assert guard.held().holder == TELEOP


def test_where_the_plan_gives_people_no_rank_they_only_look(connect, page):
    connect(PLAN).ask(NAV, "acquire a goal")
    page.login("eva", VIEW)
    page.wait_for_text("acquired: a goal")
    page.wait_for_text("The plan lets nobody here change who is in command")
    buttons = [each for each in page.all("#content button") if each.text.startswith("Give")]
    assert len(buttons) == 3
    assert not any(each.is_enabled() for each in buttons)


def test_what_is_old_is_marked_and_changes_nothing(guard, page):
    guard.ask(NAV, "acquire a goal")
    page.login("eva", VIEW)
    page.wait_for_text("acquired: a goal")
    guard.close()
    page.wait_for_text("not known now")
    assert not any(each.is_enabled() for each in page.all("#content table button"))


def test_a_plan_without_leases_says_so(console, page):
    console.guard()
    page.login("eva", VIEW)
    page.wait_for_text("The plan has no leases")
