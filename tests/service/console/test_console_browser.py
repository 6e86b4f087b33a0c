"""The console in a real browser, against the real service and a simulated guard."""

import json

import pytest
from app_graphs import AUTORACE
from console_page import ROBOT_VIEWS
from console_robot import large_graph
from selenium.webdriver.common.keys import Keys

from rtron.functions.node_functions import with_functions
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.store.audit import record_events
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import EventKind, GuardEventLevel


def test_a_wrong_password_is_told_and_the_right_one_lets_in(console, page):
    page.expect_log("401")
    page.browser.get(console.base)
    page.fill("name", "ada")
    page.fill("password", "not the password")
    page.press("Log in")
    page.wait_for_text("the name or the password is wrong")
    page.fill("password", page.password)
    page.press("Log in")
    page.wait_for_text("No robot is known yet")


def test_the_overview_tells_who_is_in_control_and_an_attack_while_one_looks(guard, page):
    page.login()
    for words in ("/cmd_vel", "/control_lane", "Preemption"):
        page.wait_for_text(words, "table")
    page.wait_for_text("connected")
    page.wait_without_text("foreign publisher")
    guard.attack()
    page.wait_for_text("foreign publisher")
    page.wait_for_text("/rviz_intruder is not in the plan")
    page.go("robots/turtle1/events")
    page.wait_for_text("what it says on /cmd_vel is dropped")
    page.go("robots/turtle1/nodes/grcn_cmd_vel")
    page.wait_for_text("only the publishers that the plan names may speak on /cmd_vel")
    page.wait_for_text("/rviz_intruder on /cmd_vel")


def test_a_guard_that_falls_silent_or_goes_away_is_not_shown_as_live(guard, page):
    page.login()
    page.wait_for_text("/control_lane", "table")
    guard._interval = 1000
    page.wait_for_text("has been silent for")
    assert page.all(".stale")
    guard.close()
    page.wait_for_text("not connected")
    page.wait_for_text("The guard is not connected")
    assert not [row for row in page.rows() if "was" not in row and "/control_lane" in row]


HELD_ANSWER = """
const send = window.fetch;
const gate = new Promise((resolve) => { window.letGo = resolve; });
window.fetch = async (url, options) => {
  const answer = await send(url, options);
  if (options?.method === "PATCH") await gate;
  return answer;
};
"""


def put_in_force(page, reason, *consequences):
    """Put the draft in force, once these consequences are shown."""
    page.press("Review and put in force …")
    for words in consequences:
        page.wait_for_text(words, "dialog")
    page.reason(reason)
    page.press("Put in force", "dialog")


def test_the_policy_is_changed_after_one_has_seen_what_it_will_do(guard, page):
    page.login("dev", "robots/turtle1/nodes/grcn_cmd_vel")
    page.wait_for_text("Policy and flows")
    page.choose("Policy", "Block")
    page.press("Review and put in force …")
    page.wait_for_text("Flows whose block bit is 1 are dropped", "dialog")
    cells = [cell.text for cell in page.all("dialog tbody td")]
    assert cells == ["Policy", "Preemption", "Block"]
    assert not page.find("dialog .danger").is_enabled()
    page.reason("somebody steals the wheel")
    page.press("Put in force", "dialog")
    page.wait_for_text("plan Preemption, in force Block")
    page.wait_for_text("revision 1")
    page.wait_for_text("applied")
    assert guard.settings[-1].nodes["grcn_cmd_vel"].policy.value == "Block"


def test_pending_becomes_refused_and_an_early_answer_stays(guard, page):
    page.login("dev", "robots/turtle1/nodes/grcn_cmd_vel")
    page.type_value("priority of flow1", 9)
    guard.answers.clear()
    guard.error = "flow1 is busy"
    put_in_force(page, "it comes first")
    page.wait_for_text("pending", ".head")
    guard.answers.set()
    page.wait_for_text("refused", ".head")
    page.wait_for_text("flow1 is busy", ".head")
    guard.error = ""
    page.browser.execute_script(HELD_ANSWER)
    page.type_value("priority of flow1", 8)
    put_in_force(page, "it still comes first")
    page.wait_for_text("revision 2")
    page.wait_for_text("applied", ".head")
    page.browser.execute_script("window.letGo()")
    page.until(lambda: not page.all("dialog"))
    assert "applied" in page.text(".head")


