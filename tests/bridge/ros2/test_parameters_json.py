"""Parameters of ROS 2 as JSON, and back."""

import json

import pytest

from rtron.bridge.protocol.effects import ParameterVerb, RequestParameter
from rtron.bridge.ros2.parameters import parameter_answer, parameter_call, parameter_value
from rtron.errors import SourceError

VALUES = [True, 5, 2.5, "ä", [True, False], [1, 2], [1.5, 2.5], ["a", "b"]]


def asked(verb, value=None, name="/nav:speed"):
    return RequestParameter(1, verb, name, value)


@pytest.mark.parametrize("value", VALUES)
def test_what_is_written_is_read(value):
    service, type, arguments = parameter_call(asked(ParameterVerb.SET, value))
    assert (service, type) == ("/nav/set_parameters", "rcl_interfaces/SetParameters")
    (parameter,) = arguments["parameters"]
    assert parameter["name"] == "speed"
    answer = parameter_answer(asked(ParameterVerb.GET), {"values": [parameter["value"]]})
    assert json.loads(answer["value"]) == value


def test_whole_numbers_among_others_are_floats():
    assert parameter_value([1, 2.5]) == {"type": 8, "double_array_value": [1.0, 2.5]}


@pytest.mark.parametrize("value", [None, {}, [], [1, "a"], [True, 1], [[1]], [None]])
def test_what_no_parameter_has_is_refused(value):
    with pytest.raises(SourceError, match="a parameter is a number"):
        parameter_call(asked(ParameterVerb.SET, value))


@pytest.mark.parametrize("name", ["/nav", "/nav:"])
def test_a_parameter_without_a_node_is_refused(name):
    with pytest.raises(SourceError, match="is /node:name"):
        parameter_call(asked(ParameterVerb.GET, name=name))


@pytest.mark.parametrize("response", [{}, {"values": []}, {"values": [{"type": 0}]}])
def test_a_parameter_that_is_not_there(response):
    assert parameter_answer(asked(ParameterVerb.HAS), response) == {"exists": False}
    with pytest.raises(SourceError, match="there is no parameter /nav:speed"):
        parameter_answer(asked(ParameterVerb.GET), response)


@pytest.mark.parametrize("verb", [ParameterVerb.SET, ParameterVerb.DELETE])
def test_a_node_says_yes_or_no(verb):
    yes = {"results": [{"successful": True, "reason": ""}]}
    assert parameter_answer(asked(verb), yes) == {"successful": True}
    for no in ({"results": [{"successful": False, "reason": "too fast"}]}, {}):
        with pytest.raises(SourceError, match="/nav:speed is not set: "):
            parameter_answer(asked(verb), no)


def test_to_delete_is_to_set_nothing():
    _, _, arguments = parameter_call(asked(ParameterVerb.DELETE))
    assert arguments == {"parameters": [{"name": "speed", "value": {"type": 0}}]}
