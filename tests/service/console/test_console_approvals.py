"""Four eyes in the console: one admin asks, another one approves."""

import pytest


@pytest.fixture
def strict_console(console):
    object.__setattr__(console.app.state.service.config, "four_eyes", True)
    console.people.add_user("eve", "admin")
    return console


def test_one_admin_asks_and_another_approves(strict_console, page):
    page.login("ada", "users")
    page.press("New user …")
    page.fill("name", "bob")
    page._type('dialog input[name="password"]', "a long enough password")
    page.press("Create", "dialog")
    page.wait_for_text("The change waits for a second admin, under Approvals.")
    page.go("approvals")
    page.wait_for_text("add user")
    (approve,) = [each for each in page.all("main button") if each.text == "Approve …"]
    assert not approve.is_enabled()
    assert "you have requested it" in approve.get_attribute("title")
    page.go("account")
    page.press("Log out")
    page.find("main.login form")
    page.login_by_form("eve", "approvals")
    page.press("Approve …")
    page.wait_for_text("ada has requested it: roles: end_user", "dialog")
    page.press("Approve", "dialog")
    page.wait_for_text("Nothing waits.")
    page.go("users")
    page.wait_for_text("bob")
