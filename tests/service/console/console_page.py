"""The console as a person uses it: looks for words and presses what has a name."""

from contextlib import contextmanager

from incident_reports import NAME
from selenium.common.exceptions import (
    ElementClickInterceptedException,
    ElementNotInteractableException,
    NoSuchElementException,
    StaleElementReferenceException,
    TimeoutException,
)
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

_HOLDERS = """
const strip = (text) => text.replace(/\\s/g, "").toLowerCase(), words = strip(arguments[1]);
const holders = (element) => {
    if (!strip(element.textContent).includes(words)) return [];
    const inner = [...element.children].flatMap(holders);
    return inner.length ? inner : [element];
};
return holders(arguments[0]);
"""
"""Return the innermost elements that have words: what is visible of the whole page costs more."""
_RESTS = """
const [element, done] = arguments, place = () => JSON.stringify(element.getBoundingClientRect());
const before = place();
requestAnimationFrame(() => requestAnimationFrame(() => done(before === place())));
"""
"""Tells whether an element keeps its place: a click on one that moves may miss it."""
_LABELLED = """
const strip = (text) => text.replace(/\\s/g, "").toLowerCase();
const root = document.querySelector(arguments[0]);
return [...(root?.querySelectorAll("button, a") ?? [])]
    .filter((each) => strip(each.textContent) === strip(arguments[1]));
"""
_GO = """
const [hash, done] = arguments, before = location.href;
location.hash = hash;
if (location.href === before) done();
else addEventListener("hashchange", () => requestAnimationFrame(() => setTimeout(done)));
"""
_RECORD_FRAMES = """
window.receivedFrames = [];
window.WebSocket = class extends WebSocket {
    constructor(...parts) {
        super(...parts);
        this.addEventListener("message", (event) => window.receivedFrames.push(event.data));
    }
};
"""
_NODES = ("nodes", "nodes/grcn_cmd_vel", "nodes/rsrcn", "nodes/msrcn")
_ROBOT = ("now", "command", "graph", "risks", *_NODES, "rules", "events", "incidents", "settings")
_ROLLOUTS = ("rollouts", "rollouts/new", "rollouts/1")
_ACCOUNTS = ("users", "tokens", "webhooks", "approvals", "account")
ROBOT_VIEWS = tuple(f"robots/turtle1/{view}" for view in _ROBOT)
_SERVICE_VIEWS = ("", "shift", "events", "audit", *_ACCOUNTS, *_ROLLOUTS, "incidents")
VIEWS = (*_SERVICE_VIEWS, *ROBOT_VIEWS, f"robots/turtle1/incidents/{NAME}")
PASSING = (
    NoSuchElementException,
    StaleElementReferenceException,
    TimeoutException,
    ElementClickInterceptedException,
    ElementNotInteractableException,
)


