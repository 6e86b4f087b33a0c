"""One-time codes in the console: enrolled with an app, and asked for at the next login."""

import time

from service_app import PASSWORD

from rtron.service.domain.one_time_codes import code_at, step_at
from rtron.service.domain.principal import UserRole


def test_codes_are_enrolled_and_then_asked_for(console, page):
    for path in ("login/code", "me/second-factor"):
        page.expect_log(
            f"/api/v1/{path} - Failed to load resource: the server responded with a status of 403"
        )
    page.login("dev", "account")
    page.press("Enrol one-time codes …")
    page.fill("password", "of a stranger at the keyboard")
    page.press("Show the key")
    page.wait_for_text("the password is wrong")
    assert not page.all("code.secret")
    page.fill("password", PASSWORD)
    page.press("Show the key")
    key = page.text("code.secret")
    assert page.find("svg.qr").size["width"] > 150
    step = step_at(time.time_ns())
    page.fill("code", code_at(key, step))
    page.press("Enrol")
    recovery = page.text("code.recovery").split("\n")
    assert len(recovery) == 10
    page.press("I have kept them")
    page.wait_for_text("A login takes a one-time code. 10 recovery codes are left.")
    page.press("Log out")
    begin_login(page)
    page.fill("code", code_at(key, step))  # it was used
    page.press("Log in")
    page.wait_for_text("used before")
    assert not page.all("nav.side")
    page.fill("code", recovery[0])
    page.press("Log in")
    page.find("nav.side")
    page.go("account")
    page.wait_for_text("9 recovery codes are left")
    page.fill("code", recovery[1])
    page.press("Remove")
    page.wait_for_text("You log in with the password alone.")


def test_a_required_code_is_enrolled_with_the_password_of_the_login(console, page):
    roles = frozenset({UserRole.DEVELOPER})
    object.__setattr__(console.app.state.service.config, "second_factor_roles", roles)
    page.expect_log("/api/v1/robots?states=false&limit=1000 - Failed to load resource")
    page.browser.get(page.base)
    begin_login(page)
    page.wait_for_text("Your role requires one-time codes")
    before = page.text("code.secret")
    page.browser.refresh()
    page.fill("password", PASSWORD)
    page.press("Show the key")
    key = page.text("code.secret")
    assert key != before
    page.fill("code", code_at(key, step_at(time.time_ns())))
    page.press("Enrol")
    page.press("I have kept them")
    page.find("nav.side")


def begin_login(page):
    page.find("main.login form")
    page.fill("name", "dev")
    page.fill("password", PASSWORD)
    page.press("Log in")
