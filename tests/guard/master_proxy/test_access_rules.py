"""What the fence forbids: every method, topic and name of a plan, and whatever callers make up."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from plans import grcn, plan_of

from rtron.guard.master_proxy.access_rules import APIS, MULTICALL, forbidden, is_clean, is_guards
from rtron.vocabulary import Mode
from rtron.vocabulary.topic_access import planned_topics

URI = "http://localhost:40000/"
TWIST = "geometry_msgs/Twist"
OUT, FLOW1, FLOW2 = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"
TOPICS = planned_topics(plan_of(grcn("/cmd_vel", ["/nav", "/teleop_*"], ["/driver"])))
OPEN = planned_topics(plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"], block_unapproved=False)))
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
    return not forbidden(topics, "registerPublisher", (node, topic, TWIST, URI))


def subscribes(node, topic, topics=TOPICS):
    return not forbidden(topics, "registerSubscriber", (node, topic, TWIST, URI))


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
    topics = planned_topics(watched)
    assert publishes("/rogue", "/cmd_vel", topics)
    assert subscribes("/rogue", "/rosout", topics)
    assert not publishes("/rogue", OUT, topics)


@pytest.mark.parametrize("name", GUARDS)
@pytest.mark.parametrize("method", REGISTERING)
def test_nobody_registers_under_a_name_of_the_guard(method, name):
    assert "guard's names" in forbidden(TOPICS, method, REGISTERING[method](name, "/x", URI))


@pytest.mark.parametrize("name", GUARDS)
@pytest.mark.parametrize("method", LEAVING)
def test_nobody_takes_back_what_the_guard_registered(method, name):
    assert "guard's names" in forbidden(TOPICS, method, (name, *LEAVING[method]))
    assert not forbidden(TOPICS, method, ("/rogue", *LEAVING[method]))


@pytest.mark.parametrize("name", UNCLEAN)
@pytest.mark.parametrize("method", REGISTERING)
def test_a_name_that_ros_would_resolve_to_another_is_refused(method, name):
    assert forbidden(TOPICS, method, REGISTERING[method](name, "/x", URI))
    if method != "subscribeParam":  # the key of a parameter is free
        assert forbidden(TOPICS, method, REGISTERING[method]("/rogue", name, URI))


@pytest.mark.parametrize("name", UNCLEAN)
def test_a_node_is_looked_up_by_its_own_name(name):
    assert forbidden(TOPICS, "lookupNode", ("/rogue", name))


@pytest.mark.parametrize(
    ("node", "may"),
    [("/driver", False), ("/nav", True), ("/rosout", True), ("/rogue", True)]
    + [(name, False) for name in GUARDS],
)
def test_whose_address_is_told(node, may):
    assert (not forbidden(TOPICS, "lookupNode", ("/rogue", node))) is may


@pytest.mark.parametrize(
    "uri", ["", "x", "rosrpc://h:1", "http://h", "http://h:0", "http://h:99999/", 7, None, ["x"]]
)
@pytest.mark.parametrize("method", REGISTERING)
def test_an_address_that_is_none_is_refused(method, uri):
    assert "no address" in forbidden(TOPICS, method, REGISTERING[method]("/rogue", "/x", uri))


@pytest.mark.parametrize("service", ["/rtron", "/rtron/x", "/rtron/grcn_cmd_vel/get_loggers"])
def test_no_service_has_a_name_of_the_guards(service):
    params = ("/rogue", service, "rosrpc://localhost:1", URI)
    assert forbidden(TOPICS, "registerService", params)
    assert not forbidden(TOPICS, "registerService", ("/rogue", "/x", "rosrpc://localhost:1", URI))


def test_nobody_ends_the_master():
    assert forbidden(TOPICS, "shutdown", ("/rogue", "because"))
    assert forbidden((), "shutdown", ("/rogue", "because"))


@pytest.mark.parametrize("method", APIS)
def test_each_method_takes_as_many_parameters_as_it_does(method):
    takes = APIS[method].takes
    for count in {0, takes - 1, takes + 1}:
        assert "parameters" in forbidden(TOPICS, method, ("/rogue",) * count)
    assert "a string" in forbidden(TOPICS, method, (7,) * takes)


ACTION = planned_topics(
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
    assert forbidden(ACTION, "lookupNode", ("/rogue", node))


@given(st.text(max_size=20), st.lists(values, max_size=4))
@example(MULTICALL, [[]])
@example("system.listMethods", [])
@example("__class__", ["/x"])
def test_a_method_that_the_master_does_not_have_is_refused(method, params):
    if method not in APIS:
        assert "no method" in forbidden(TOPICS, method, params)


@given(st.sampled_from(sorted(APIS)), st.lists(values, max_size=5))
def test_whatever_a_caller_says_there_is_an_answer_for_people(method, params):
    why = forbidden(TOPICS, method, params)
    assert isinstance(why, str)
    assert why.isprintable()
    assert len(why) < 3000


@given(names, names, st.sampled_from(["registerPublisher", "registerSubscriber"]))
def test_only_planned_nodes_get_at_private_topics(node, topic, method):
    """The model: a private topic has its one planned node; /cmd_vel has no publisher."""
    if forbidden(TOPICS, method, (node, topic, TWIST, URI)):
        return
    assert is_clean(node)
    assert is_clean(topic)
    assert not is_guards(node)
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
    if is_clean(name):
        assert name == canonical
        assert name.strip() == name
