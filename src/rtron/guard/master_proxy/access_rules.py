"""What the plan forbids on the Master and Parameter Server APIs; pure decisions.

ROS wiki: Master_API, Parameter Server API. What the plan does not name is left alone; where it
names a topic or a node, only what it lets happen does.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rtron.errors import WireError
from rtron.vocabulary import TopicAccess, is_guard_name, is_private_name, matches_node
from rtron.wire.ros1.xmlrpc import split_uri

ROSOUT = "/rosout"
MULTICALL = "system.multicall"
_LONGEST_NAME = 1000

Topics = Sequence[TopicAccess]
Check = Callable[..., str]


@dataclass(frozen=True, slots=True, kw_only=True)
class MasterMethod:
    """One method: how many parameters it takes, and its value beside an error.

    `uri_index` is the place of the parameter that gives the caller's own address, 0 without one.
    """

    parameter_count: int
    error_value: Any
    uri_index: int = 0
    check: Check = lambda topics, *params: ""


def denial_reason(topics: Topics, method: str, params: Sequence[Any]) -> str:
    """Return why a plan with these `topics` forbids a call, or nothing if it does not.

    Nothing that the caller says is believed to be well-formed; what cannot be judged is forbidden.
    """
    api = METHODS.get(method)
    if api is None:
        return f"there is no method {method[:_LONGEST_NAME]!r} for callers of the master proxy"
    if len(params) != api.parameter_count:
        return f"{method} takes {api.parameter_count} parameters"
    if not isinstance(params[0], str):
        return "a caller_id is a string"
    return api.check(topics, *params)


def is_global_name(name: object) -> bool:
    """Tell whether a name is global and written as ROS resolves it, so that it means itself."""
    return (
        isinstance(name, str)
        and len(name) <= _LONGEST_NAME
        and name.startswith("/")
        and not name.endswith("/")
        and "//" not in name
        and name.isprintable()
        and not any(character in " ~" for character in name)
    )


def _check_publish(topics: Topics, caller: str, topic: Any, _type: Any, uri: Any) -> str:  # noqa: ANN401
    if why := _check_registration(topics, caller, uri) or _check_name(topic):
        return why
    planned = [each for each in topics if each.topic == topic]
    if not planned:
        return f"{topic} is the guard's to publish" if is_private_name(topic) else ""
    is_allowed = any(each.may_publish(caller) for each in planned)
    return "" if is_allowed else f"the plan does not let {caller} publish {topic}"


def _check_subscribe(topics: Topics, caller: str, topic: Any, _type: Any, uri: Any) -> str:  # noqa: ANN401
    if why := _check_registration(topics, caller, uri) or _check_name(topic):
        return why
    if topics and topic == ROSOUT and caller != ROSOUT:
        return f"all publish {ROSOUT}, and who hears it knows their addresses; use {ROSOUT}_agg"
    planned = [each for each in topics if each.topic == topic]
    is_allowed = not planned or any(each.may_subscribe(caller) for each in planned)
    return "" if is_allowed else f"the plan does not let {caller} subscribe {topic}"


def _check_service(topics: Topics, caller: str, service: Any, _api: Any, uri: Any) -> str:  # noqa: ANN401
    if why := _check_registration(topics, caller, uri) or _check_name(service):
        return why
    return f"{service} is the guard's to serve" if is_private_name(service) else ""


def _check_parameter_subscription(topics: Topics, caller: str, uri: Any, _key: Any) -> str:  # noqa: ANN401
    return _check_registration(topics, caller, uri)


def _check_unregister(_topics: Topics, caller: str, *_: object) -> str:
    return _check_caller(caller)


def _check_lookup(topics: Topics, _caller: str, node: Any) -> str:  # noqa: ANN401
    if why := _check_name(node):
        return why
    private = (topic for topic in topics if is_private_name(topic.topic))
    is_guarded = any(matches_node(name, node) for topic in private for name in topic.subscribers)
    if is_guard_name(node) or is_guarded:
        return f"who knows the address of {node} can speak to it past the guard"
    return ""


def _check_shutdown(_topics: Topics, _caller: str, _reason: object) -> str:
    return "the master ends with its proxy, not before"


def _check_registration(_topics: Topics, caller: str, uri: object) -> str:
    if why := _check_caller(caller):
        return why
    try:
        split_uri(uri)
    except WireError:
        return f"{str(uri)[:80]!r} is no address of a node"
    return ""


def _check_caller(caller: str) -> str:
    if why := _check_name(caller):
        return why
    return f"{caller} is one of the guard's names" if is_guard_name(caller) else ""


def _check_name(name: object) -> str:
    return (
        "" if is_global_name(name) else f"{str(name)[:80]!r} is not a global name as ROS writes it"
    )


METHODS = {
    "registerPublisher": MasterMethod(
        parameter_count=4, error_value=[], uri_index=3, check=_check_publish
    ),
    "registerSubscriber": MasterMethod(
        parameter_count=4, error_value=[], uri_index=3, check=_check_subscribe
    ),
    "registerService": MasterMethod(
        parameter_count=4, error_value=0, uri_index=3, check=_check_service
    ),
    "subscribeParam": MasterMethod(
        parameter_count=3, error_value=0, uri_index=1, check=_check_parameter_subscription
    ),
    "unregisterPublisher": MasterMethod(parameter_count=3, error_value=0, check=_check_unregister),
    "unregisterSubscriber": MasterMethod(parameter_count=3, error_value=0, check=_check_unregister),
    "unregisterService": MasterMethod(parameter_count=3, error_value=0, check=_check_unregister),
    "unsubscribeParam": MasterMethod(parameter_count=3, error_value=0, check=_check_unregister),
    "lookupNode": MasterMethod(parameter_count=2, error_value="", check=_check_lookup),
    "shutdown": MasterMethod(parameter_count=2, error_value=0, check=_check_shutdown),
    "lookupService": MasterMethod(parameter_count=2, error_value=""),
    "getPublishedTopics": MasterMethod(parameter_count=2, error_value=0),
    "getTopicTypes": MasterMethod(parameter_count=1, error_value=[]),
    "getSystemState": MasterMethod(parameter_count=1, error_value=[[], [], []]),
    "getUri": MasterMethod(parameter_count=1, error_value=""),
    "getPid": MasterMethod(parameter_count=1, error_value=-1),
    "setParam": MasterMethod(parameter_count=3, error_value=0),
    "deleteParam": MasterMethod(parameter_count=2, error_value=0),
    "getParam": MasterMethod(parameter_count=2, error_value=0),
    "searchParam": MasterMethod(parameter_count=2, error_value=0),
    "hasParam": MasterMethod(parameter_count=2, error_value=False),
    "getParamNames": MasterMethod(parameter_count=1, error_value=[]),
}
"""The methods of rosmaster (rosmaster/master_api.py); any other is refused."""
