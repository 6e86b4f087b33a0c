"""What of a large graph is drawn."""

import pytest

from rtron.functions.interactions.abstract_graph import PackageUse, abstract_graph
from rtron.functions.interactions.main_flow import main_flow
from rtron.vocabulary import FunctionType as F

ODD = "my_msgs/Odd"


def use(name, function, sends=(), hears=()):
    return PackageUse(
        name=name, functions=(function,), publishes=frozenset(sends), subscribes=frozenset(hears)
    )


def senders(number, function, type=ODD):
    return [use(f"{function}{i}", function, sends=[type]) for i in range(number)]


def hearers(number, function, type=ODD):
    return [use(f"h{function}{i}", function, hears=[type]) for i in range(number)]


def drawn(*packages):
    edges = main_flow(abstract_graph(packages)).direct
    return {(e.source, e.target) for e in edges if any(m.type == ODD for m in e.messages)}


def test_a_small_graph_is_drawn_whole():
    graph = abstract_graph([*senders(1, F.MAPPING), *hearers(1, F.SPEAKER)])
    assert main_flow(graph) == graph


@pytest.mark.parametrize(("few", "expected"), [(1, False), (2, True)])
def test_those_with_a_third_of_a_types_publishers_are_drawn(few, expected):
    found = drawn(*senders(few, F.TELEOPERATION), *senders(4, F.MAPPING), *hearers(1, F.SPEAKER))
    assert ("Mapping", "Speaker") in found
    assert (("Teleoperation", "Speaker") in found) is expected


@pytest.mark.parametrize(("few", "expected"), [(1, False), (2, True)])
def test_those_with_a_third_of_a_types_subscribers_are_drawn(few, expected):
    found = drawn(*senders(1, F.MAPPING), *hearers(few, F.SPEAKER), *hearers(4, F.SWITCHER))
    assert ("Mapping", "Switcher") in found
    assert (("Mapping", "Speaker") in found) is expected


@pytest.mark.parametrize(("others", "expected"), [(198, True), (199, False)])
def test_among_more_than_200_packages_one_is_too_few(others, expected):
    more = [PackageUse(name=f"x{i}") for i in range(others)]
    found = drawn(*senders(1, F.MAPPING), *hearers(1, F.SPEAKER), *more)
    assert (("Mapping", "Speaker") in found) is expected


def test_what_is_typical_is_drawn_however_rare():
    twist = "geometry_msgs/Twist"
    senders_of_it = [*senders(1, F.TELEOPERATION, twist), *senders(9, F.MAPPING, twist)]
    graph = abstract_graph([*senders_of_it, *hearers(1, F.MOBILE, twist)])
    assert ("Teleoperation", "Mobile") in {(e.source, e.target) for e in main_flow(graph).direct}


def test_functions_and_the_environment_stay():
    packages = [use("t", F.PATH_TRACKING), use("a", F.LOCALIZATION)]
    graph = abstract_graph(packages)
    assert main_flow(graph).functions == graph.functions
    assert main_flow(graph).indirect == graph.indirect != ()
