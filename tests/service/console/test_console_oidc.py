"""Single sign-on in the console, at a real provider, as somebody does it in a browser."""

import pytest
from oidc_provider import running_provider
from sqlalchemy import update

from rtron.service.api.auth.oidc_client import OidcClient
from rtron.service.api.routes.oidc import OidcSignIn
from rtron.service.domain.oidc import OidcConfig
from rtron.service.store.tables import SessionRow

# The provider is built on what Authlib wants to drop.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def provider(console):
    with running_provider() as provider:
        config = OidcConfig(
            issuer=provider.url,
            client_id="rtron",
            public_url=console.base,
            display_name="Example",
            roles={"robot-developers": ["developer"]},
        )
        console.app.state.oidc = OidcSignIn(config, OidcClient(config, "hush"))
        yield provider
        console.app.state.oidc.client.close()


def sign_in(page, sub):
    for file in ("/favicon.ico", "/pico.min.css"):  # of the provider's page
        page.expect_log(f"{file} - Failed to load resource")
    page.browser.get(f"{page.base}/")
    page.press("Log in with Example")
    page.press(sub, "body")


def test_who_signs_in_at_the_provider_is_in_the_console(provider, page):
    sign_in(page, "sub-mary")
    page.find("nav.side")
    page.until(lambda: not page.all(".banner"), "live")
    page.go("account")
    page.wait_for_text("mary", "#content")
    page.wait_for_text("developer", "#content")
    page.press("Log out")
    page.find("main.login form")


def test_codes_take_a_new_sign_in_at_the_provider(provider, console, page):
    sign_in(page, "sub-mary")
    page.find("nav.side")
    page.go("account")
    page.press("Enrol one-time codes …")
    page.press("Show the key")
    assert len(page.text("code.secret")) == 32
    with console.app.state.service.database.session() as session:
        begun = SessionRow.created - 601 * 1_000_000_000
        session.execute(update(SessionRow).values(created=begun))
    page.browser.refresh()
    page.press("Enrol one-time codes …")
    page.wait_for_text("Sign in once more, then enrol the codes within ten minutes.")
    page.press("Sign in again")
    page.press("sub-mary", "body")
    page.find("nav.side")
    page.go("account")
    page.press("Enrol one-time codes …")
    page.press("Show the key")
    page.find("code.secret")


def test_who_has_no_role_is_told_so(provider, page):
    sign_in(page, "sub-guest")
    page.wait_for_text("You have signed in, but have no role here.")
    page.wait_for_text("Ask an admin to map one of your groups to a role.")
    assert not page.all("nav.side")


def test_words_in_the_address_are_not_shown(console, page):
    page.browser.get(f"{page.base}/?sign_in=<b>call+0900</b>")
    page.find("main.login form")
    page.wait_without_text("0900")
    page.browser.get(f"{page.base}/?sign_in=constructor")
    page.find("main.login form")
    assert not page.all(".notice")
