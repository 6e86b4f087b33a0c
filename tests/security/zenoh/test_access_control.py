"""Zenoh's access control by graph and plan, with real sessions: the guard alone moves the base."""

import pytest

zenoh = pytest.importorskip("zenoh", reason="needs eclipse-zenoh (extra `dev`)")

from rmw_zenoh_keys import data_key, endpoint_token, node_token  # noqa: E402
from zenoh import ext  # noqa: E402
from zenoh_robot import (  # noqa: E402
    BASE,
    DOMAIN,
    GUARD,
    INPUT,
    MAPPER,
    NAV,
    ODOM,
    OPERATOR,
    OUTPUT,
    STOP,
    Driven,
    Heard,
    Server,
    ask,
    until,
)

GRAPH = f"@ros2_lv/{DOMAIN}/**"
END = b"end"


def test_the_app_runs(driven):
    odometry = Heard(driven.nav, ODOM)
    for payload in (b"1", b"2", b"3"):
        driven.drive(payload)
    assert driven.heard.payloads == [b"1", b"2", b"3"]
    publisher = driven.base.declare_publisher(ODOM)
    until(lambda: publisher.matching_status.matching, "the navigation's subscription")
    publisher.put(b"here")
    until(lambda: odometry.payloads == [b"here"], "odometry")


ATTACKS = {
    "a message on the output": lambda s: s.put(OUTPUT, b"bad"),
    "a publisher of the output": lambda s: s.declare_publisher(OUTPUT).put(b"bad"),
    "wildcards in the name": lambda s: s.put(f"{DOMAIN}/rtron/cmd_vel/**", b"bad"),
    "wildcards in a part": lambda s: s.put(f"{DOMAIN}/rtron/cmd_vel/o$*/*/*", b"bad"),
    "wildcards for all": lambda s: s.put("**", b"bad"),
    "its own key with a part open": lambda s: s.put(INPUT.replace("flow1/", "*/"), b"bad"),
    "a delete": lambda s: s.delete(OUTPUT),
    "a delete of everything": lambda s: s.delete("**"),
}


@pytest.mark.parametrize("attack", ATTACKS.values(), ids=ATTACKS)
def test_a_planned_process_cannot_go_past_the_guard(driven, attack):
    attack(driven.nav)
    driven.drive()
    assert driven.heard.payloads == [END]


@pytest.mark.parametrize("attack", ATTACKS.values(), ids=ATTACKS)
def test_each_attack_works_where_nothing_is_controlled(robot, attack):
    robot.restart_router(access_control={"enabled": False})
    driven = Driven(robot)
    attack(driven.nav)
    driven.drive()
    assert len(driven.heard.payloads) > 1


def test_nobody_else_hears_or_feeds_a_flow(driven):
    mapper, operator = map(driven.robot.session, (MAPPER, OPERATOR))
    overheard = [Heard(mapper, key) for key in (OUTPUT, "**", f"{DOMAIN}/rtron/**")]
    watched = Heard(operator, OUTPUT)
    until(lambda: driven.drive(b"1") or watched.payloads, "what the operator may read")
    for key in (OUTPUT, INPUT, "**"):
        operator.put(key, b"bad")
    driven.robot.finish(operator)
    driven.drive()
    assert [heard.payloads for heard in overheard] == [[], [], []]
    assert set(driven.heard.payloads) == {b"1", END}


def test_a_service_is_answered_by_its_server_alone(driven):
    mapper, operator = map(driven.robot.session, (MAPPER, OPERATOR))
    true = Server(driven.base, STOP, b"stopped")
    false = [Server(mapper, key, b"false") for key in (STOP, f"{DOMAIN}/base/**", "**")]
    false.append(Server(driven.guard, STOP, b"false"))
    until(lambda: ask(driven.nav), "the service")
    assert ask(driven.nav) == [b"stopped"]
    asked = true.asked
    assert ask(operator) == []
    assert ask(operator, "**") == []
    assert true.asked == asked
    assert sum(server.asked for server in false) == 0


