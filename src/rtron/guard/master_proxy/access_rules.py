"""What the plan forbids on the Master and Parameter Server APIs; pure decisions.

ROS wiki: Master_API, Parameter Server API. What the plan does not name is left alone; where it
names a topic or a node, only what it lets happen does.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rtron.errors import WireError
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT, SUPERVISOR_NODE, PlannedTopic
from rtron.vocabulary.names import names_node
from rtron.wire.ros1.xmlrpc import split_uri

ROSOUT = "/rosout"
MULTICALL = "system.multicall"
_LONGEST_NAME = 1000

Topics = Sequence[PlannedTopic]
Rule = Callable[..., str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Api:
    """One method: how many parameters it takes, and its value beside an error.

    `caller_api` is the place of the parameter that gives the caller's own address, 0 without one.
    """

    takes: int
    nothing: Any
    caller_api: int = 0
    rule: Rule = lambda topics, *params: ""


def forbidden(topics: Topics, method: str, params: Sequence[Any]) -> str:
    """Return why a plan with these `planned_topics` forbids a call, or nothing if it does not.

    Nothing that the caller says is believed to be well-formed; what cannot be judged is forbidden.
    """
    api = APIS.get(method)
    if api is None:
        return f"there is no method {method[:_LONGEST_NAME]!r} for callers of the fence"
    if len(params) != api.takes:
        return f"{method} takes {api.takes} parameters"
    if not isinstance(params[0], str):
        return "a caller_id is a string"
    return api.rule(topics, *params)


def is_guards(node: str) -> bool:
    """Tell whether a node name is one that only the guard goes by."""
    return node in (GUARD_NODE, SUPERVISOR_NODE) or is_private(node)


def is_private(name: str) -> bool:
    """Tell whether a name lies where all names are the guard's to give."""
    return name == PRIVATE_ROOT or name.startswith(PRIVATE_ROOT + "/")


def is_clean(name: object) -> bool:
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


def _publish(topics: Topics, caller: str, topic: Any, _type: Any, uri: Any) -> str:  # noqa: ANN401
    if why := _register(topics, caller, uri) or _unclean(topic):
        return why
    planned = [each for each in topics if each.topic == topic]
    if not planned:
        return f"{topic} is the guard's to publish" if is_private(topic) else ""
    may = any(each.may_publish(caller) for each in planned)
    return "" if may else f"the plan does not let {caller} publish {topic}"


def _subscribe(topics: Topics, caller: str, topic: Any, _type: Any, uri: Any) -> str:  # noqa: ANN401
    if why := _register(topics, caller, uri) or _unclean(topic):
        return why
    if topics and topic == ROSOUT and caller != ROSOUT:
        return f"all publish {ROSOUT}, and who hears it knows their addresses; use {ROSOUT}_agg"
    planned = [each for each in topics if each.topic == topic]
    may = not planned or any(each.may_subscribe(caller) for each in planned)
    return "" if may else f"the plan does not let {caller} subscribe {topic}"


def _serve(topics: Topics, caller: str, service: Any, _api: Any, uri: Any) -> str:  # noqa: ANN401
    if why := _register(topics, caller, uri) or _unclean(service):
        return why
    return f"{service} is the guard's to serve" if is_private(service) else ""


def _use_param(topics: Topics, caller: str, uri: Any, _key: Any) -> str:  # noqa: ANN401
    return _register(topics, caller, uri)


def _leave(_topics: Topics, caller: str, *_: object) -> str:
    return _stranger(caller)


def _look_up(topics: Topics, _caller: str, node: Any) -> str:  # noqa: ANN401
    if why := _unclean(node):
        return why
    private = (topic for topic in topics if is_private(topic.topic))
    hears = any(names_node(name, node) for topic in private for name in topic.subscribers)
    if is_guards(node) or hears:
        return f"who knows the address of {node} can speak to it past the guard"
    return ""


def _end(_topics: Topics, _caller: str, _reason: object) -> str:
    return "the master ends with the fence, not before"


def _register(_topics: Topics, caller: str, uri: object) -> str:
    if why := _stranger(caller):
        return why
    try:
        split_uri(uri)
    except WireError:
        return f"{str(uri)[:80]!r} is no address of a node"
    return ""


def _stranger(caller: str) -> str:
    if why := _unclean(caller):
        return why
    return f"{caller} is one of the guard's names" if is_guards(caller) else ""


def _unclean(name: object) -> str:
    return "" if is_clean(name) else f"{str(name)[:80]!r} is not a global name as ROS writes it"


APIS = {
    "registerPublisher": Api(takes=4, nothing=[], caller_api=3, rule=_publish),
    "registerSubscriber": Api(takes=4, nothing=[], caller_api=3, rule=_subscribe),
    "registerService": Api(takes=4, nothing=0, caller_api=3, rule=_serve),
    "subscribeParam": Api(takes=3, nothing=0, caller_api=1, rule=_use_param),
    "unregisterPublisher": Api(takes=3, nothing=0, rule=_leave),
    "unregisterSubscriber": Api(takes=3, nothing=0, rule=_leave),
    "unregisterService": Api(takes=3, nothing=0, rule=_leave),
    "unsubscribeParam": Api(takes=3, nothing=0, rule=_leave),
    "lookupNode": Api(takes=2, nothing="", rule=_look_up),
    "shutdown": Api(takes=2, nothing=0, rule=_end),
    "lookupService": Api(takes=2, nothing=""),
    "getPublishedTopics": Api(takes=2, nothing=0),
    "getTopicTypes": Api(takes=1, nothing=[]),
    "getSystemState": Api(takes=1, nothing=[[], [], []]),
    "getUri": Api(takes=1, nothing=""),
    "getPid": Api(takes=1, nothing=-1),
    "setParam": Api(takes=3, nothing=0),
    "deleteParam": Api(takes=2, nothing=0),
    "getParam": Api(takes=2, nothing=0),
    "searchParam": Api(takes=2, nothing=0),
    "hasParam": Api(takes=2, nothing=False),
    "getParamNames": Api(takes=1, nothing=[]),
}
"""The methods of rosmaster (rosmaster/master_api.py); any other is refused."""
