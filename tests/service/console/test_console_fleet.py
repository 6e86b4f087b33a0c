"""The console with 1,000 robots, in a real browser against the real service."""

import csv
import io
import json
import time

from console_fleet import SIZE, alarm
from harness import wait_for
from selenium.webdriver.common.keys import Keys


def names(page):
    """Return the robots of the rows that are drawn, in their order."""
    return page.browser.execute_script(
        "return [...document.querySelectorAll('.fleet td.name')].map((cell) => cell.textContent);"
    )


def wait_for_first(page, *expected):
    page.until(lambda: names(page)[: len(expected)] == list(expected), f"{expected} first")


def search(page, text):
    field = page.find("#content input[type=search]")
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys(text or Keys.DELETE)


def press_state(page, word):
    """Press the button of a state in the filter."""

    def act():
        buttons = page.all(".chips button")
        next(each for each in buttons if each.text.startswith(word)).click()
        return True

    page.until(act, word)


def focused(page):
    return page.browser.switch_to.active_element


def test_what_is_the_matter_comes_first_and_only_what_is_seen_is_drawn_on_a_phone_too(
    console, fleet, page
):
    fleet.state("robot500", alarms=(alarm(),))
    fleet.disconnect("robot3")
    assert console.call("POST", "/robots/robot7/stop", json={"reason": "smoke"}).status_code == 200
    page.login()
    page.wait_for_text("1,000 robots, 999 connected")
    wait_for_first(page, "robot500", "robot7", "robot3", "robot0", "robot1")
    page.wait_for_text("somebody speaks on /cmd_vel", ".fleet")
    page.wait_for_text("emergency stop by ada: smoke", ".fleet")
    assert len(page.all(".fleet tr")) < 100
    assert page.find(".fleet").get_attribute("aria-rowcount") == str(SIZE + 1)
    page.show_on_phone()
    wait_for_first(page, "robot500")
    width, overflow = page.overflow()
    assert (width <= 360, overflow <= 0) == (True, True)
    page.browser.execute_script("document.getElementById('content').scrollTo(0, 1e9)")
    page.until(lambda: names(page)[-1] == "robot999")


ALARM_ENDS_AND_WINDOW_SHRINKS = """
modules["store.js"].takeChanges({ robot900: { alarms: [] } });
const content = document.getElementById("content");
content.style.height = "300px";
content.dispatchEvent(new Event("scroll"));
"""


def test_the_table_follows_what_happens(console, fleet, page):
    """Rows may be drawn before the table hears of a change."""
    page.login()
    wait_for_first(page, "robot0")
    fleet.state("robot900", alarms=(alarm(),))
    wait_for_first(page, "robot900", "robot0")
    page.browser.execute_script(ALARM_ENDS_AND_WINDOW_SHRINKS)
    wait_for_first(page, "robot0", "robot1")
    fleet.state("robot900")
    fleet.disconnect("robot901")
    wait_for_first(page, "robot901", "robot0")
    console.call("POST", "/robots/robot902/stop", json={})
    wait_for_first(page, "robot902", "robot901", "robot0")


def test_a_guard_over_the_real_link_is_one_of_them(console, fleet, page):
    page.login()
    wait_for_first(page, "robot0")
    guard = console.guard("turtle1")
    guard.attack()
    wait_for_first(page, "turtle1")
    page.wait_for_text("/rviz_intruder publishes /cmd_vel", ".fleet")
    page.press("turtle1", ".fleet")
    page.wait_for_text("/control_lane", "table")
    guard.close()
    page.go("")
    page.wait_for_text("not connected", ".fleet")


def test_a_silent_guard_is_told(silent_fleet, page):
    page.login()
    page.wait_for_text("1,000 robots")
    page.wait_for_text("its guard is connected and says nothing", ".fleet")
    with silent_fleet.speaking():
        page.wait_without_text("says nothing")


def test_robots_are_found_by_words_and_states(console, fleet, page):
    fleet.state("robot500", alarms=(alarm("a bridge forwards what it must not"),))
    fleet.state("robot501", overridden=("drive",))
    page.login()
    wait_for_first(page, "robot500")
    search(page, "robot77")
    wait_for_first(page, "robot77", "robot770", "robot771")
    assert len(names(page)) == 11
    search(page, "bridge robot5")
    page.until(lambda: names(page) == ["robot500"])
    search(page, "no such robot")
    page.wait_for_text("No robot fits the filter")
    page.press("Show all")
    press_state(page, "overridden")
    page.until(lambda: names(page) == ["robot501"])
    page.press("robot501", ".fleet")
    page.wait_for_text("robot501", "h1")
    page.browser.back()
    page.until(lambda: names(page) == ["robot501"])