class Page:
    """One browser window with the console in it."""

    def __init__(self, browser, base, password, people=None):
        """Show the service at `base`; `people` makes sessions of its users, who have a password."""
        self.browser, self.base, self.password, self.people = browser, base, password, people
        self._expected = [
            "/api/v1/me - Failed to load resource: the server responded with a status of 401"
        ]

    def expect_log(self, text):
        """Let the browser's console say this: a refusal that is part of the test."""
        self._expected.append(text)

    def is_expected_log(self, line):
        return line["level"] in ("DEBUG", "INFO") or any(
            t in line["message"] for t in self._expected
        )

    def resize(self, width, height=900, scale=1):
        """Show the window on a screen of this size; a narrow one is a phone's."""
        size = {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": width < 500}
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    def show_on_phone(self):
        self.resize(360, 740, scale=2)

    def login(self, name="ada", view=""):
        """Open a view with the session of somebody, as if he had logged in."""
        key, _, secret = self.people.session_headers(name)["Cookie"].partition("=")
        cookie = {"name": key, "value": secret, "url": self.base, "httpOnly": True}
        self.browser.execute_cdp_cmd("Network.setCookie", {**cookie, "sameSite": "Strict"})
        self.browser.get(f"{self.base}/#/{view}")
        self._wait_until_live()

    def login_by_form(self, name="ada", view=""):
        """Log in with the name and the password."""
        self.browser.get(f"{self.base}/#/{view}")
        self.fill("name", name)
        self.fill("password", self.password)
        self.press("Log in")
        self._wait_until_live()

    def _wait_until_live(self):
        self.find("nav.side")
        self.until(lambda: not self.all(".banner"), "live")

    def download_to(self, folder):
        """Let the browser store downloads there without asking."""
        allow = {"behavior": "allow", "downloadPath": str(folder)}
        self.browser.execute_cdp_cmd("Page.setDownloadBehavior", allow)

    def await_download(self, file):
        """Wait until a file is written: the browser takes its name first."""
        self.until(lambda: file.exists() and file.stat().st_size, file.name)

    def go(self, view):
        """Go to a view; it is drawn, but may still be loading."""
        self.browser.execute_async_script(_GO, f"#/{view}")

    def until(self, condition, what="it", seconds=60):
        """Wait until a condition holds; say what was waited for, and what was shown instead."""
        waiting = WebDriverWait(self.browser, seconds, 0.05, ignored_exceptions=PASSING)
        try:
            return waiting.until(lambda _: condition())
        except TimeoutException:
            shown = self.browser.execute_script("return document.body.innerText")
            raise TimeoutException(f"{what}; shown is: {shown[:2000]}") from None

    def all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def find(self, selector):
        return self.until(lambda: self.browser.find_element(By.CSS_SELECTOR, selector), selector)

    def text(self, selector="#content"):
        return self.until(lambda: self.find(selector).text or True, selector)

    def wait_for_text(self, words, selector="#app"):
        """Wait until these words are shown."""
        return self.until(lambda: self.shows(words, selector), f"{words!r} in {selector}")

    def wait_without_text(self, words, selector="#app"):
        """Wait until there is such an element, and these words are not shown in it."""
        self.until(lambda: not self.shows(words, selector), f"no {words!r} in {selector}")

    def shows(self, words, selector):
        """Tell whether words are shown; the costly look at what is visible comes last."""
        element = self.browser.find_element(By.CSS_SELECTOR, selector)
        holders = self.browser.execute_script(_HOLDERS, element, words)
        return any(words in each.text for each in holders) or (holders and words in element.text)

    def control(self, label):
        """Return the form control with this aria-label."""
        return self.find(f'[aria-label="{label}"]')

    def press(self, words, within="#app"):
        """Press the button or link with these words."""

        def act():
            for each in self.browser.execute_script(_LABELLED, within, words):
                is_ready = each.text.strip() == words and each.is_enabled()
                if is_ready and self.browser.execute_async_script(_RESTS, each):
                    each.click()
                    return True
            return False

        self.until(act, f"button {words!r}")

    def fill(self, name, text):
        self._type(f'input[name="{name}"]', text)

    def type_value(self, label, value):
        """Type a value into the control with this aria-label."""
        self._type(f'[aria-label="{label}"]', str(value))

    def choose(self, label, value):
        field = self.control(label)
        field.find_element(By.CSS_SELECTOR, f'option[value="{value}"]').click()

    def choose_field(self, label, value):
        """Choose in the field with these words above it."""
        path = f"//label[span='{label}']//option[@value='{value}']"
        self.until(lambda: self.browser.find_element(By.XPATH, path).click() or True, label)

    def reason(self, text):
        self._type("#dialog-reason", text)

    def _type(self, selector, text):
        """Replace what is in a field, once it can be written to."""

        def act():
            field = self.browser.find_element(By.CSS_SELECTOR, selector)
            field.send_keys(Keys.CONTROL, "a")
            field.send_keys(text)
            return True

        self.until(act, selector)

    @contextmanager
    def recorded_frames(self):
        """Record what comes over WebSockets of pages that open now; give the new ones."""
        source = {"source": _RECORD_FRAMES}
        script = self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", source)
        yield lambda: self.browser.execute_script("return window.receivedFrames.splice(0);")
        self.browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)

    def overflow(self):
        """Return the width (px) of the page, and by how much the content is wider than its box."""
        return self.browser.execute_script(
            "const c = document.getElementById('content');"
            "return [document.documentElement.scrollWidth, c.scrollWidth - c.clientWidth];"
        )

    def rows(self, selector="tbody tr"):
        return [row.text for row in self.all(selector)]
