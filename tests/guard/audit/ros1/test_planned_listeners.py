"""Whose connections the audit is told of: planned nodes, never crowded out by strangers."""

import pickle

from plans import grcn, plan_of

from rtron.guard.audit.ros1.expected_graph import MAX_MATCHING, ExpectedGraph, PlannedListeners
from rtron.guard.lanes.exchange.audit_exchange import NodesReport
from rtron.guard.lanes.exchange.message_channel import MAX_MESSAGE_BYTES
from rtron.guard.transport.ros1.subscriber_link import MAX_NAME

OUT = "/rtron/cmd_vel/out"
EXPECTED = ExpectedGraph(plan_of(grcn("/cmd_vel", ["/nav"], ["/driver", "/wheel_*"])))
LISTENERS = PlannedListeners(EXPECTED)
STRANGERS = [f"/stranger_{number}" for number in range(1000)]
WHEELS = [f"/wheel_{number}" for number in range(1000)]


def test_strangers_do_not_count():
    assert LISTENERS.select({OUT: STRANGERS, "/other": ["/x"]}) == {}
    assert not LISTENERS.includes("/stranger_1")
    assert LISTENERS.includes("/driver")
    assert LISTENERS.includes("/wheel_7")
    assert not LISTENERS.includes("/rtron_guard")


def test_a_planned_driver_is_never_crowded_out():
    found = LISTENERS.select({OUT: [*STRANGERS, *WHEELS, "/driver"]})
    assert found == {OUT: frozenset({"/driver", *WHEELS[:MAX_MATCHING]})}


def test_the_audit_knows_the_same_nodes():
    for node in ("/driver", "/wheel_1", "/stranger_1", "/nav", "/rtron_guard"):
        assert LISTENERS.includes(node) is bool(EXPECTED.audited_topics(node))


def test_the_names_of_many_strangers_are_not_remembered():
    for number in range(5000):
        EXPECTED.audited_topics(f"/stranger_{number}")
    assert len(EXPECTED._topics_by_node) <= 1024


def test_the_longest_report_fits_into_a_message():
    topics = [f"/rtron/topic_{number}/out" for number in range(200)]
    ends = [f"{number:04}" for number in range(MAX_MATCHING + 1)]
    long = {topic: [_long_name(f"{at:04}{end}") for end in ends] for at, topic in enumerate(topics)}
    report = NodesReport(subscribers=LISTENERS.select(long))
    assert {len(each) for each in report.subscribers.values()} == {MAX_MATCHING}
    assert len(pickle.dumps(report)) < MAX_MESSAGE_BYTES


def _long_name(end):
    return f"/wheel_{end}".ljust(MAX_NAME, "x")