def test_what_the_table_shows_is_exported(fleet, page, tmp_path):
    page.download_to(tmp_path)
    fleet.state("robot771", alarms=(alarm(),))
    fleet.state("robot3", overridden=("drive",))
    page.login()
    wait_for_first(page, "robot771")
    search(page, "robot77")
    page.until(lambda: len(names(page)) == 11)
    shown = names(page)
    assert shown[:2] == ["robot771", "robot77"]
    page.press("CSV")
    page.wait_for_text("11 robots exported")
    file = tmp_path / "rtron-robots.csv"
    page.await_download(file)
    rows = list(csv.DictReader(io.StringIO(file.read_text("utf-8-sig"))))
    assert [row["name"] for row in rows] == shown
    search(page, "")
    press_state(page, "overridden")
    page.until(lambda: names(page) == ["robot3"])
    page.press("JSON")
    file = tmp_path / "rtron-robots.json"
    page.await_download(file)
    assert [robot["name"] for robot in json.loads(file.read_text())] == ["robot3"]


def test_the_keyboard_alone_leads_to_every_robot(fleet, page):
    page.login()
    wait_for_first(page, "robot0")
    focused(page).send_keys(Keys.TAB)
    assert focused(page).get_attribute("id") == "stop"
    focused(page).send_keys(Keys.TAB)
    focused(page).send_keys(Keys.ENTER)
    assert focused(page).get_attribute("id") == "content"
    for _ in range(30):
        if focused(page).find_elements("xpath", "ancestor::table"):
            break
        focused(page).send_keys(Keys.TAB)
    assert focused(page).text == "robot0"
    focused(page).send_keys(Keys.ARROW_DOWN)
    page.until(lambda: focused(page).text == "robot1")
    focused(page).send_keys(Keys.END)
    page.until(lambda: focused(page).text == "robot999")
    focused(page).send_keys(Keys.PAGE_UP)
    page.until(lambda: focused(page).text == "robot989")
    focused(page).send_keys(Keys.ENTER)
    page.wait_for_text("robot989", "h1")


def stopped(fleet):
    return {name for name, link in fleet.links.items() if hasattr(link, "settings")}


def test_a_key_stops_what_is_in_view_what_the_filter_shows_and_a_thousand(fleet, page):
    page.login("eva", "robots/robot5/now")
    page.wait_for_text("robot5", "h1")
    page.find("body").send_keys(Keys.F8)
    page.wait_for_text("Stop robot5 now", "dialog")
    focused(page).send_keys(Keys.ENTER)
    wait_for(lambda: stopped(fleet) == {"robot5"})
    assert fleet.links["robot5"].settings.stop.by == "eva"
    page.until(lambda: not page.all("dialog"))
    page.go("")
    wait_for_first(page, "robot5", "robot0")
    search(page, "robot12")
    page.until(lambda: len(names(page)) == 11)
    page.find("body").send_keys(Keys.F8)
    page.wait_for_text("all 1,000 robots", "dialog")
    page.find("dialog input[value=shown]").click()
    page.press("Stop them now", "dialog")
    page.wait_for_text("Emergency stop sent to 11 robots", ".toasts")
    assert stopped(fleet) == {"robot5", "robot12", *(f"robot12{n}" for n in range(10))}
    page.until(lambda: not page.all("dialog"))
    search(page, "")
    page.until(lambda: len(names(page)) > 11)
    page.find("body").send_keys(Keys.F8)
    page.wait_for_text("Stop 1,000 robots", "dialog")
    page.press("Stop them now", "dialog")
    page.wait_for_text("Emergency stop sent to 1,000 robots", ".toasts")
    assert all(link.settings.stop for link in fleet.links.values())


def test_a_fleet_that_speaks_costs_a_console_little(fleet, page):
    """1,000 states a second are no messages for who looks at the table."""
    with page.recorded_frames() as new_frames:
        page.login()
        wait_for_first(page, "robot0")
        new_frames()
        begin = time.monotonic()
        fleet.state("robot1", alarms=(alarm(),))
        wait_for_first(page, "robot1")
        time.sleep(4)
        frames, seconds = new_frames(), time.monotonic() - begin
    assert 1 <= len(frames) <= 2 * seconds + 2
    assert sum(map(len, frames)) < 5000


MOST_REQUESTS = 8
MOST_BYTES = 70_000


def loaded(page):
    """Return the requests since the navigation, and the bytes that came for them."""
    return page.browser.execute_script("""
        const all = [...performance.getEntriesByType("navigation"),
                     ...performance.getEntriesByType("resource")];
        const size = all.reduce((sum, each) => sum + each.transferSize, 0);
        return [all.map((each) => each.name), size];
    """)


def test_all_robots_of_a_fleet_are_there_after_few_requests(console, fleet, cold):
    cold.browser.get(console.base)
    cold.wait_for_text("1,000 robots, 1,000 connected")
    cold.until(lambda: not cold.all(".banner"))
    requests, size = loaded(cold)
    assert len(requests) <= MOST_REQUESTS, "\n".join(requests)
    assert size <= MOST_BYTES