def test_who_was_slower_sees_what_the_other_changed_and_can_do_it_again(console, guard, page):
    page.expect_log("409")
    page.login("dev", "robots/turtle1/nodes/grcn_cmd_vel")
    page.type_value("priority of flow1", 9)
    theirs = {"revision": 0, "reason": "mine first", "nodes": {"grcn_cmd_vel": {"policy": "Block"}}}
    assert console.call("PATCH", "/robots/turtle1/settings", json=theirs).status_code == 200
    page.wait_for_text("since you began")
    put_in_force(page, "it comes first")
    page.wait_for_text("ada changed the settings in the meantime")
    page.wait_for_text("grcn_cmd_vel · policy: as the plan → Block")
    page.until(lambda: not page.all("dialog"))
    put_in_force(page, "it comes first")
    page.wait_for_text("plan 4, in force 9")
    page.wait_for_text("plan Preemption, in force Block")


def test_the_end_user_lowers_the_limit_and_is_told_what_is_the_developers(guard, page):
    page.login("eva", "robots/turtle1/nodes/grcn_cmd_vel")
    assert not page.control("priority of flow1").is_enabled()
    why = page.find(".setting .hidden").get_attribute("textContent")
    assert "only the developer may change this" in why
    page.go("robots/turtle1/nodes/rsrcn")
    page.wait_for_text("Policy and limits")
    assert not page.control("Threshold").is_enabled()
    page.type_value("Max_vel_limit", "0.1")
    put_in_force(page, "people about", "The robot goes at most 0.1 m/s")
    page.wait_for_text("plan 0.22 m/s, in force 0.1 m/s")
    assert guard.settings[-1].nodes["rsrcn"].max_vel_limit == 0.1


def test_an_end_user_adds_and_deletes_a_rule_and_deselects_what_is_not_mandatory(guard, page):
    page.login("eva", "robots/turtle1/nodes/msrcn")
    page.press("New rule …")
    page.wait_for_text("A rule of your own", "dialog")
    fields = page.all("dialog input:not([type=checkbox])")
    fields[0].send_keys("no_parking")
    page.press("eflow10", "dialog")
    page.find("dialog .bits input").click()
    page.press("Into the draft", "dialog")
    page.wait_for_text("1 change in draft")
    put_in_force(page, "no parking today", "while eflow10: /cmd_vel")
    page.wait_for_text("revision 1")
    assert guard.settings[-1].nodes["msrcn"].rules["no_parking"].block == ("/cmd_vel",)
    page.press("delete")
    put_in_force(page, "parking again")
    page.wait_for_text("revision 2")
    assert "msrcn" not in guard.settings[-1].nodes
    assert not page.control("selected of stop_at_red").is_enabled()
    page.control("selected of wait_for_bar").click()
    put_in_force(page, "the bar is broken", "The rule wait_for_bar does not count any more")
    page.wait_for_text("revision 3")
    assert guard.settings[-1].nodes["msrcn"].rules["wait_for_bar"].selected is False


def test_an_end_user_stops_the_robot_with_two_presses(guard, page):
    page.login("eva", "robots/turtle1/graph")
    page.find("#stop").send_keys(Keys.ENTER)
    page.wait_for_text("Stop turtle1 now", "dialog")
    page.browser.switch_to.active_element.send_keys(Keys.ENTER)
    page.until(lambda: guard.settings[-1].stop)
    assert guard.settings[-1].stop.by == "eva"
    page.go("robots/turtle1/now")
    page.wait_for_text("Emergency stop by eva")
    page.press("End the emergency stop")
    page.wait_for_text("may move at once", "dialog")
    page.reason("all is clear")
    page.press("Let it move again", "dialog")
    page.until(lambda: guard.settings[-1].stop is None)
    page.wait_without_text("Emergency stop by")


