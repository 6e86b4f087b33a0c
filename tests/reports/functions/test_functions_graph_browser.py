"""The page of the functions' graph in a real browser: Debian's chromium and chromium-driver."""

import pytest

from chromium import open_chromium
from rtron.functions.interactions.abstract_graph import PackageMessages, abstract_graph
from rtron.reports.functions.html import functions_to_html
from rtron.vocabulary import FunctionType as F

pytest.importorskip("selenium.webdriver", reason="needs Selenium")
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

GRAPH = abstract_graph([PackageMessages(name=f.name, functions=(f,)) for f in F])


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "functions.html"
    path.write_text(functions_to_html(GRAPH), encoding="utf-8")
    with open_chromium() as browser:
        browser.get(path.as_uri())
        yield browser
        silent = browser.get_log("browser")
    assert silent == []


def rows(page):
    shown = [row for row in page.find_elements(By.CSS_SELECTOR, "tbody tr") if row.is_displayed()]
    return {(row.get_attribute("data-from"), row.get_attribute("data-to")) for row in shown}


def function(page, name):
    return page.find_element(By.CSS_SELECTOR, f'.function[data-name="{name}"]')


def test_a_function_that_is_chosen_shows_its_interactions_alone(page):
    every = rows(page)
    speaker = function(page, "Speaker")
    speaker.send_keys(Keys.ENTER)
    assert rows(page) == {("Speech Generation", "Speaker")}
    near = page.find_elements(By.CSS_SELECTOR, ".function.near")
    assert {one.get_attribute("data-name") for one in near} == {"Speech Generation", "Speaker"}
    speaker.send_keys(Keys.ESCAPE)
    page.execute_script("document.activeElement.blur()")
    assert rows(page) == every


def test_every_function_and_word_is_inside_the_picture(page):
    outside = page.execute_script(
        "const frame = document.querySelector('#picture svg').getBoundingClientRect();"
        "return [...document.querySelectorAll('#picture text')].filter((text) => {"
        "  const box = text.getBoundingClientRect();"
        "  return box.left < frame.left || box.right > frame.right || box.top < frame.top"
        "    || box.bottom > frame.bottom;}).map((text) => text.textContent);"
    )
    assert outside == []


def test_the_environment_joins_who_acts_to_whom_it_reaches(page):
    teleoperation = function(page, "Teleoperation")
    teleoperation.send_keys(Keys.ENTER)
    near = page.find_elements(By.CSS_SELECTOR, ".function.near")
    names = {one.get_attribute("data-name") for one in near}
    assert {"Localization", "Path Planning", "Mobile"} <= names
    assert names.isdisjoint({"Path Tracking", "Switcher", "Speaker"})
    teleoperation.send_keys(Keys.ESCAPE)
    page.execute_script("document.activeElement.blur()")


def test_functions_are_buttons_with_a_name_and_a_state(page):
    mapping = function(page, "Mapping")
    assert (mapping.aria_role, mapping.accessible_name) == ("button", "Mapping, 1 package")
    assert page.find_element(By.CSS_SELECTOR, "#picture svg").aria_role != "img"
    for expected in ("true", "false"):
        mapping.send_keys(Keys.ENTER)
        assert mapping.get_attribute("aria-pressed") == expected
    page.execute_script("document.activeElement.blur()")


def test_labels_are_large_enough_and_apart_in_a_narrow_window(page):
    page.set_window_size(1280, 800)
    small, together = page.execute_script(
        "const rows = [...document.querySelectorAll('.label tspan, .function text')];"
        "const small = rows.filter((row) => row.getBoundingClientRect().height < 12);"
        "const boxes = [...document.querySelectorAll('.label, .function')]"
        "  .map((one) => one.getBoundingClientRect());"
        "const meet = (a, b) => a.left < b.right && b.left < a.right && a.top + 2 < b.bottom"
        "  && b.top + 2 < a.bottom;"
        "return [small.length, boxes.filter((a, i) => boxes.slice(0, i).some((b) => meet(a, b)))"
        "  .length];"
    )
    page.set_window_size(1600, 1000)
    assert (small, together) == (0, 0)


def test_the_picture_scrolls_or_fits_the_window(page):
    wide = "const f = document.querySelector('#picture'); return f.scrollWidth > f.clientWidth"
    assert page.execute_script(wide)
    fit = page.find_element(By.ID, "fit")
    fit.click()
    assert not page.execute_script(wide)
    assert fit.get_attribute("aria-pressed") == "true"
    fit.click()
    assert page.execute_script(wide)


def test_a_functions_name_fits_its_ellipse(page):
    wide = page.execute_script(
        "return [...document.querySelectorAll('.function')].filter((one) => {"
        "  const room = one.querySelector('ellipse').getBoundingClientRect().width;"
        "  return one.querySelector('text').getBoundingClientRect().width > room;"
        "}).map((one) => one.dataset.name);"
    )
    assert wide == []
