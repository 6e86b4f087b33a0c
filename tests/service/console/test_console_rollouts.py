"""Roll-outs in the console: begun, watched, paused and taken back in a real browser."""

import pytest
from console_fleet import stored_fleet
from harness import wait_for
from rollout_guards import AnsweringGuard
from selenium.webdriver.common.keys import Keys

ROBOTS = [f"car{index}" for index in range(10)]


@pytest.fixture
def guards(console):
    """Ten guards of hall A."""
    made = {}
    for robot in ROBOTS:
        headers = console.people.token_headers(robot, "guard", robot=robot)
        made[robot] = AnsweringGuard(console.port, robot, headers)
    hub = console.app.state.service.hub
    wait_for(lambda: all(hub.state(robot) for robot in ROBOTS))
    group(console, "hall-a", ROBOTS)
    yield made
    for guard in made.values():
        guard.close()


def group(console, name, robots):
    answer = console.call("PUT", f"/groups/{name}", json={"robots": robots})
    assert answer.status_code == 200, answer.text


def start(console, **values):
    """Begin a roll-out; return its id."""
    new = {
        "robots": {"label": "hall-a"},
        "nodes": {"drive": {"policy": "Block"}},
        "reason": "visitors",
        "wait": 3600,
    }
    answer = console.call("POST", "/rollouts", json=new | values)
    assert answer.status_code == 201, answer.text
    return answer.json()["id"]


def stages(page):
    return [each.text for each in page.all(".stages li")]


def names(page):
    return [each.text for each in page.all(".fleet td.name")]


def test_a_change_is_begun_and_seen_to_reach_all(console, guards, page):
    page.login("dev", "rollouts")
    page.wait_for_text("There are no roll-outs yet")
    page.press("New roll-out …")
    page.wait_for_text("10 robots")
    page.choose("Policy", "Block")
    page.fill("stages", "1, 50%, 100%")
    page.fill("wait", "0")
    page.press("Review and begin …")
    page.wait_for_text("It goes out to 1, then to 50%, then to 100% of the robots", "dialog")
    page.wait_for_text("drive · Policy", "dialog")
    page.reason("visitors")
    page.press("Begin", "dialog")
    page.wait_for_text("Roll-out 1", "h1")
    page.wait_for_text("10 of 10 robots in force")
    page.wait_for_text("done", ".head")
    assert [each.count("passed") for each in stages(page)] == [1, 1, 1]
    assert "4 more robots, 5 of 10 in all" in stages(page)[1]
    assert "4 in force" in stages(page)[1]
    policy = console.call("GET", "/rollouts/1").json()["policy"]
    assert policy["stages"] == [1, "50%", "100%"]
    assert (policy["wait"], policy["blocked_rise"], policy["answer_within"]) == (0, 0.1, 30)
    assert (policy["limits"]["alarm"], policy["limits"]["gone"]) == (0, "5%")
    page.press("Roll-outs", "nav.side")
    page.wait_for_text("10 of 10", "table")


def test_a_bad_change_goes_back_and_says_why(console, guards, page):
    id = start(console)
    page.login("eva", f"rollouts/{id}")
    page.wait_for_text("1 of 10 robots in force")
    page.wait_for_text("9 waiting", ".stages li:last-child")
    page.wait_for_text("Watched for", ".stages")
    (canary,) = [each["robot"] for each in members(console, id) if each["phase"] == "sent"]
    guards[canary].show_problem()
    page.wait_for_text(f"roll-out {id} goes back by itself: alarm: 1 of 1 robots", ".toasts")
    page.wait_for_text("It went back")
    page.wait_for_text(f"alarm: 1 of 1 robots, at most 0: {canary}")
    page.wait_for_text("went back here", ".stages li:first-child")
    page.wait_for_text("1 problem", ".stages li:first-child")
    page.wait_for_text("not reached", ".stages li:last-child")
    page.until(lambda: page.all("tr.attention td.name")[0].text == canary, "the canary first")
    assert not [each for each in page.all("button") if "Take back" in each.text]


def members(console, id):
    return console.call("GET", f"/rollouts/{id}/robots").json()["robots"]


