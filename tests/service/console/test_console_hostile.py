"""Names, reasons and messages come from strangers: the browser shows them and runs nothing."""

from dataclasses import replace

import pytest
from console_guard import hostile_plan
from console_robot import plan

from rtron.vocabulary import EventKind, GuardEventLevel

ATTACK = "<img src=x onerror=window.broken=1>"
FURTHER = (
    "</script><script>window.broken=1</script>",
    "<svg/onload=window.broken=1>",
    "javascript:window.broken=1//",
    "{{constructor.constructor('window.broken=1')()}}",
    '"onmouseover="window.broken=1',
    "\u202egnp.exe",
)
VIEWS = (
    "",
    "robots/turtle1/now",
    "robots/turtle1/graph",
    "robots/turtle1/risks",
    "robots/turtle1/nodes",
    "robots/turtle1/nodes/grcn_cmd_vel",
    "robots/turtle1/nodes/rsrcn",
    "robots/turtle1/nodes/msrcn",
    "robots/turtle1/rules",
    "robots/turtle1/events",
    "robots/turtle1/settings",
    "events",
    "audit",
    "users",
    "tokens",
    "webhooks",
    f"robots/{ATTACK}/now",
    f"{ATTACK}",
)


@pytest.fixture
def hostile_robot(console):
    guard = console.guard(guard_plan=hostile_plan(plan(ATTACK), ATTACK))
    for text in (ATTACK, *FURTHER):
        guard.event(
            EventKind.ALARM,
            level=GuardEventLevel.ERROR,
            node="grcn_cmd_vel",
            topic=text,
            flow=text,
            publisher=text,
            reason=f"because {text}",
            values={text: text},
        )
    guard.guard.attack = True
    guard.guard.intruder = ATTACK
    guard.send_state()
    stop = {"reason": f"stop {ATTACK}"}
    assert console.call("POST", "/robots/turtle1/stop", json=stop).status_code == 200
    hook = {"url": f"https://example.org/{FURTHER[0]}"}
    console.call("POST", "/webhooks", json=hook)
    return guard


def test_nothing_of_a_stranger_runs(hostile_robot, page):
    page.expect_log("404")
    page.login()
    for view in VIEWS:
        page.go(view)
        page.until(lambda: not page.all("[aria-busy]"), f"{view} is loaded")
        look(page, view)
    page.go("robots/turtle1/events")
    page.wait_for_text(f"because {ATTACK}")
    for more in page.all(".event button")[:3]:
        more.click()
    look(page, "the values of events")
    page.go("robots/turtle1/now")
    page.wait_for_text(f"stop {ATTACK}")
    page.wait_for_text(f"{ATTACK} publishes /cmd_vel")


def look(page, where):
    """Nothing ran, and no element came from a text."""
    broken = page.browser.execute_script(
        "return [window.broken === 1,"
        " document.querySelectorAll('img, iframe, object, embed, #app script').length,"
        " [...document.querySelectorAll('#app *')].flatMap((e) => [...e.attributes])"
        "  .filter((a) => a.name.startsWith('on')).length,"
        " [...document.querySelectorAll('a[href]')]"
        "  .filter((a) => !a.getAttribute('href').startsWith('#')).length];"
    )
    assert broken == [False, 0, 0, 0], where


def test_the_policy_of_the_page_forbids_what_is_inline(page):
    page.expect_log("Content Security Policy")
    page.login()
    ran = page.browser.execute_async_script(
        "const done = arguments[0], script = document.createElement('script');"
        "script.textContent = 'window.broken = 1';"
        "document.body.append(script);"
        "setTimeout('window.broken = 2', 0);"
        "setTimeout(() => done(window.broken === undefined), 50);"
    )
    assert ran
    page.browser.get_log("browser")


def test_a_flow_called_like_a_part_of_every_object_is_a_flow(console, page):
    found = plan()
    first = found.grcn[0]
    flows = (replace(first.flows[0], name="__proto__"), *first.flows[1:])
    odd = replace(found, grcn=(replace(first, flows=flows), *found.grcn[1:]))
    guard = console.guard(guard_plan=odd)
    page.login("dev", "robots/turtle1/nodes/grcn_cmd_vel")
    page.type_value("priority of __proto__", 7)
    page.press("Review and put in force …")
    page.reason("it comes first")
    page.press("Put in force", "dialog")
    page.wait_for_text("revision 1")
    assert guard.settings[-1].nodes["grcn_cmd_vel"].flows["__proto__"].priority == 7
