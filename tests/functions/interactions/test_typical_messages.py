"""The table of typical messages is whole and sound."""

from fnmatch import fnmatchcase

import pytest

from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.interactions.typical_messages import (
    environment_effects,
    function_of,
    is_generic,
    is_informative,
    is_typical_flow,
    typical_traffic,
)
from rtron.vocabulary import Domain, FunctionType, RecognitionSubfunction


def test_every_function_of_the_graph_is_there():
    inside = {f.value for f, domain in DOMAIN_BY_TYPE.items() if domain is not Domain.OTHERS}
    assert set(typical_traffic()) == inside | {s.value for s in RecognitionSubfunction}


@pytest.mark.parametrize("name", typical_traffic())
def test_every_entry_has_a_source_and_types_that_say_something(name):
    entry = typical_traffic()[name]
    assert entry.source
    assert entry.publishes or entry.subscribes
    for type in entry.publishes | entry.subscribes:
        assert fnmatchcase(type, "*_msgs/*")
        assert is_informative(type)


def test_every_subscribed_type_has_a_typical_publisher():
    published = frozenset().union(*(entry.publishes for entry in typical_traffic().values()))
    subscribed = frozenset().union(*(entry.subscribes for entry in typical_traffic().values()))
    assert subscribed <= published


def test_those_who_act_are_control_and_those_reached_are_known():
    for effect in environment_effects():
        assert all(DOMAIN_BY_TYPE[function_of(name)] is Domain.CONTROL for name in effect.sources)
        assert set(effect.targets) <= set(typical_traffic())


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        ("Sensors", "Preprocessing", True),
        ("Sensors", "Path Planning", False),
        ("Sensors", "Speaker", False),
        ("Mapping", "Localization", True),
        ("Image Recognition", "Goal Planner", True),
        ("Goal Planner", "Mapping", False),
        ("Path Tracking", "Path Planning", False),
        ("Path Tracking", "Mobile", True),
        ("Mobile", "Localization", True),
        ("Mobile", "Speaker", False),
    ],
)
def test_what_is_typical_flows_stage_by_stage(source, target, expected):
    assert is_typical_flow(source, target) is expected


def test_names_of_functions_and_subfunctions():
    assert function_of("Speech Recognition") is FunctionType.RECOGNITION
    assert function_of("Mobile") is FunctionType.MOBILE
    with pytest.raises(ValueError, match="Nothing"):
        function_of("Nothing")


@pytest.mark.parametrize(
    ("type", "something", "generic"),
    [
        ("std_msgs/String", True, True),
        ("std_msgs_more/String", True, False),
        ("tf/tfMessage", False, False),
        ("tf_own/Message", True, False),
        ("", False, False),
    ],
)
def test_what_types_say(type, something, generic):
    assert is_informative(type) is something
    assert is_generic(type) is generic
