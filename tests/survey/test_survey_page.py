"""The page of a survey, also in a real browser: Debian's chromium and chromium-driver."""

import re

import pytest
from survey_cases import HOSTILE, SURVEY

from chromium import open_chromium
from rtron.survey.reports.page import graph_picture, survey_page
from rtron.survey.statistics import SurveyCounts
from rtron.survey.survey_run import Survey
from rtron.vocabulary import RiskKind

pytest.importorskip("selenium.webdriver", reason="needs Selenium")
from selenium.webdriver.common.by import By

WINDOWS = [(1300, 900), (390, 844)]


def test_the_page_asks_nobody_for_anything():
    page = survey_page(SURVEY)
    assert "default-src 'none'" in page
    namespaces = ("http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink")
    assert set(re.findall(r"https?://[^\"' ]+", page)) <= set(namespaces)
    assert HOSTILE not in page


def test_how_many_risks_an_app_has_is_a_mean_over_all_apps():
    results = [result for result in SURVEY.results if result.survey]
    expected = {
        kind: sum(result.survey.risks.get(kind, 0) for result in results) / len(results)
        for kind in RiskKind
    }
    assert {risk.kind: risk.per_app for risk in SurveyCounts(results).risks} == expected
    assert 0 < min(mean for mean in expected.values() if mean) < 1
    assert [risk.per_app for risk in SurveyCounts([]).risks] == [0] * len(RiskKind)


def test_a_survey_without_apps_is_a_page():
    assert "None." in survey_page(Survey(results=[]))


def test_without_graphviz_the_page_says_so(monkeypatch):
    monkeypatch.setenv("PATH", "/nonexistent")
    assert "needs Graphviz" in graph_picture(
        SurveyCounts([result for result in SURVEY.results if result.survey])
    )


@pytest.fixture(scope="module")
def browser():
    with open_chromium() as chromium:
        yield chromium


@pytest.fixture(params=WINDOWS, ids=["desktop", "phone"])
def page(browser, request, tmp_path):
    """Open the page in a window; its console must be silent."""
    path = tmp_path / "survey.html"
    path.write_text(survey_page(SURVEY), encoding="utf-8")
    browser.set_window_size(*request.param)
    browser.get(path.as_uri())
    yield browser
    assert browser.get_log("browser") == []


def apps(page):
    shown = page.find_elements(By.CSS_SELECTOR, "#lines .app button")
    return [each.text for each in shown]


def follow(page, selector):
    """Follow a link as a click does, wherever it stands in a frame that scrolls."""
    page.execute_script("document.querySelector(arguments[0]).click()", selector)


def test_each_app_has_a_line_and_one_that_failed_its_reason(page):
    assert apps(page) == [result.app for result in SURVEY.results]
    lines = page.find_element(By.ID, "lines")
    assert "not done within 60 s" in lines.text
    functions = [
        each.get_attribute("textContent")
        for each in lines.find_elements(By.CSS_SELECTOR, "tbody td:last-child")
    ]
    assert functions == [
        ", ".join(result.survey.profile.functions) if result.survey else ""
        for result in SURVEY.results
    ]


@pytest.mark.parametrize(
    ("link", "fitting"),
    [
        ("#risks tbody tr:nth-child(1) .figure a", ["one/launch/nav.launch"]),
        ("#risks tbody tr:nth-child(2) .figure a", [HOSTILE]),
        ("#categories .figure a", ["one/launch/nav.launch"]),
        ("#interactions .figure a", ["one/launch/nav.launch"]),
        (".matrix td a", ["one/launch/nav.launch"]),
        (".picture .edge a", ["one/launch/nav.launch"]),
        ("#findings .figure a", ["one/launch/nav.launch"]),
        ("#left-out a", ["late/launch/late.launch"]),
    ],
)
def test_a_figure_leads_to_the_apps_that_it_counts(page, link, fitting):
    page.execute_script(
        "const link = document.querySelector(arguments[0]);"
        "location.hash = link.getAttribute('href') ?? link.getAttribute('xlink:href');",
        link,
    )
    assert apps(page) == fitting


def test_a_line_opens_what_was_found_with_its_place(page):
    follow(page, "#lines .app button")
    shown = page.find_element(By.CSS_SELECTOR, ".details").text
    assert "/teleop and /tracker both drive the robot on /cmd_vel" in shown
    assert "me/app/launch/x.launch:7" in shown


def test_lines_are_searched_and_sorted(page):
    query = page.find_element(By.ID, "query")
    query.send_keys("teleop")
    assert apps(page) == [HOSTILE]
    query.clear()
    query.send_keys(" ")
    follow(page, "#lines thead th:nth-child(3) button")
    assert apps(page)[0] == HOSTILE


def test_nothing_is_wider_than_the_window(page):
    wide = page.execute_script(
        "return document.documentElement.scrollWidth - document.documentElement.clientWidth"
    )
    assert wide == 0
