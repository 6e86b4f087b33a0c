"""Incidents in the console: the list as it grows, and the page of one."""

import json
from dataclasses import replace

from harness import wait_for
from incident_reports import NAME, a_report

from rtron.vocabulary import EventKind
from rtron.wire.common.link_protocol import IncidentSaved

PAGE = f"robots/turtle1/incidents/{NAME}"


def save(console, guard, report):
    """Let a guard report an incident; wait until the service has it."""
    guard.send(IncidentSaved(report=report))
    path = f"/robots/turtle1/incidents/{report.name}"
    wait_for(lambda: console.call("GET", path).status_code == 200, what="the incident")


def test_an_incident_appears_in_the_list_while_one_looks(console, guard, page):
    page.login("eva", "incidents")
    page.wait_for_text("No incident has been reported")
    save(console, guard, a_report())
    page.wait_for_text("0.80 m/s is above 0.22 m/s", "table")
    (row,) = page.rows()
    for words in ("turtle1", "intervention", "/cmd_vel", "flow1", "/teleop", "r3"):
        assert words in row
    page.find("tbody td a").click()
    page.wait_for_text("Incident of turtle1")


def test_the_page_shows_what_was_and_what_would_have_been_and_is_a_file(
    console, guard, page, tmp_path
):
    save(console, guard, a_report())
    page.download_to(tmp_path)
    page.login("eva", PAGE)
    page.wait_for_text("0.80 m/s instead of 0.22 m/s at +0.00 s; into kitchen after 3.0 s")
    page.find(".chart canvas")
    keys = [" ".join(each.text.split()) for each in page.all(".chart-box .keys span")]
    assert keys == [
        "what went out 0.22",
        "flow1 /teleop 0.80",
        "limit 0.22",
        "without the guard 0.80",
    ]
    rows = page.rows()
    assert "-20.00 s in command /cmd_vel flow1 /teleop" in rows
    assert any("modify" in row and "Constrain" in row for row in rows)
    assert "flow1 /teleop 400 0 0 200" in rows
    page.wait_for_text("revision 3")
    page.wait_for_text(f"rtron incident export {NAME}")
    page.wait_for_text("Path, in map")
    was, would_be = page.all(".map polyline")
    assert len(was.get_attribute("points").split()) == 40
    assert len(would_be.get_attribute("points").split()) == 60
    assert page.find(".map .area").get_attribute("points") == "6,1 8,1 8,-2 6,-2"
    assert page.find(".map text").text == "kitchen"
    page.press("JSON")
    file = tmp_path / f"{NAME}.json"
    page.await_download(file)
    wait_for(lambda: json.loads(file.read_text())["schema"] == "rtron.incident_report/1")


def test_an_event_leads_to_its_incident(console, guard, page):
    save(console, guard, a_report())
    guard.event(EventKind.GUARD, reason="incident saved", values={"incident": NAME})
    page.login("eva", "robots/turtle1/events")
    page.press("What happened")
    page.wait_for_text("Incident of turtle1")


def test_what_has_no_velocity_and_no_pose_is_shown_without(console, guard, page):
    (topic,) = a_report().topics
    silent = replace(topic, flows=(), output=(), limits=())
    report = a_report(topics=(silent,), path=(), areas=(), alternatives=(), frame="")
    save(console, guard, report)
    page.login("eva", PAGE)
    page.wait_for_text("Its messages have no velocity")
    page.wait_for_text("Nothing is known of where the robot was")


def test_what_no_robot_has_told_of_is_said(console, guard, page):
    page.expect_log("404")
    page.login("eva", "robots/turtle1/incidents/none.mcap")
    page.wait_for_text("has told of no such incident")