def test_who_ends_a_stop_sees_that_another_came_or_that_somebody_has_ended_it(console, guard, page):
    page.expect_log("409")
    path = "/robots/turtle1/stop"
    console.call("POST", path, json={"reason": "fire"})
    page.login("dev", "robots/turtle1/now")
    page.press("End the emergency stop")
    page.wait_for_text("Stopped by ada: fire", "dialog")
    second = console.call("POST", path, name="eva", json={"reason": "a child"}).json()
    page.reason("the fire is out")
    page.press("Let it move again", "dialog")
    page.wait_for_text("Stopped by eva: a child", "dialog")
    page.wait_for_text("changed meanwhile", "dialog")
    assert guard.settings[-1].stop.by == "eva"
    page.reason("the child is away")
    body = {"revision": second["revision"], "reason": "all is clear"}
    assert console.call("DELETE", path, name="eva", json=body).status_code == 200
    page.press("Let it move again", "dialog")
    page.wait_for_text("turtle1 is not stopped any more")
    page.until(lambda: not page.all("dialog"))


def test_an_override_counts_down_and_can_be_ended(guard, page):
    page.login("dev", "robots/turtle1/nodes/rsrcn")
    page.press("Override …")
    page.wait_for_text("faster than it sees", "dialog")
    page.reason("to the workshop")
    page.press("Override for 2 min", "dialog")
    page.wait_for_text("1:5")
    page.wait_for_text("dev: to the workshop")
    assert guard.settings[-1].overrides["rsrcn"].reason == "to the workshop"
    page.press("End it now")
    page.reason("it is docked")
    page.press("End it now", "dialog")
    page.until(lambda: not guard.settings[-1].overrides)
    page.wait_for_text("What this node forbids passes for that time")


def test_the_graph_lights_what_belongs_to_a_node_and_shows_rates(console, guard, page):
    console.upload(data=json.dumps(graph_to_json(with_functions(AUTORACE))).encode())
    page.login("ada", "robots/turtle1/graph")
    field = page.control("Search nodes and topics")
    field.send_keys("control_lane", Keys.ENTER)
    page.wait_for_text("Publishes", ".detail")
    page.wait_for_text("/cmd_vel", ".detail")
    page.wait_for_text("Path Tracking Control", ".detail")
    page.until(lambda: any("/s" in each.text for each in page.all(".edge .rate")), "rates")
    lit = [each.get_attribute("aria-label") for each in page.all(".lit > .press")]
    assert "node /control_lane" in lit
    assert "node /map_server" not in lit


def test_the_graph_is_filtered_and_the_keys_lead_through_it(console, guard, page):
    console.upload()
    page.login("ada", "robots/turtle1/graph")
    page.find(".picture .press")
    page.find(".picture").send_keys(Keys.ARROW_RIGHT)
    first = page.browser.switch_to.active_element
    assert first.get_attribute("aria-label").startswith(("node ", "topic ", "GRCN "))
    first.send_keys(Keys.ARROW_RIGHT)
    second = page.browser.switch_to.active_element
    assert second.rect["x"] > first.rect["x"]
    second.send_keys(Keys.ENTER)
    page.find(".detail")
    second.send_keys(Keys.ESCAPE)
    page.until(lambda: not page.all(".detail"))
    everything = len(page.all(".picture .box"))
    page.choose("Kind of risk", "RSR")
    page.until(lambda: 0 < len(page.all(".picture .box")) < everything)
    assert not page.all('.picture .press[aria-label="node /rviz"]')
    page.choose("Kind of risk", "")
    page.until(lambda: len(page.all(".picture .box")) == everything)
    page.choose("Domain", "Control")
    page.until(lambda: 0 < len(page.all(".picture .box")) < everything)


def scale_of(page):
    """Return how the graph is moved and scaled; it is empty until the graph is laid out."""
    return page.find(".world").get_attribute("transform") or ""


