"""The rules take time in proportion to the endpoints, also where everything meets in one topic."""

from dataclasses import replace

import pytest

from cpu_time import growth
from rtron.findings import app_facts, find_findings
from rtron.vocabulary import (
    Direction,
    Endpoint,
    InteractionGraph,
    Node,
    QoS,
    Reliability,
    WiringFact,
    WiringFactKind,
)

IDLE = WiringFactKind.IDLE_REMAP
TWIST, ODOMETRY = "geometry_msgs/Twist", "nav_msgs/Odometry"
PUB, SUB = Direction.PUBLISH, Direction.SUBSCRIBE
OFFERED = {PUB: QoS(reliability=Reliability.BEST_EFFORT), SUB: QoS()}


def crowd(size):
    """Everybody publishes and subscribes one topic, and no QoS fits."""
    return [(f"/n{i}", "/tf", direction) for i in range(size) for direction in Direction]


def hub(size):
    """One node publishes and subscribes everything, and no end meets another."""
    return [("/hub", f"/scan/{i}", (PUB, SUB)[i % 2]) for i in range(3 * size)]


def namesakes(size):
    """Everybody subscribes a topic of its own that is named alike."""
    ends = [(f"/n{i}", f"/robot{i}/scan", SUB) for i in range(size)]
    return ends + [("/laser", f"/laser{i}/scan", PUB) for i in range(size)]


def commands(size):
    """Everybody sends a command of its own that nobody reads, or obeys one that nobody sends."""
    ends = [(f"/n{i}", f"/nav{i}/cmd_vel", PUB) for i in range(size)]
    return ends + [(f"/base{i}", f"/base{i}/chassis", SUB) for i in range(size)]


def odometries(size):
    """Each robot's nodes command one another, and read what one filter makes of all odometries."""
    for i in range(size):
        yield "/ekf", f"/raw{i}", SUB, ODOMETRY
        yield "/ekf", f"/fused{i}", PUB, ODOMETRY
        yield f"/n{i}", f"/{('raw', 'fused')[i % 2]}{i}", SUB, ODOMETRY
        yield f"/n{i}", f"/c{i}/cmd_vel", SUB, TWIST
        yield f"/n{i}", f"/c{i + 1}/cmd_vel", PUB, TWIST


def open_names(size):
    """Everybody uses the same names known in part beside a topic of its own."""
    for i in range(size):
        yield f"/n{i}", f"/t{i}/cmd_vel", PUB, TWIST
        yield f"/n{i}", f"/u{i}/cmd_vel", SUB, TWIST
        yield f"/n{i}", "/x{a}/q", PUB, TWIST
        yield f"/n{i}", "/{a}/r", SUB, TWIST


def app(ends, type="a/B", wiring=(), nodes=()):
    return InteractionGraph(
        app="big",
        ros=2,
        nodes=nodes,
        wiring=wiring,
        endpoints=tuple(
            Endpoint(node=n, topic=t, type=(*own, type)[0], direction=d, qos=OFFERED[d])
            for n, t, d, *own in ends
        ),
    )


def findings(graph):
    """Find what is wrong in a copy, which knows nothing of what others have found."""
    find_findings(app_facts(replace(graph)))


@pytest.mark.parametrize("shape", [crowd, hub, namesakes])
def test_ten_times_the_endpoints_take_ten_times_as_long(shape):
    assert growth(findings, app(shape(500)), app(shape(5000))) < 30


def test_it_is_so_with_remaps_of_one_node_that_change_nothing():
    def remapped(size):
        facts = (
            WiringFact(kind=kind, subject=f"/old/{i}", value=f"/scan/{2 * i}", others=others)
            for i in range(size)
            for kind, others in ((WiringFactKind.UNUSED_REMAP, ("/hub",)), (IDLE, ()))
        )
        return tuple(facts)

    small, large = (app(hub(size), wiring=remapped(size)) for size in (300, 3000))
    assert growth(findings, small, large) < 30


def test_it_is_so_with_loose_commands():
    small, large = (app(commands(size), TWIST) for size in (500, 5000))
    assert growth(findings, small, large) < 30


def test_it_is_so_with_a_filter_of_many_odometries():
    nodes = (Node(name="/ekf", package="robot_localization"),)
    small, large = (app(odometries(size), nodes=nodes) for size in (40, 400))
    assert growth(findings, small, large) < 30


def test_it_is_so_with_names_that_are_known_in_part():
    small, large = (app(open_names(size)) for size in (300, 3000))
    assert growth(findings, small, large) < 30
