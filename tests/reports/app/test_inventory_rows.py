"""The words of an inventory, as text and as JSON."""

import json
from dataclasses import replace

import pytest

from rtron.reports.app.inventory_rows import inventory_to_json, mover_rows
from rtron.reports.app.scan_text import inventory_list
from rtron.reports.text_layout import Report
from rtron.vocabulary import Evidence
from rtron.vocabulary.inventory import Command, Means, Mover, Stops, Thing

CMD_VEL = Command(
    means=Means.TOPIC,
    name="/cmd_vel",
    type="geometry_msgs/Twist",
    receivers=("/base",),
    senders=("/mux",),
)
NAV = Command(
    means=Means.TOPIC, name="/nav_vel", receivers=("/mux",), senders=("/nav",), hops=1, priority="1"
)
JOY = Command(means=Means.TOPIC, name="/joy_vel", receivers=("/mux",), hops=1, priority="20")
BASE = Mover(
    thing=Thing.BASE,
    commands=(CMD_VEL, NAV, JOY),
    drivers=("/base",),
    hardware=("serial port",),
    arbiters=("/mux",),
    doors=("/bridge (any client)",),
    operators=("/nav (joystick)",),
    stops=Stops.NO,
    stop="nothing in it looks",
    evidence=(Evidence(file="base.py", line=3),),
)
TEXT = """\

What can move this robot
  base            /base (serial port) obeys /cmd_vel
                  sent by /nav through /mux; the first of /joy_vel (20),
                  /nav_vel (1) wins
                  open: nobody in this launch sends /joy_vel; any node can
                  a person commands it by /nav (joystick)
                  reached from a network through /bridge (any client)
                  stops when commands end: no; nothing in it looks
"""


@pytest.fixture
def text(printed):
    """Return an inventory as text."""

    def show(movers, *, is_whole=True):
        return printed(Report(lambda page: inventory_list(movers, page, is_whole=is_whole)))

    return show


def rows(**parts):
    return [row.text for row in mover_rows(Mover(**parts))]


def service(name, *, receivers=(), senders=()):
    return Command(means=Means.SERVICE, name=name, receivers=receivers, senders=senders)


def test_a_base_as_text(text):
    assert text([BASE]) == TEXT


@pytest.mark.parametrize(
    ("is_whole", "words"), [(True, "nothing"), (False, "nothing in what could be read, see below")]
)
def test_where_nothing_moves_it_says_so(text, is_whole, words):
    assert text([], is_whole=is_whole) == f"\nWhat can move this robot\n  {words}\n"


def test_what_was_not_read():
    assert rows(thing=Thing.DEVICE, commands=(), drivers=("/agent",)) == [
        "/agent may obey any topic: what is behind it was not read"
    ]
    pilot = {"commands": (), "drivers": ("/pilot",), "hardware": ("vehicle link",)}
    (row,) = rows(thing=Thing.VEHICLE, **pilot)
    assert row.startswith("/pilot (vehicle link) moves it by itself, or obeys a device or link of")
    row, by = rows(thing=Thing.VEHICLE, operators=("/pilot (joystick)",), **pilot)
    assert row == "/pilot (vehicle link) moves it as its operator says: no topic commands it"
    assert by == "a person commands it by /pilot (joystick)"


def test_a_topic_that_nobody_here_obeys_or_sends():
    command = Command(means=Means.TOPIC, name="/cmd_vel")
    assert rows(thing=Thing.BASE, commands=(command,)) == [
        "/cmd_vel, obeyed by nobody in this launch",
        "sent by nobody in this launch",
        "open: nobody in this launch sends /cmd_vel; any node can",
    ]


def test_a_node_that_is_commanded_itself_may_be_the_only_sender():
    command = Command(means=Means.TOPIC, name="/cmd_vel", receivers=("/base",), senders=("/nav",))
    found = rows(thing=Thing.BASE, commands=(command,), drivers=("/base",), arbiters=("/nav",))
    assert found == ["/base obeys /cmd_vel", "sent by /nav"]


def test_a_topic_that_a_node_may_obey_which_was_not_read():
    command = Command(means=Means.TOPIC, name="/cmd_vel", senders=("/nav",))
    found = rows(thing=Thing.BASE, commands=(command,), unread=("/one", "/two"))
    assert found[0] == "/cmd_vel, obeyed by nobody that was read; /one and /two may"
    found = rows(thing=Thing.BASE, commands=(command,), unread=("include $(find p)/a.launch",))
    starts = "what $(find p)/a.launch starts may"
    assert found[0] == f"/cmd_vel, obeyed by nobody that was read; {starts}"


def test_who_tells_a_sender_without_an_arbiter():
    command = Command(means=Means.TOPIC, name="/cmd_vel", receivers=("/b",), senders=("/teleop",))
    joy = Command(
        means=Means.TOPIC, name="/joy", receivers=("/teleop",), senders=("/joy_node",), hops=1
    )
    found = rows(thing=Thing.BASE, commands=(command, joy), drivers=("/b",))
    assert found == [
        "/b obeys /cmd_vel",
        "sent by /teleop, told by /joy_node",
        "behind it: /joy; any node can send there, too",
    ]


