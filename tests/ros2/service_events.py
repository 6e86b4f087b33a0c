"""What service introspection publishes of an action of ROS 2, written by rosbags."""

from functools import cache

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

GOAL = "string tool\nfloat64 depth\nbool[] cells\nfloat64[2] at\nstd_msgs/Header[] marks"
"""The goal of my_msgs/action/Dig: with what has to be aligned behind what need not be."""
ACTION = f"{GOAL}\n---\nbool done\n---\nint8 percent\n"
SENT, RECEIVED, ANSWERED, HEARD = range(4)
"""The kinds of an event (service_msgs/ServiceEventInfo)."""
_INFO = "service_msgs/ServiceEventInfo info"
_TYPES = {
    "Dig_Goal": GOAL,
    "Send_Request": "unique_identifier_msgs/UUID goal_id\nmy_msgs/Dig_Goal goal",
    "Send_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
    "Send_Event": (
        f"{_INFO}\nmy_msgs/Send_Request[<=1] request\nmy_msgs/Send_Response[<=1] response"
    ),
    "Cancel_Request": "action_msgs/GoalInfo goal_info",
    "Cancel_Response": "int8 return_code\naction_msgs/GoalInfo[] goals_canceling",
    "Cancel_Event": (
        f"{_INFO}\nmy_msgs/Cancel_Request[<=1] request\nmy_msgs/Cancel_Response[<=1] response"
    ),
}


@cache
def _store():
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, text in _TYPES.items():
        store.register(get_types_from_msg(text, f"my_msgs/msg/{name}"))
    return store


def _of(name, **fields):
    return _store().types[f"my_msgs/msg/{name}" if "/" not in name else name](**fields)


def _written(name, message):
    return bytes(_store().serialize_cdr(message, f"my_msgs/msg/{name}"))


def _time(seconds=0):
    return _of("builtin_interfaces/msg/Time", sec=seconds, nanosec=0)


def _id(id):
    import numpy as np  # noqa: PLC0415 - comes with rosbags

    return _of("unique_identifier_msgs/msg/UUID", uuid=np.array([id] * 16, dtype=np.uint8))


def _info(kind, asker, number):
    import numpy as np  # noqa: PLC0415 - comes with rosbags

    return _of(
        "service_msgs/msg/ServiceEventInfo",
        event_type=kind,
        stamp=_time(7),
        client_gid=np.array([asker] * 16, dtype=np.uint8),
        sequence_number=number,
    )


def _goal(depth, tool="spade", cells=3):
    import numpy as np  # noqa: PLC0415 - comes with rosbags

    header = _of("std_msgs/msg/Header", stamp=_time(3), frame_id="map")
    return _of(
        "Dig_Goal",
        tool=tool,
        depth=depth,
        cells=np.array([True] * cells),
        at=np.array([1.0, 2.0]),
        marks=[header] * (cells % 3),
    )


def goal(depth=0.5, **more):
    """Return a goal as a message of its own."""
    return _written("Dig_Goal", _goal(depth, **more))


def goal_request_event(id, depth=0.5, *, kind=RECEIVED, asker=1, number=0, contents=True, **more):
    """Return the event of a goal that is sent; by default its number is its id."""
    request = _of("Send_Request", goal_id=_id(id), goal=_goal(depth, **more))
    requests = [request] if contents else []
    info = _info(kind, asker, number or id)
    return _written("Send_Event", _of("Send_Event", info=info, request=requests, response=[]))


def goal_response_event(number, *, accepted=True, stamp=5, kind=ANSWERED, asker=1):
    """Return the event of the server's answer to a goal."""
    answer = _of("Send_Response", accepted=accepted, stamp=_time(stamp))
    info = _info(kind, asker, number)
    return _written("Send_Event", _of("Send_Event", info=info, request=[], response=[answer]))


def cancel_request_event(id, *, stamp=0, kind=RECEIVED, asker=1, number=1000):
    """Return the event of a cancel."""
    meant = _of("action_msgs/msg/GoalInfo", goal_id=_id(id), stamp=_time(stamp))
    request = _of("Cancel_Request", goal_info=meant)
    info = _info(kind, asker, number)
    return _written("Cancel_Event", _of("Cancel_Event", info=info, request=[request], response=[]))