WORDS_IN_VIEW = """
const seen = document.querySelector(".picture").getBoundingClientRect();
return [...document.querySelectorAll(".picture text")].filter((text) => {
    const at = text.getBoundingClientRect();
    const isInWidth = at.left >= seen.left && at.right <= seen.right;
    return isInWidth && at.top >= seen.top && at.bottom <= seen.bottom;
}).map((text) => text.textContent);
"""


def test_the_graph_opens_readable(console, guard, page):
    """The size on the screen of the words in it, which are 12 px high at full size."""
    console.upload()
    page.login()
    for width, height in ((1300, 900), (390, 844)):
        page.resize(width, height)
        page.go("robots/turtle1/graph")
        page.until(lambda: "scale(1)" in scale_of(page))
        assert "/cmd_vel" in page.browser.execute_script(WORDS_IN_VIEW)
        page.press("All")
        page.until(lambda: "scale(1)" not in scale_of(page))
        page.go("robots/turtle1/now")


@pytest.mark.long
def test_a_large_graph_is_drawn_whole_and_nothing_covers_another(console, guard, page):
    console.upload(data=large_graph())
    page.login("ada", "robots/turtle1/graph")
    page.press("Leaf topics")
    page.until(lambda: labels(page, "node ") == 44)
    overlaps = page.browser.execute_script("""
        const boxes = [...document.querySelectorAll(".box")].map((b) => b.getBoundingClientRect());
        return boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) =>
            a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom)).length;
    """)
    assert overlaps == 0
    for _ in range(30):
        page.control("Zoom in").click()
    before = page.find(".world").get_attribute("transform")
    page.press("All")
    page.until(lambda: page.find(".world").get_attribute("transform") != before)


def labels(page, beginning):
    """Count the parts of the picture whose label begins so."""
    return len(page.all(f'.picture .press[aria-label^="{beginning}"]'))


def test_all_robots_are_stopped_but_those_left_out(console, guard, page):
    other, third = console.guard("turtle2"), console.guard("turtle3")
    page.login("eva")
    page.wait_for_text("3 connected")
    page.press("Emergency stop")
    page.find("dialog label:nth-child(2) input").click()
    page.press("Stop them now", "dialog")
    page.until(lambda: guard.settings[-1].stop and third.settings[-1].stop)
    assert other.settings[-1].stop is None


def test_risks_show_rule_cause_and_evidence_and_lead_to_the_graph(console, guard, page):
    console.upload()
    page.login("ada", "robots/turtle1/risks")
    page.wait_for_text("44 of 44 risks")
    page.wait_for_text("What can move this robot")
    page.wait_for_text("/gazebo obeys /cmd_vel")
    page.wait_for_text("What of it the plan does not guard")
    page.find("input[type=search]").send_keys("move_base_simple")
    page.wait_for_text("both publish /move_base_simple/goal")
    page.press("in the graph")
    page.wait_for_text("One risk only")
    page.find("[aria-label='node /rviz']")


