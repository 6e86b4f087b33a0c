"""What people of a shift do in the console: acknowledge, hand over, compare, restore, export."""

import json

from console_fleet import alarm, stored_fleet
from harness import wait_for

from rtron.vocabulary import EventKind


def test_an_alarm_is_acknowledged_with_a_note_until_the_guard_tells_of_it_again(guard, page):
    page.login("eva")
    guard.attack()
    page.wait_for_text("/rviz_intruder publishes /cmd_vel")
    page.press("Acknowledge …")
    page.reason("the engineer has plugged in a laptop")
    page.press("Acknowledge", "dialog")
    page.wait_for_text("Seen by eva")
    page.wait_for_text("the engineer has plugged in a laptop")
    page.go("shift")
    page.wait_for_text("the engineer has plugged in a laptop")
    page.go("robots/turtle1/now")
    page.wait_for_text("Seen by eva")
    (state,) = [guard.guard.state().alarms[0]]
    values = {
        "kind": state.kind.value,
        "topic": state.topic,
        "node": state.node,
        "peer": state.peer,
    }
    guard.event(EventKind.ALARM, topic=state.topic, reason=state.reason, values=values)
    page.wait_without_text("Seen by eva")


def test_alarms_of_many_robots_are_acknowledged_at_once(console, page):
    fleet = stored_fleet(console.app.state.service, [f"robot{n}" for n in range(30)])
    for name in fleet.names[:12]:
        fleet.state(name, alarms=(alarm(),))
    page.login("dev")
    page.press("Acknowledge 12 alarms …")
    page.reason("the switch in hall 3 restarts")
    page.press("Acknowledge", "dialog")
    page.wait_for_text("12 alarms acknowledged", ".toasts")
    page.wait_for_text("alarm seen", ".fleet")
    robot = console.call("GET", "/robots/robot3").json()
    assert [each["by"] for each in robot["acknowledged"]] == ["dev"]
    page.until(lambda: not [each for each in page.all("button") if "12 alarms" in each.text])


def test_a_shift_hands_over_and_the_next_one_reads_it_at_once(console, guard, page):
    page.login("eva", "shift")
    page.wait_for_text("No note has been written yet")
    console.call("POST", "/handovers", name="dev", json={"text": "turtle1 pulls to the left"})
    page.wait_for_text("turtle1 pulls to the left")
    page.find("#handover").send_keys("the left wheel is changed\nall is well")
    page.press("Write the note")
    page.wait_for_text("the left wheel is changed\nall is well")
    page.wait_for_text("1 of 1 robot connected")


def change(console, revision, policy):
    body = {
        "revision": revision,
        "reason": f"now {policy}",
        "nodes": {"grcn_cmd_vel": {"policy": policy}},
    }
    assert console.call("PATCH", "/robots/turtle1/settings", json=body).status_code == 200


def test_any_two_revisions_are_compared_and_any_is_restored(console, guard, page):
    change(console, 0, "Block")
    change(console, 1, "FIFO_Queue")
    change(console, 2, "Priority_Queue")
    page.login("dev", "robots/turtle1/settings")
    page.wait_for_text("Revision 3")
    page.control("Compare revision 1").click()
    page.wait_for_text("choose another one")
    page.control("Compare revision 3").click()
    page.wait_for_text("Revision 1 and revision 3")
    cells = [cell.text for cell in page.all(".card:first-of-type .diff tbody td")]
    assert cells[:3] == ["grcn_cmd_vel · policy", "Block", "Priority_Queue"]
    page.control("Restore revision 1").click()
    page.wait_for_text("by a new revision", "dialog")
    page.reason("that worked")
    page.press("Put in force", "dialog")
    page.wait_for_text("Revision 4")
    wait_for(lambda: guard.settings[-1].revision == 4)
    assert guard.settings[-1].nodes["grcn_cmd_vel"].policy.value == "Block"


def test_a_restore_that_was_overtaken_shows_what_would_differ_now(console, guard, page):
    page.expect_log("409")
    change(console, 0, "Block")
    page.login("dev", "robots/turtle1/settings")
    page.control("Restore revision 0").click()
    page.wait_for_text("by a new revision", "dialog")
    change(console, 1, "FIFO_Queue")
    page.reason("as planned")
    page.press("Put in force", "dialog")
    page.wait_for_text("changed meanwhile", "dialog")
    page.wait_for_text("FIFO_Queue", "dialog")


def test_what_a_view_shows_is_a_file(console, guard, page, tmp_path):
    page.download_to(tmp_path)
    page.login("eva")
    page.press("JSON")
    file = tmp_path / "rtron-robots.json"
    page.await_download(file)
    assert [each["name"] for each in json.loads(file.read_text())] == ["turtle1"]
    page.go("robots/turtle1/events")
    page.press("CSV")
    page.await_download(tmp_path / "rtron-events.csv")