def test_who_goes_past_an_arbiter_is_said_apart():
    direct = Command(
        means=Means.TOPIC, name="/cmd_vel", receivers=("/b",), senders=("/mux", "/rogue")
    )
    behind = Command(
        means=Means.TOPIC, name="/nav_vel", receivers=("/mux",), senders=("/nav",), hops=1
    )
    found = rows(thing=Thing.BASE, commands=(direct, behind), drivers=("/b",), arbiters=("/mux",))
    assert found[1] == "sent by /rogue directly, and by /nav through /mux"


def test_who_only_tells_a_sender_does_not_send_through_the_arbiter():
    key = Command(
        means=Means.TOPIC, name="/key_vel", receivers=("/mux",), senders=("/teleop",), hops=1
    )
    joy = Command(
        means=Means.TOPIC, name="/joy", receivers=("/teleop",), senders=("/joy_node",), hops=2
    )
    commands = (CMD_VEL, NAV, key, joy)
    found = rows(thing=Thing.BASE, commands=commands, drivers=("/base",), arbiters=("/mux",))
    assert found[1].startswith("sent by /nav and /teleop through /mux, told by /joy_node; ")
    pad = replace(joy, type="sensor_msgs/Joy", receivers=("/mux",))
    found = rows(thing=Thing.BASE, commands=(CMD_VEL, pad), drivers=("/base",), arbiters=("/mux",))
    assert found[1] == "sent by /mux, told by /joy_node"


def test_services_and_goals():
    arm = service("/arm", receivers=("/driver",), senders=("/mission",))
    goal = Command(means=Means.ACTION, name="/go", receivers=("/nav",))
    assert rows(thing=Thing.BASE, commands=(arm, goal), drivers=("/driver",)) == [
        "services /arm of /driver, called by /mission",
        "goals /go of /nav, sent by nobody in this launch",
        "open: nobody in this launch sends /go; any node can",
    ]


def test_who_tells_those_that_call_is_said():
    blade = service("/blade", receivers=("/driver",), senders=("/logic",))
    orders = replace(NAV, receivers=("/logic",), senders=("/cloud", "/logic"))
    (row, *_) = rows(thing=Thing.TOOL, commands=(blade, orders), drivers=("/driver",))
    assert row == "services /blade of /driver, called by /logic, told by /cloud"
    (_, _, row, *_) = rows(thing=Thing.TOOL, commands=(CMD_VEL, blade, orders), drivers=("/base",))
    assert row == "services /blade of /driver, called by /logic"


def test_many_names_are_counted_and_names_known_in_part_are_not_open():
    found = tuple(service(f"/s{number}") for number in range(9))
    row, *_ = rows(thing=Thing.MODE, commands=found)
    assert row.startswith("services /s0, /s1, /s2, /s3, /s4, /s5, /s6 and 2 more of")
    part = Command(means=Means.TOPIC, name="/{robot}/cmd_vel")
    assert not any("open" in row for row in rows(thing=Thing.BASE, commands=(part,)))


def test_parameters():
    limit = Command(means=Means.PARAMETER, name="/nav.max_vel", receivers=("/nav",))
    assert rows(thing=Thing.LIMITS, commands=(limit,), drivers=("/nav",)) == [
        "any node can set /nav.max_vel while the app runs"
    ]


def test_as_json():
    (base,) = json.loads(json.dumps(inventory_to_json([BASE])))
    assert base["rows"][0] == {"text": "/base (serial port) obeys /cmd_vel", "tone": "plain"}
    assert base | {"commands": [], "rows": []} == {
        "thing": "base",
        "rows": [],
        "drivers": ["/base"],
        "hardware": ["serial port"],
        "commands": [],
        "arbiters": ["/mux"],
        "doors": ["/bridge (any client)"],
        "operators": ["/nav (joystick)"],
        "unread": [],
        "stops": "no",
        "why": "nothing in it looks",
        "evidence": [{"file": "base.py", "line": 3}],
    }
    assert base["commands"][1] == {
        "means": "topic",
        "name": "/nav_vel",
        "type": "",
        "receivers": ["/mux"],
        "senders": ["/nav"],
        "hops": 1,
        "priority": "1",
    }


def test_who_sends_beside_an_arbiter_is_no_way_through_it():
    last = replace(CMD_VEL, senders=("/follower", "/mux"))
    goal = Command(means=Means.TOPIC, name="/goal", receivers=("/follower",), hops=1)
    text = rows(
        thing=Thing.BASE, commands=(last, NAV, goal), drivers=("/base",), arbiters=("/mux",)
    )
    assert (
        text[1]
        == "sent by /follower directly, and by /nav through /mux; the first of /nav_vel (1) wins"
    )


def test_where_not_all_was_read_an_unread_node_may_send_what_nobody_does():
    text = rows(thing=Thing.BASE, commands=(JOY,), is_whole=False)
    assert "open: nobody that was read sends /joy_vel; any node can" in text
