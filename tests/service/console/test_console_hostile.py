"""Names, reasons and messages come from strangers: the browser shows them and runs nothing."""

import time
from dataclasses import fields, is_dataclass, replace

import pytest
from asked_guard import AskedGuard
from console_guard import hostile_plan
from console_page import VIEWS
from console_robot import plan
from incident_reports import NAME, a_report
from leased_guard import SERVED_PLAN, LeasedGuard

from rtron.vocabulary import EventKind, GuardEventLevel, LeaseStatus, OpenRequest, OpenRequests
from rtron.wire.common.incident_report import IncidentReport
from rtron.wire.common.link_protocol import IncidentSaved

ATTACK = "<img src=x onerror=window.broken=1>"
FURTHER = (
    "</script><script>window.broken=1</script>",
    "<svg/onload=window.broken=1>",
    "javascript:window.broken=1//",
    "{{constructor.constructor('window.broken=1')()}}",
    '"onmouseover="window.broken=1',
    "\u202egnp.exe",
)
WORDS = {"kind", "schema", "verdicts"}
"""The fields of a report that a service takes in its own words alone."""


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
    roll_out(console, ATTACK)
    guard.send(IncidentSaved(report=strange_report(ATTACK)))
    return guard


def strange_report(text):
    """Return the report of an incident in which every name and reason is a text."""
    return renamed(a_report(reason=text, text=text), text)


def renamed(found, text):
    """Return parts of a report with a text for each text, but for words and the file's name."""
    if is_dataclass(found):
        kept = {"name": found.name} if isinstance(found, IncidentReport) else {}
        values = {each.name: getattr(found, each.name) for each in fields(found)}
        made = {key: renamed(value, text) for key, value in values.items() if key not in WORDS}
        return replace(found, **made | kept)
    if isinstance(found, tuple):
        return tuple(renamed(each, text) for each in found)
    if isinstance(found, dict):
        return {renamed(key, text): renamed(value, text) for key, value in found.items()}
    return text if isinstance(found, str) else found


def roll_out(console, text):
    """Begin a roll-out on turtle1 for a reason that says a text."""
    new = {
        "robots": {"names": ["turtle1"]},
        "reason": f"since {text}",
        "nodes": {"grcn_cmd_vel": {"policy": "FIFO_Queue"}},
    }
    answer = console.call("POST", "/rollouts", json=new)
    assert answer.status_code == 201, answer.text


def test_nothing_of_a_stranger_runs(hostile_robot, page):
    page.expect_log("404")
    page.login()
    for view in (*VIEWS, f"robots/{ATTACK}/now", ATTACK):
        page.go(view)
        page.until(lambda: not page.all("[aria-busy]"), f"{view} is loaded")
        look(page, view)
    page.go("robots/turtle1/events")
    page.wait_for_text(f"because {ATTACK}")
    for more in page.all(".event button")[:3]:
        more.click()
    look(page, "the values of events")
    page.go("rollouts/1")
    page.wait_for_text(f"since {ATTACK}")
    page.go(f"robots/turtle1/incidents/{NAME}")
    page.wait_for_text(f"{ATTACK}: {ATTACK}")
    page.go("robots/turtle1/now")
    page.wait_for_text(f"stop {ATTACK}")
    page.wait_for_text(f"{ATTACK} publishes /cmd_vel")


HIDDEN = ("\u202e", "\u2066", "\u200b", "\u200f", "\u061c", "\ufeff", "\x1b", "\x9b", "\U000e0041")


def test_what_cannot_be_seen_is_written_out_and_turns_nothing_around(console, page):
    name = f"/{''.join(HIDDEN)}vel"
    guard = console.guard(guard_plan=hostile_plan(plan("app"), f"\u202eapp{HIDDEN[2]}"))
    guard.guard.attack, guard.guard.intruder = True, name
    guard.send_state()
    guard.event(EventKind.ALARM, level=GuardEventLevel.ERROR, topic=name, reason=f"it is {name}")
    roll_out(console, name)
    guard.send(IncidentSaved(report=strange_report(name.replace("\x1b", ""))))
    stop = {"reason": f"look {name}"}
    assert console.call("POST", "/robots/turtle1/stop", json=stop).status_code == 200
    page.login()
    page.wait_for_text("U+202E")
    for view in VIEWS:
        page.go(view)
        page.until(lambda: not page.all("[aria-busy]"), f"{view} is loaded")
        assert hidden(page) == [], view


def test_who_is_in_command_is_a_text(console, page, monkeypatch):
    name = f"/{ATTACK}{''.join(HIDDEN)}vel"
    plan = hostile_plan(SERVED_PLAN, name)
    guard = console.connect(LeasedGuard, plan, every=0.5)
    status = LeaseStatus(name="base", holder=name, reason=name, grant=1, given_by=name)
    monkeypatch.setattr(guard, "held", lambda: status)
    guard.tell_state()
    guard.record(EventKind.LEASE, publisher=name, reason=f"because {name}", values={name: name})
    page.login("ada", "robots/turtle1/command")
    page.wait_for_text("because", ".events")
    page.wait_for_text(ATTACK, "dl")
    look(page, "command")
    assert hidden(page) == []


def test_what_a_client_asks_for_is_a_text(console, page, monkeypatch):
    text = f"{ATTACK}{''.join(HIDDEN)}vel"
    guard = console.connect(AskedGuard, every=0.5)
    request = OpenRequest(
        number=1, digest=text, client=text, what=text, content=text, until=time.time_ns()
    )
    requests = OpenRequests(count=1, shown=(request,), roles=(text, "end_user"), names=(text,))
    monkeypatch.setattr(guard, "requests", lambda: requests)
    guard.tell_state()
    page.login("ada", "robots/turtle1/command")
    page.wait_for_text(ATTACK, ".request")
    look(page, "requests")
    assert hidden(page) == []
    page.press("Approve request 1 …")
    page.wait_for_text(ATTACK, "dialog")
    look(page, "an answer")
    assert hidden(page) == []


def hidden(page):
    """Return what texts and labels of the page have of characters that nobody sees."""
    return page.browser.execute_script(
        "const seen = [...document.querySelectorAll('#app *')].flatMap((e) => ["
        " ...[...e.childNodes].filter((c) => c.nodeType === 3).map((c) => c.data),"
        " e.getAttribute('title') ?? '', e.getAttribute('aria-label') ?? '']);"
        "return seen.filter((text) => arguments[0].some((each) => text.includes(each)));",
        HIDDEN,
    )


def test_what_runs_from_right_to_left_keeps_to_itself(console, guard, page):
    stop = {"reason": "\u05e9\u05dc\u05d5\u05dd"}
    console.call("POST", "/robots/turtle1/stop", json=stop)
    page.login("ada", "robots/turtle1/now")
    page.wait_for_text(f": \u2068{stop['reason']}\u2069 ·")


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
