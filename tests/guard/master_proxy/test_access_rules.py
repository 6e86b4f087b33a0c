"""What the proxy forbids: every method, topic and name of a plan, and whatever callers make up."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from plans import grcn, plan_of

from rtron.guard.master_proxy.access_rules import (
    METHODS,
    MULTICALL,
    denial_reason,
    is_global_name,
    is_guard_name,
)
from rtron.vocabulary import Mode
from rtron.vocabulary.topic_access import list_topic_access

URI = "http://localhost:40000/"
TWIST = "geometry_msgs/Twist"
OUT, FLOW1, FLOW2 = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"
TOPICS = list_topic_access(plan_of(grcn("/cmd_vel", ["/nav", "/teleop_*"], ["/driver"])))
OPEN = list_topic_access(plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"], block_unapproved=False)))
GUARDS = ("/rtron_guard", "/rtron_supervisor", "/rtron/grcn_cmd_vel", "/rtron/any", "/rtron")
UNCLEAN = (
    "",
    "/",
    "nav",
    "~nav",
    "/nav/",
    "//nav",
    "/a//nav",
    "/nav ",
    "/na\nv",
    "/~nav",
    "/nav\u2028",
    "/nav\u00a0",
    "/" + "n" * 1000,
)
REGISTERING = {
    "registerPublisher": lambda caller, topic, uri: (caller, topic, TWIST, uri),
    "registerSubscriber": lambda caller, topic, uri: (caller, topic, TWIST, uri),
    "registerService": lambda caller, topic, uri: (caller, topic, "rosrpc://localhost:1", uri),
    "subscribeParam": lambda caller, topic, uri: (caller, uri, topic),
}
LEAVING = {
    "unregisterPublisher": ("/chatter", URI),
    "unregisterSubscriber": ("/chatter", URI),
    "unregisterService": ("/chatter", "rosrpc://localhost:1"),
    "unsubscribeParam": (URI, "/chatter"),
}
names = st.sampled_from(
    [*GUARDS, *UNCLEAN, "/nav", "/driver", "/teleop_1", "/rogue", OUT, FLOW1, "/cmd_vel", "/rosout"]
) | st.text(max_size=8)
values = st.recursive(
    names | st.integers() | st.none() | st.booleans() | st.binary(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=5,
)


def publishes(node, topic, topics=TOPICS):
    return not denial_reason(topics, "registerPublisher", (node, topic, TWIST, URI))


def subscribes(node, topic, topics=TOPICS):
    return not denial_reason(topics, "registerSubscriber", (node, topic, TWIST, URI))


@pytest.mark.parametrize(
    ("node", "topic", "may"),
    [
        ("/nav", FLOW1, True),
        ("/nav", FLOW2, False),
        ("/teleop_1", FLOW2, True),
        ("/teleop_", FLOW2, True),
        ("/teleop", FLOW2, False),
        ("/x/teleop_1", FLOW2, False),
        ("/navi", FLOW1, False),
        ("/ns/nav", FLOW1, False),
        ("/nav", OUT, False),
        ("/driver", OUT, False),
        ("/nav", "/cmd_vel", False),
        ("/rogue", "/cmd_vel", False),
        ("/rogue", "/cmd_vel2", True),
        ("/rogue", "/rtron/unplanned", False),
        ("/rogue", "/rtron", False),
        ("/rogue", "/rtrons", True),
        ("/rogue", "/chatter", True),
    ],
)
def test_who_may_publish_what(node, topic, may):
    assert publishes(node, topic) is may


@pytest.mark.parametrize(
    ("node", "topic", "may"),
    [
        ("/driver", OUT, True),
        ("/driver2", OUT, False),
        ("/rogue", OUT, False),
        ("/nav", FLOW1, False),
        ("/rogue", FLOW1, False),
        ("/rogue", "/cmd_vel", True),
        ("/rogue", "/rtron/monitor/fps", True),
        ("/rogue", "/rosout", False),
        ("/rosout", "/rosout", True),
        ("/rogue", "/rosout_agg", True),
    ],
)
def test_who_may_listen_to_what(node, topic, may):
    assert subscribes(node, topic) is may


def test_strangers_publish_the_public_name_where_the_plan_lets_them():
    assert publishes("/rogue", "/cmd_vel", OPEN)
    assert not publishes("/rogue", OUT, OPEN)
    assert not publishes("/rtron_guard", "/cmd_vel", OPEN)


def test_a_plan_that_only_observes_forbids_no_topic_but_the_guards():
    watched = plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"], mode=Mode.OBSERVE))
    topics = list_topic_access(watched)
    assert publishes("/rogue", "/cmd_vel", topics)
    assert subscribes("/rogue", "/rosout", topics)
    assert not publishes("/rogue", OUT, topics)


@pytest.mark.parametrize("name", GUARDS)
@pytest.mark.parametrize("method", REGISTERING)
def test_nobody_registers_under_a_name_of_the_guard(method, name):
    assert "guard's names" in denial_reason(TOPICS, method, REGISTERING[method](name, "/x", URI))


@pytest.mark.parametrize("name", GUARDS)
@pytest.mark.parametrize("method", LEAVING)
def test_nobody_takes_back_what_the_guard_registered(method, name):
    assert "guard's names" in denial_reason(TOPICS, method, (name, *LEAVING[method]))
    assert not denial_reason(TOPICS, method, ("/rogue", *LEAVING[method]))


@pytest.mark.parametrize("name", UNCLEAN)
@pytest.mark.parametrize("method", REGISTERING)
def test_a_name_that_ros_would_resolve_to_another_is_refused(method, name):
    assert denial_reason(TOPICS, method, REGISTERING[method](name, "/x", URI))
    if method != "subscribeParam":  # the key of a parameter is free
        assert denial_reason(TOPICS, method, REGISTERING[method]("/rogue", name, URI))


@pytest.mark.parametrize("name", UNCLEAN)
def test_a_node_is_looked_up_by_its_own_name(name):
    assert denial_reason(TOPICS, "lookupNode", ("/rogue", name))


@pytest.mark.parametrize(
    ("node", "may"),
    [("/driver", False), ("/nav", True), ("/rosout", True), ("/rogue", True)]
    + [(name, False) for name in GUARDS],
)
def test_whose_address_is_told(node, may):
    assert (not denial_reason(TOPICS, "lookupNode", ("/rogue", node))) is may


@pytest.mark.parametrize(
    "uri", ["", "x", "rosrpc://h:1", "http://h", "http://h:0", "http://h:99999/", 7, None, ["x"]]
)
@pytest.mark.parametrize("method", REGISTERING)
def test_an_address_that_is_none_is_refused(method, uri):
    assert "no address" in denial_reason(TOPICS, method, REGISTERING[method]("/rogue", "/x", uri))


@pytest.mark.parametrize("service", ["/rtron", "/rtron/x", "/rtron/grcn_cmd_vel/get_loggers"])
def test_no_service_has_a_name_of_the_guards(service):
    params = ("/rogue", service, "rosrpc://localhost:1", URI)
    assert denial_reason(TOPICS, "registerService", params)
    assert not denial_reason(
        TOPICS, "registerService", ("/rogue", "/x", "rosrpc://localhost:1", URI)
    )


def test_nobody_ends_the_master():
    assert denial_reason(TOPICS, "shutdown", ("/rogue", "because"))
    assert denial_reason((), "shutdown", ("/rogue", "because"))


@pytest.mark.parametrize("method", METHODS)
def test_each_method_takes_as_many_parameters_as_it_does(method):
    takes = METHODS[method].parameter_count
    for count in {0, takes - 1, takes + 1}:
        assert "parameters" in denial_reason(TOPICS, method, ("/rogue",) * count)
    assert "a string" in denial_reason(TOPICS, method, (7,) * takes)


ACTION = list_topic_access(
    plan_of(grcn("/go/goal", ["/client"], ["/server"], type="a_msgs/GoActionGoal"))
)
FACE = "/rtron/grcn_go_goal"


@pytest.mark.parametrize(
    ("node", "topic", "publish", "subscribe"),
    [
        ("/client", "/rtron/go/goal/flow1", True, False),
        ("/client", "/rtron/go/cancel/flow1", True, False),
        ("/client", "/rtron/go/status/out", False, True),
        ("/client", "/rtron/go/result/server", False, False),
        ("/server", "/rtron/go/goal/out", False, True),
        ("/server", "/rtron/go/cancel/out", False, True),
        ("/server", "/rtron/go/feedback/server", True, False),
        ("/server", "/rtron/go/feedback/out", False, False),
        ("/rogue", "/go/cancel", False, True),
        ("/rogue", "/go/result", False, True),
        ("/rogue", "/rtron/go/goal/out", False, False),
        (FACE, "/rtron/go/goal/out", False, False),
    ],
)
def test_the_five_topics_of_an_action(node, topic, publish, subscribe):
    assert publishes(node, topic, ACTION) is publish
    assert subscribes(node, topic, ACTION) is subscribe


@pytest.mark.parametrize("node", ["/client", "/server", FACE])
def test_the_ends_of_an_action_are_not_told(node):
    assert denial_reason(ACTION, "lookupNode", ("/rogue", node))


@given(st.text(max_size=20), st.lists(values, max_size=4))
@example(MULTICALL, [[]])
@example("system.listMethods", [])
@example("__class__", ["/x"])
def test_a_method_that_the_master_does_not_have_is_refused(method, params):
    if method not in METHODS:
        assert "no method" in denial_reason(TOPICS, method, params)


@given(st.sampled_from(sorted(METHODS)), st.lists(values, max_size=5))
def test_whatever_a_caller_says_there_is_an_answer_for_people(method, params):
    why = denial_reason(TOPICS, method, params)
    assert isinstance(why, str)
    assert why.isprintable()
    assert len(why) < 3000


@given(names, names, st.sampled_from(["registerPublisher", "registerSubscriber"]))
def test_only_planned_nodes_get_at_private_topics(node, topic, method):
    """The model: a private topic has its one planned node; /cmd_vel has no publisher."""
    if denial_reason(TOPICS, method, (node, topic, TWIST, URI)):
        return
    assert is_global_name(node)
    assert is_global_name(topic)
    assert not is_guard_name(node)
    if method == "registerPublisher":
        assert topic != "/cmd_vel"
        allowed = {FLOW1: node == "/nav", FLOW2: node.startswith("/teleop_")}
        assert allowed.get(topic, not topic.startswith("/rtron/"))
    else:
        assert {OUT: node == "/driver", FLOW1: False, FLOW2: False}.get(topic, True)


@given(st.text(max_size=30))
@example("/a/b")
def test_a_clean_name_is_what_ros_makes_of_it(name):
    """The model is rosgraph.names.canonicalize_name: slashes doubled or at the end go."""
    canonical = "/" + "/".join(part for part in name.split("/") if part)
    if is_global_name(name):
        assert name == canonical
        assert name.strip() == name
