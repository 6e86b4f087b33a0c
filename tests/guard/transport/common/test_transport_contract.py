"""What every transport keeps to, in memory, on a real ROS 1 and on a real ROS 2.

conftest.py gives the tests on a real ROS their marks: mark.ros1, mark.ros2.
"""

from dataclasses import replace
from functools import partial

import pytest

from rtron.guard.transport.common.protocol import InputOptions, OutputOptions
from rtron.vocabulary import SECOND, Durability, QoS

A, B, TALKER, LISTENER = "/rtron/a", "/rtron/b", "/talker", "/listener"
TOPIC = "/rtron/cmd/out"
LATCHED = QoS(durability=Durability.TRANSIENT_LOCAL)
STRING, FLOAT64 = "std_msgs/String", "std_msgs/Float64"


class PublisherLog:
    """Accepts the publishers that are named, or all; knows whom it was offered and whom it lost."""

    def __init__(self, *accepted):
        self.accepted = accepted
        self.offered = []
        self.lost = []
        self.heard = []

    def connect(self, peer):
        self.offered.append(peer)
        if self.accepted and peer.node not in self.accepted:
            return None
        return lambda message: self.heard.append((peer.node, message))

    @property
    def messages(self):
        return [message for _, message in self.heard]


def listening(world, *accepted, topic=TOPIC, type=STRING, node=A):
    ear = PublisherLog(*accepted)
    world.transport.subscribe(node, topic, type, ear.connect, InputOptions(on_lost=ear.lost.append))
    return ear


def talking(world, ear, node=TALKER, **kind):
    """Return a publisher whose first word was heard; what it said until then is forgotten."""
    publisher = world.publisher(node, TOPIC, **kind)
    publish_until(world, publisher.say, lambda: (node, world.text("hello")) in ear.heard)
    return publisher


def publish_until(world, say, condition):
    """Say hello again and again until it is noticed: connections take their time."""

    def noticed():
        if not condition():
            say(world.text("hello"))
        return condition()

    world.until(noticed)


def advance(world, duration):
    """Let so much time (ns) pass."""
    over = []
    world.transport.call_at(world.transport.now() + duration, lambda: over.append(True))
    world.until(lambda: over)


def said(world, count=None):
    sizes = [0, 1, 2, 3, 4, 5, 100, 5000, 100_000] if count is None else [1] * count
    return [world.text(f"{number} " + "x" * size) for number, size in enumerate(sizes)]


def without_first(world, messages):
    return [each for each in messages if each != world.text("hello")]


def test_what_comes_in_is_what_was_sent(world):
    ear = listening(world)
    publisher = talking(world, ear)
    for message in said(world):
        publisher.say(message)
    world.until(lambda: ear.messages and ear.messages[-1] == said(world)[-1])
    assert without_first(world, ear.messages) == said(world)