def test_it_ends_where_it_is_or_is_paused_resumed_and_taken_back_by_keyboard(console, guards, page):
    id = start(console)
    page.login("dev", f"rollouts/{id}")
    page.wait_for_text("1 of 10 robots in force")
    page.press("End here …")
    page.wait_for_text("1 robot keeps the change", "dialog")
    page.reason("hall B stays as it is")
    page.press("End it", "dialog")
    page.wait_for_text("the change stays where it is")
    page.wait_for_text("1 in force", ".stages")
    id = start(console, nodes={"drive": {"policy": "FIFO_Queue"}})
    page.go(f"rollouts/{id}")
    page.wait_for_text("1 of 10 robots in force")

    def press(words, reason):
        """Come to a button with the Tab key, and answer its dialog."""
        focused = lambda: page.browser.switch_to.active_element  # noqa: E731
        page.find("body").send_keys(Keys.TAB)
        for _ in range(60):
            if focused().text == words:
                break
            focused().send_keys(Keys.TAB)
        focused().send_keys(Keys.ENTER)
        page.find("dialog")
        page.reason(reason)
        focused().send_keys(Keys.ENTER)
        page.until(lambda: not page.all("dialog"), "the dialog is closed")

    press("Pause …", "lunch")
    page.wait_for_text("dev: lunch")
    page.wait_for_text("paused", ".head")
    press("Go on …", "back again")
    page.wait_for_text("running", ".head")
    press("Take back …", "it brakes too early")
    page.wait_for_text("went back", ".head")
    page.wait_for_text("1 taken back", ".stages")
    assert {each["phase"] for each in members(console, id)} == {"waiting", "reverted"}


def test_what_the_service_refuses_is_said(console, guards, page):
    page.expect_log("422")
    page.login("dev", "rollouts/new")
    page.choose("Policy", "Block")
    page.fill("stages", "1, 10%")
    page.press("Review and begin …")
    page.reason("visitors")
    page.press("Begin", "dialog")
    page.wait_for_text('the last stage is "100%"', "dialog")


@pytest.fixture
def halls(console):
    """Thirty robots that nobody speaks for, in two halls."""
    fleet = stored_fleet(console.app.state.service, [f"robot{number}" for number in range(30)])
    group(console, "hall-a", fleet.names[:12])
    group(console, "hall-b", fleet.names[10:])
    return fleet


def test_a_group_is_found_by_its_name_shown_alone_and_gets_a_change(halls, page):
    page.login("dev")
    page.wait_for_text("30 robots")
    assert not [each for each in page.all("button") if "Make a group" in each.text]
    field = page.find("#content input[type=search]")
    field.send_keys("hall-b")
    page.until(lambda: len(names(page)) == 20, "the robots of hall B")
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys(Keys.DELETE)
    page.choose_field("Group", "hall-a")
    page.until(lambda: len(names(page)) == 12, "the robots of hall A")
    assert page.browser.current_url.endswith("#/?group=hall-a")
    field.send_keys("robot1")
    page.until(lambda: names(page) == ["robot1", "robot10", "robot11"], "those with robot1")
    page.press("Roll out a change …")
    page.wait_for_text("robot1, robot10, robot11")
    page.choose("Policy", "Block")
    page.press("Review and begin …")
    page.wait_for_text("Roll out to 3 robots", "dialog")
    page.reason("visitors")
    page.press("Begin", "dialog")
    page.wait_for_text("0 of 3 robots in force")


def test_an_admin_makes_a_group_of_what_the_filter_shows(halls, page):
    page.login("ada")
    page.wait_for_text("30 robots")
    page.find("#content input[type=search]").send_keys("robot2")
    page.until(lambda: len(names(page)) == 11, "those with robot2")
    page.press("Make a group …")
    page.fill("group", "hall-b")
    page.wait_for_text("hall-b has 20 robots now", "dialog")
    page.fill("group", "hall-c")
    page.wait_without_text("now", "dialog")
    page.press("Make the group", "dialog")
    page.wait_for_text("hall-c has 11 robots", ".toasts")
    page.choose_field("Group", "hall-c")
    page.until(lambda: page.browser.current_url.endswith("group=hall-c"), "it can be chosen")
    assert len(names(page)) == 11


def test_a_roll_out_fits_a_phone(console, guards, page):
    page.show_on_phone()
    id = start(console)
    page.login("dev")
    for view in ("rollouts", "rollouts/new", f"rollouts/{id}"):
        page.go(view)
        page.until(lambda: page.all("h1") and not page.all("[aria-busy]"), f"{view} is loaded")
        width, overflow = page.overflow()
        assert (width <= 360, overflow <= 0) == (True, True), view
