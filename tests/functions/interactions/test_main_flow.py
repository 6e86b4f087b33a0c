"""What of a large graph is drawn."""

import pytest

from rtron.functions.interactions.abstract_graph import PackageMessages, abstract_graph
from rtron.functions.interactions.main_flow import main_flow
from rtron.vocabulary import FunctionType as F

ODD = "my_msgs/Odd"


def use(name, function, publishes=(), subscribes=()):
    return PackageMessages(
        name=name,
        functions=(function,),
        publishes=frozenset(publishes),
        subscribes=frozenset(subscribes),
    )


def publishers(number, function, type=ODD):
    return [use(f"{function}{i}", function, publishes=[type]) for i in range(number)]


def subscribers(number, function, type=ODD):
    return [use(f"h{function}{i}", function, subscribes=[type]) for i in range(number)]


def drawn(*packages):
    edges = main_flow(abstract_graph(packages)).direct
    return {(e.source, e.target) for e in edges if any(m.type == ODD for m in e.messages)}


def test_a_small_graph_is_drawn_whole():
    graph = abstract_graph([*publishers(1, F.MAPPING), *subscribers(1, F.SPEAKER)])
    assert main_flow(graph) == graph


@pytest.mark.parametrize(("few", "expected"), [(1, False), (2, True)])
def test_those_with_a_third_of_a_types_publishers_are_drawn(few, expected):
    found = drawn(
        *publishers(few, F.TELEOPERATION), *publishers(4, F.MAPPING), *subscribers(1, F.SPEAKER)
    )
    assert ("Mapping", "Speaker") in found
    assert (("Teleoperation", "Speaker") in found) is expected


@pytest.mark.parametrize(("few", "expected"), [(1, False), (2, True)])
def test_those_with_a_third_of_a_types_subscribers_are_drawn(few, expected):
    found = drawn(
        *publishers(1, F.MAPPING), *subscribers(few, F.SPEAKER), *subscribers(4, F.SWITCHER)
    )
    assert ("Mapping", "Switcher") in found
    assert (("Mapping", "Speaker") in found) is expected


@pytest.mark.parametrize(("others", "expected"), [(198, True), (199, False)])
def test_among_more_than_200_packages_one_is_too_few(others, expected):
    more = [PackageMessages(name=f"x{i}") for i in range(others)]
    found = drawn(*publishers(1, F.MAPPING), *subscribers(1, F.SPEAKER), *more)
    assert (("Mapping", "Speaker") in found) is expected


def test_what_is_typical_is_drawn_however_rare():
    twist = "geometry_msgs/Twist"
    senders_of_it = [*publishers(1, F.TELEOPERATION, twist), *publishers(9, F.MAPPING, twist)]
    graph = abstract_graph([*senders_of_it, *subscribers(1, F.MOBILE, twist)])
    assert ("Teleoperation", "Mobile") in {(e.source, e.target) for e in main_flow(graph).direct}


def test_functions_and_the_environment_stay():
    packages = [use("t", F.PATH_TRACKING), use("a", F.LOCALIZATION)]
    graph = abstract_graph(packages)
    assert main_flow(graph).functions == graph.functions
    assert main_flow(graph).indirect == graph.indirect != ()