def test_an_action_goes_between_its_client_and_its_server(driven):
    goals = data_key(DOMAIN, "/dock/_action/send_goal")
    true = driven.base.declare_queryable(goals, lambda q: q.reply(goals, b"yes"), complete=True)
    until(lambda: ask(driven.nav, goals) == [b"yes"], "the action's server")
    assert ask(driven.guard, goals) == []
    feedback = data_key(DOMAIN, "/dock/_action/feedback")
    heard = Heard(driven.nav, feedback)
    publisher = driven.base.declare_publisher(feedback)
    until(lambda: publisher.matching_status.matching, "the client's subscription")
    publisher.put(b"near")
    until(lambda: heard.payloads == [b"near"], "feedback")
    true.undeclare()


def listed(session):
    """Return the tokens that a router tells on request: none while it still asks others."""
    return {str(reply.ok.key_expr) for reply in session.liveliness().get(GRAPH, timeout=2.0)}


def test_the_graph_shows_each_process_under_its_own_names(driven):
    seen = set()
    graph = driven.base.liveliness().declare_subscriber(
        GRAPH, lambda sample: seen.add(str(sample.key_expr)), history=True
    )
    of_nav = {
        node_token(DOMAIN, NAV),
        endpoint_token(DOMAIN, "MP", NAV, "/rtron/cmd_vel/flow1"),
        endpoint_token(DOMAIN, "SC", NAV, "/base/stop"),
    }
    of_guard = {
        node_token(DOMAIN, "/rtron/grcn_cmd_vel"),
        endpoint_token(DOMAIN, "MP", GUARD, "/rtron/cmd_vel/out"),
    }
    forged = {
        *of_guard,
        node_token(DOMAIN, BASE),
        endpoint_token(DOMAIN, "MP", NAV, "/rtron/cmd_vel/out"),
        endpoint_token(DOMAIN, "SS", NAV, "/base/stop"),
        GRAPH,
        "**",
    }
    tokens = [driven.nav.liveliness().declare_token(key) for key in (*forged, *of_nav)]
    until(lambda: seen == of_nav, "the navigation's tokens")
    tokens += [driven.guard.liveliness().declare_token(key) for key in of_guard]
    until(lambda: seen == of_nav | of_guard, "the guard's tokens")
    until(lambda: listed(driven.base) == of_nav | of_guard, "the tokens on request")
    for each in (*tokens, graph):
        each.undeclare()


def stored_publisher(session):
    """Return a reliable, transient-local publisher as rmw_zenoh makes it."""
    return ext.declare_advanced_publisher(
        session,
        OUTPUT,
        cache=ext.CacheConfig(5),
        sample_miss_detection=ext.MissDetectionConfig(sporadic_heartbeat=0.1),
        publisher_detection=True,
    )


def stored_subscriber(session, heard):
    return ext.declare_advanced_subscriber(
        session,
        OUTPUT,
        lambda sample: heard.append(bytes(sample.payload)),
        history=ext.HistoryConfig(detect_late_publishers=True, max_samples=5),
        recovery=ext.RecoveryConfig(heartbeat=True),
        subscriber_detection=True,
    )


def test_a_late_subscriber_gets_what_the_guard_stored_and_nothing_forged(robot):
    guard, nav, base, mapper = map(robot.session, (GUARD, NAV, BASE, MAPPER))
    true, *false = [stored_publisher(session) for session in (guard, nav, mapper)]
    true.put(b"1")
    for publisher in false:
        publisher.put(b"bad")
    heard, overheard = [], []
    ends = stored_subscriber(base, heard), stored_subscriber(mapper, overheard)
    until(lambda: heard == [b"1"], "what was stored")
    true.put(b"2")
    until(lambda: heard == [b"1", b"2"], "the next")
    assert overheard == [b"bad"]
    for end in (*ends, true, *false):
        end.undeclare()