def test_what_goes_out_is_what_was_given(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    assert output.learn_type(world.info())
    heard = world.listener(LISTENER, TOPIC)
    publish_until(world, output.publish, lambda: heard)
    for message in said(world):
        output.publish(message)
    world.until(lambda: heard[-1] == said(world)[-1])
    assert without_first(world, heard) == said(world)


def test_what_waits_while_the_guard_is_busy_is_the_newest_and_bounded(world):
    ear = listening(world)
    publisher = talking(world, ear)
    words = said(world, 300)
    for message in words:
        publisher.say(message)
    world.let_arrive(publisher)
    world.until(lambda: ear.messages[-1] == words[-1])
    heard = without_first(world, ear.messages)
    assert heard == words[-len(heard) :]
    assert len(heard) <= world.most_waiting


def test_a_publisher_is_offered_once_with_its_name_and_type(world):
    ear = listening(world)
    talking(world, ear)
    (peer,) = ear.offered
    assert (peer.node, peer.verified, peer.latching) == (TALKER, True, False)
    assert (peer.info.type, peer.info.md5sum) == (STRING, world.info().md5sum)


def test_a_publisher_that_is_refused_is_not_heard(world):
    ear = listening(world, TALKER)
    refused = world.publisher("/stranger", TOPIC)
    publish_until(world, refused.say, lambda: ear.offered)
    publisher = talking(world, ear)
    refused.say(world.text("no"))
    publisher.say(world.text("last"))
    world.until(lambda: world.text("last") in ear.messages)
    assert {node for node, _ in ear.heard} == {TALKER}
    assert {peer.node for peer in ear.offered} == {"/stranger", TALKER}


def test_publishers_are_told_apart(world):
    ear = listening(world)
    one, other = talking(world, ear), talking(world, ear, "/other")
    one.say(world.text("one"))
    other.say(world.text("other"))
    expected = {(TALKER, world.text("one")), ("/other", world.text("other"))}
    world.until(lambda: expected <= set(ear.heard))


def test_who_leaves_is_lost_once(world):
    ear = listening(world)
    publisher = talking(world, ear)
    assert ear.lost == []
    publisher.leave()
    world.until(lambda: ear.lost)
    assert [peer.node for peer in ear.lost] == [TALKER]


def test_a_second_type_is_refused(world):
    output = world.transport.advertise(A, TOPIC, "")
    assert output.learn_type(world.info(STRING))
    assert output.learn_type(world.info(STRING))
    assert not output.learn_type(world.info(FLOAT64))
    assert output.learn_type(world.info(STRING))


def test_another_type_than_the_plan_s_is_refused(world):
    output = world.transport.advertise(A, TOPIC, FLOAT64)
    assert not output.learn_type(world.info(STRING))
    assert output.learn_type(world.info(FLOAT64))


@pytest.mark.parametrize("kind", [STRING, FLOAT64])
def test_the_type_is_learned_from_the_publisher(world, kind):
    ear = listening(world, type="")
    publisher = world.publisher(TALKER, TOPIC, kind)
    word = world.text("x" * 7) if kind == STRING else world.encoding.prefix(8) + bytes(8)
    world.until(lambda: publisher.say(word) or ear.offered)
    assert ear.offered[0].info.type == kind
    assert ear.offered[0].info.md5sum == world.info(kind).md5sum


def test_what_was_latched_before_the_guard_came_arrives(world):
    publisher = world.publisher(TALKER, TOPIC, latched=True)
    publisher.say(world.text("early"))
    ear = listening(world)
    world.until(lambda: ear.messages)
    assert ear.messages == [world.text("early")]
    assert ear.offered[0].latching


def test_late_subscribers_get_the_last_word_of_each(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    output.learn_type(world.info())
    for flow in ("one", "other"):
        output.offer(flow, LATCHED)
    for flow, word in (("one", "1"), ("other", "2"), ("one", "3")):
        output.publish(world.text(word), latched_by=flow)
    heard = world.listener(LISTENER, TOPIC, latched=True)
    world.until(lambda: len(heard) == 2)
    assert set(heard) == {world.text("2"), world.text("3")}


def test_a_busy_flow_leaves_the_last_word_of_a_quiet_one(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    output.learn_type(world.info())
    for flow in ("quiet", "busy"):
        output.offer(flow, LATCHED)
    output.publish(world.text("quiet"), latched_by="quiet")
    for number in range(20):
        output.publish(world.text(number), latched_by="busy")
    heard = world.listener(LISTENER, TOPIC, latched=True)
    world.until(lambda: len(heard) == 2)
    assert set(heard) == {world.text("quiet"), world.text(19)}


def test_what_is_kept_outlasts_a_change_of_qos(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    output.learn_type(world.info())
    output.offer("one", LATCHED)
    output.publish(world.text("kept"), latched_by="one")
    output.offer("other", replace(LATCHED, deadline=SECOND))
    heard = world.listener(LISTENER, TOPIC, latched=True)
    world.until(lambda: heard)
    assert heard == [world.text("kept")]


def test_what_was_meant_for_the_moment_is_not_told_to_who_comes_late(world):
    """Whoever is there gets all of it, also where late subscribers are told what is kept."""
    output = world.transport.advertise(A, TOPIC, STRING)
    output.learn_type(world.info())
    output.offer("one", LATCHED)
    here = world.listener(LISTENER, TOPIC, latched=True)
    publish_until(world, output.publish, lambda: here)
    words = said(world, 20)
    for word in words:
        output.publish(word)
    world.until(lambda: here[-1] == words[-1])
    assert without_first(world, here) == words
    advance(world, 2 * SECOND)
    late = world.listener("/late", TOPIC, latched=True)
    publish_until(world, lambda _: output.publish(world.text("new")), lambda: late)
    assert set(late) == {world.text("new")}


def test_what_is_forgotten_is_not_told(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    output.learn_type(world.info())
    output.offer("one", LATCHED)
    output.publish(world.text("old"), latched_by="one")
    output.clear_latched()
    heard = world.listener(LISTENER, TOPIC, latched=True)
    publish_until(world, partial(output.publish, latched_by="one"), lambda: heard)
    assert world.text("old") not in heard


def test_timers_are_called_in_order_and_not_before_their_time(world):
    called = []
    start = world.transport.now()
    for name, after in (("third", 3), ("first", 1), ("second", 2), ("second too", 2)):
        due = start + after * 1_000_000
        call = partial(
            lambda name, due: called.append((name, world.transport.now() >= due)), name, due
        )
        world.transport.call_at(due, call)
    world.transport.call_at(start, lambda: called.append(("at once", True)))
    world.until(lambda: len(called) == 5)
    names = ["at once", "first", "second", "second too", "third"]
    assert called == [(name, True) for name in names]


def test_two_nodes_of_the_guard(world):
    """They are two in the graph; each has its own topics."""
    one, other = listening(world, node=A), listening(world, topic="/other", node=B)
    output = world.transport.advertise(B, "/third", STRING)
    output.learn_type(world.info())
    heard = world.listener(LISTENER, "/third")
    publisher = talking(world, one)
    publish_until(world, output.publish, lambda: heard)
    publisher.say(world.text("last"))
    world.until(lambda: world.text("last") in one.messages)
    assert other.heard == []


def test_the_guard_never_hears_itself(world):
    ear = listening(world)
    output = world.transport.advertise(B, TOPIC, STRING)
    output.learn_type(world.info())
    heard = world.listener(LISTENER, TOPIC)
    publish_until(world, lambda _: output.publish(world.text("own")), lambda: heard)
    talking(world, ear)
    assert set(ear.heard) == {(TALKER, world.text("hello"))}
    assert {peer.node for peer in ear.offered} == {TALKER}


def test_nodes_that_are_joined_are_shown_as_connected(world):
    output = world.transport.link_nodes(A, B, "/joint", STRING)
    output.learn_type(world.info())
    output.offer("one", QoS())
    world.until(lambda: world.shows(A, B, "/joint"))


def test_whom_an_output_reaches(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    output.learn_type(world.info())
    world.listener(LISTENER, TOPIC)
    world.until(lambda: output.is_subscribed_by(LISTENER))
    assert not output.is_subscribed_by("/nobody")


def test_first_words_wait_for_an_expected_successor(world):
    """What is said while it is still connecting is not lost, and comes in order."""
    output = world.transport.advertise(A, TOPIC, STRING, OutputOptions(successors=(LISTENER,)))
    output.learn_type(world.info())
    heard = world.listener(LISTENER, TOPIC)
    words = said(world, 3)
    for message in words:
        output.publish(message)
    world.until(lambda: len(heard) >= len(words))
    assert heard == words


def test_who_begins_to_listen_is_greeted_and_gets_nothing_latched(world):
    output = world.transport.advertise(A, TOPIC, STRING)
    assert output.learn_type(world.info())
    greetings = []
    output.greet(lambda: world.text("stop") if greetings else None)
    first = world.listener(LISTENER, TOPIC)
    publish_until(world, output.publish, lambda: first)
    assert set(first) == {world.text("hello")}
    greetings.append("stop")
    late = world.listener("/late", TOPIC)
    world.until(lambda: late)
    assert late[0] == world.text("stop")