def test_the_connection_is_lost_and_found_again(console, guard, page):
    page.login()
    page.wait_for_text("/control_lane", "table")
    page.expect_log("ERR_")
    page.browser.execute_cdp_cmd("Network.enable", {})
    offline = {"latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
    page.browser.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": True, **offline})
    page.wait_for_text("Connection to the service lost")
    assert page.all(".stale")
    assert "live" not in [badge.text for badge in page.all(".bar .badge")]
    online = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
    page.browser.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": False, **online})
    page.until(lambda: not page.all(".banner"))
    page.until(lambda: not page.all(".stale"))


SCROLL_AND_ASK_TWICE = """
document.querySelector("#content").scrollTo(0, 1e9);
for (const _ of [1, 2]) document.querySelector(".events .empty button")?.click();
"""
EVENT_NUMBERS = "return [...document.querySelectorAll('.event')].map((e) => e.dataset.event);"
AUDIT_TEXTS = "return [...document.querySelectorAll('.audit p')].map((e) => e.textContent);"


def test_events_come_page_by_page_and_live(guard, page):
    guard.events(*(guard.guard.event(EventKind.OWNER, reason=f"old {n}.") for n in range(350)))
    page.login("ada", "robots/turtle1/events")
    page.wait_for_text("old 349.")
    assert len(page.browser.execute_script(EVENT_NUMBERS)) < 350
    for _ in range(12):
        if page.shows("old 0.", "#content"):
            break
        page.browser.execute_script(SCROLL_AND_ASK_TWICE)
        page.until(lambda: not page.shows("Loading", "#content"))
    page.wait_for_text("That is all.")
    page.wait_for_text("old 0.")
    guard.event(EventKind.RULE, level=GuardEventLevel.WARNING, reason="a new one")
    page.wait_for_text("a new one")
    numbers = page.browser.execute_script(EVENT_NUMBERS)
    assert len(set(numbers)) == len(numbers) >= 350


def test_audit_entries_come_page_by_page(console, page):
    robots = {f"robot{n}" for n in range(150)}
    stops = [AuditEvent(who="ada", action="stop", target=robot) for robot in robots]
    with console.app.state.service.database.session() as session:
        record_events(session, 1, stops)
    page.login("ada", "audit")
    page.wait_for_text("Older entries")
    page.browser.execute_script(SCROLL_AND_ASK_TWICE)
    page.wait_for_text("That is all.")
    texts = [text.strip() for text in page.browser.execute_script(AUDIT_TEXTS)]
    assert sorted(text for text in texts if text in robots) == sorted(robots)


def test_an_admin_makes_a_user_a_token_and_a_webhook(console, page):
    page.login("ada", "users")
    page.press("New user …")
    page.fill("name", "kim")
    page.find("dialog input[name=password]").send_keys("a long enough word")
    page.press("Create", "dialog")
    page.wait_for_text("kim", "table")
    page.go("tokens")
    page.press("New token …")
    page.fill("name", "guard.turtle1")
    page.find("dialog input[name=guard]").click()
    page.fill("robot", "turtle1")
    page.press("Create", "dialog")
    page.wait_for_text("shown once", "dialog")
    secret = page.find(".secret").text
    assert secret.startswith("rtron_")
    page.press("Close", "dialog")
    page.wait_for_text("guard.turtle1", "table")
    assert secret not in page.browser.page_source
    page.go("webhooks")
    page.press("New webhook …")
    page.fill("url", "https://alerts.example.org/")
    page.press("Create", "dialog")
    page.press("Close", "dialog")
    page.wait_for_text("https://alerts.example.org/", "table")
    page.go("audit")
    page.wait_for_text("add user")


def test_an_end_user_is_offered_what_he_may_see_and_logs_out(page):
    page.expect_log("401")
    page.login("eva", "account")
    ways = page.find("nav.side").text
    assert "Users" not in ways
    assert "Audit log" not in ways
    page.press("Log out")
    page.find("main.login")


def test_the_theme_is_kept(page):
    page.login()
    page.control("Change the theme").click()
    assert page.find("html").get_attribute("data-theme") == "light"
    page.control("Change the theme").click()
    page.browser.refresh()
    assert page.find("html").get_attribute("data-theme") == "dark"
    page.control("Change the theme").click()
    assert page.find("html").get_attribute("data-theme") is None


def test_every_view_fits_a_phone(console, guard, page):
    page.show_on_phone()
    page.login()
    for view in ROBOT_VIEWS:
        page.go(view)
        page.until(lambda: not page.all("[aria-busy]"))
        width, overflow = page.overflow()
        assert (width <= 360, overflow <= 0) == (True, True), view
        stop = page.find("#stop").rect
        assert 0 <= stop["x"] <= 360 - stop["width"], view


def test_a_draft_does_not_outlive_the_session(guard, page):
    page.expect_log("401")
    page.login("dev", "robots/turtle1/nodes/grcn_cmd_vel")
    page.type_value("priority of flow1", 9)
    page.wait_for_text("1 change in draft")
    page.go("account")
    page.press("Log out")
    page.login_by_form("ada", "robots/turtle1/nodes/grcn_cmd_vel")
    page.wait_for_text("Nothing changed")
