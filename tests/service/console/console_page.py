"""The console as a person uses it: looks for words and presses what has a name."""

import json

from selenium.common.exceptions import (
    ElementClickInterceptedException,
    ElementNotInteractableException,
    NoSuchElementException,
    StaleElementReferenceException,
)
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

PASSING = (
    NoSuchElementException,
    StaleElementReferenceException,
    ElementClickInterceptedException,
    ElementNotInteractableException,
)


class Page:
    """One browser window with the console in it."""

    def __init__(self, browser, base, password):
        self.browser, self.base, self.password = browser, base, password
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

    def login(self, name="ada", view=""):
        self.browser.get(f"{self.base}/#/{view}")
        self.fill("name", name)
        self.fill("password", self.password)
        self.press("Log in")
        self.find("nav.side")
        self.until(lambda: not self.all(".banner"), "live")

    def go(self, view):
        self.browser.execute_script("location.hash = arguments[0]", f"#/{view}")

    def until(self, condition, what="it", seconds=60):
        waiting = WebDriverWait(self.browser, seconds, 0.05, ignored_exceptions=PASSING)
        return waiting.until(lambda _: condition(), what)

    def all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def find(self, selector):
        return self.until(lambda: self.browser.find_element(By.CSS_SELECTOR, selector), selector)

    def text(self, selector="#content"):
        return self.until(lambda: self.find(selector).text or True, selector)

    def wait_for_text(self, words, selector="#app"):
        """Wait until these words are shown."""
        found = lambda: words in self.browser.find_element(By.CSS_SELECTOR, selector).text  # noqa: E731
        return self.until(found, f"{words!r} in {selector}")

    def wait_without_text(self, words, selector="#app"):
        found = lambda: words not in self.browser.find_element(By.CSS_SELECTOR, selector).text  # noqa: E731
        return self.until(found, f"no {words!r} in {selector}")

    def control(self, label):
        """Return the form control with this aria-label."""
        return self.find(f'[aria-label="{label}"]')

    def press(self, words, within="#app"):
        """Press the button or link with these words."""

        def act():
            root = self.browser.find_element(By.CSS_SELECTOR, within)
            for each in root.find_elements(By.CSS_SELECTOR, "button, a"):
                if each.text.strip() == words and each.is_enabled():
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

    def websocket_frames(self):
        """Return the texts that came over WebSockets since the last call."""
        logged = [json.loads(line["message"]) for line in self.browser.get_log("performance")]
        messages = [each["message"] for each in logged]
        return [
            each["params"]["response"]["payloadData"]
            for each in messages
            if each["method"] == "Network.webSocketFrameReceived"
        ]

    def rows(self, selector="tbody tr"):
        return [row.text for row in self.all(selector)]
