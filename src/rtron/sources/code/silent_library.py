"""What a program gets from clocks, numbers and the outside, as it runs in silence."""

import re
from collections import deque
from collections.abc import Callable, Iterable
from functools import reduce
from itertools import islice
from operator import or_
from typing import Any, TypeGuard

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir.references import ir_nodes, last_name

_MAX_PARTS, _MAX_ITEMS = 512, 64
CLOCKS = {
    **dict.fromkeys(("now", "time", "monotonic", "perf_counter", "get_time", "get_rostime"), 1),
    **dict.fromkeys(("default_timer", "utcnow", "clock", "steady_clock_now"), 1),
    **dict.fromkeys(("time_ns", "monotonic_ns", "perf_counter_ns", "getNanoseconds"), 1e9),
    **dict.fromkeys(("millis", "HAL_GetTick", "xTaskGetTickCount", "ticks_ms"), 1e3),
    **dict.fromkeys(("micros", "esp_timer_get_time", "time_us_64"), 1e6),
}
"""Functions that read a clock, and how many of what they return make a second."""
RUNNING = {"ok": True, "is_shutdown": False, "isShuttingDown": False}
"""What says that the node runs."""
UNITS = {
    **dict.fromkeys(("seconds", "to_sec", "toSec", "total_seconds", "count", "secs", "sec"), 1),
    **dict.fromkeys(("nanoseconds", "to_nsec", "toNSec", "nsecs", "nanosec", "nsec"), 1e9),
    **dict.fromkeys(("milliseconds",), 1e3),
    **dict.fromkeys(("microseconds",), 1e6),
}
"""Members of times and durations that are numbers, and units of those that a number is made to."""
TIMES = frozenset({"Duration", "Time", "timedelta", "from_seconds", "fromSec", "from_sec"})
LOGGING = re.compile(
    r"(?:log)?_?(?:debug|info|warn|warning|error|fatal|critical|err)(?:_\w+)?"
    r"|f?printf?|log|get_?[lL]ogger|(?:ROS|RCLCPP|RCUTILS)(?:_[A-Z0-9]+)+|perror|puts"
)
SLEEPS = frozenset(
    {"sleep", "usleep", "sleep_for", "sleep_until", "delay", "spin_some", "spinOnce"}
)
NUMERIC: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(("abs", "fabs", "fabsf"), abs),
    **dict.fromkeys(("float", "int", "round", "lround", "floor", "ceil", "long"), lambda x, *_: x),
    **dict.fromkeys(("static_cast", "duration_cast", "duration", "time_point_cast"), lambda x: x),
    **dict.fromkeys(("max", "fmax", "maximum"), max),
    **dict.fromkeys(("min", "fmin", "minimum"), min),
    **dict.fromkeys(("clip", "clamp", "constrain"), lambda x, low, high: max(low, min(x, high))),
}
_CASTS = re.compile(r"u?int(?:8|16|32|64)?(?:_t)?|float(?:32|64)?|double|long|short|u?char|byte")
COMPUTING = re.compile(
    r"(?:math|cmath|numpy|struct|copy|json|random|statistics|itertools|functools|re|datetime"
    r"|tf|tf_transformations|transforms3d|scipy|std|Eigen|angles|tf2|cv2|builtins)(?:[.]|::).*"
    r"|bytearray|bytes|hex|sorted|sum|map|zip|enumerate|reversed|any|all|chr|ord|format|print|pow"
    r"|a?(?:sin|cos|tan)h?2?f?|atan2|sqrtf?|hypot|exp|log10|fmod|isnan|isinf|isfinite"
)
"""Functions of libraries that make a value of what they get, and do nothing."""


def compute(name: str, arguments: Arguments, types: tuple[ir.TypeRef, ...]) -> av.Value | None:
    """Return the number, duration or time that a function makes of numbers; None for others."""
    if name in TIMES or (name in UNITS and arguments.all_values):
        return _duration(name, arguments)
    is_cast = bool(_CASTS.fullmatch(name)) and len(arguments.values) == 1
    if not arguments.values or not (is_cast or name in NUMERIC):
        return None
    values = [av.number_of(each) for each in arguments.values]
    flags = reduce(or_, map(av.taint, values))
    numbers = [each.value for each in values if isinstance(each, av.Scalar)]
    if len(numbers) < len(values):
        return av.Unknown(name, flags)
    try:
        made = av.Scalar(NUMERIC["static_cast" if is_cast else name](*numbers), flags)
    except (TypeError, ValueError):
        return av.Unknown(name, flags)
    unit = types[0].name.rpartition("::")[2] if types else ""
    return scaled(made, UNITS.get(unit, 1)) if name == "duration_cast" else made


def scaled(value: av.Value, factor: float) -> av.Value | None:
    """Return a time in another unit; None for what is no number, and no time."""
    if isinstance(value, av.Scalar) and isinstance(value.value, (int, float)):
        return av.Scalar(value.value * factor, value.tainted)
    return value if av.taint(value) & av.CLOCK else None


def _duration(name: str, arguments: Arguments) -> av.Value:
    """Return the seconds that numbers of units are."""
    parts = list(zip((UNITS.get(name, 1), 1e9), arguments.values, strict=False))
    parts += [(UNITS.get(key, 1), each) for key, each in arguments.keywords.items()]
    total: av.Value = av.Scalar(0.0)
    for unit, each in parts:
        total = av.binary("+", total, av.binary("/", av.number_of(each), av.Scalar(float(unit))))
    return total


def message_taint(values: Iterable[av.Value]) -> int:
    """Return MESSAGE if anything in values is of the message."""
    return reduce(or_, map(av.taint, leaves(values)), 0) & av.MESSAGE


def leaves(values: Iterable[av.Value]) -> tuple[av.Value, ...]:
    """Return what values are made of, as far as they can be taken apart in so many steps."""
    found: list[av.Value] = []
    waiting = deque(values)
    for _ in range(_MAX_PARTS):
        if not waiting:
            break
        value = waiting.popleft()
        inner = _parts(value)
        waiting.extendleft(reversed(inner))
        if not inner:
            is_unset = isinstance(value, av.Instance) and is_message_object(value)
            found.append(av.Scalar(0.0) if is_unset else value)
    return tuple(found)


def _parts(value: av.Value) -> list[av.Value]:
    inner: Iterable[av.Value] = ()
    if isinstance(value, av.Choice):
        inner = value.options
    elif isinstance(value, av.ListValue):
        inner = value.items
    elif isinstance(value, av.MapValue) or _is_record(value):
        inner = value.fields.values()
    return list(islice(inner, _MAX_ITEMS))


def is_message_object(owner: av.Instance) -> bool:
    """Return whether an object is a message, or a part of one."""
    is_library = isinstance(owner.type, av.LibraryClass)
    return owner.type is av.UNSET or (is_library and "/" in owner.type.name)


def _is_record(value: av.Value) -> TypeGuard[av.Instance]:
    """Return whether a value is a message or the like, and no object that does something."""
    return isinstance(value, av.Instance) and isinstance(value.type, av.LibraryClass)


def topic_of(owner: av.Value | None) -> str:
    """Return the topic of a publisher, `?` where it is not known."""
    fields = owner.fields if isinstance(owner, av.Instance) else {}
    name = fields.get("name") or fields.get("topic_name")
    return av.text_with_holes(name) if name is not None else "?"


def is_endless(node: ir.While) -> bool:
    """Return whether a loop runs until the node ends."""
    exits = (ir.Break, ir.Return, ir.Raise)
    has_exit = any(isinstance(each, exits) for each in ir_nodes(node.body))
    names = {last_name(each.function) for each in ir_nodes(node.test) if isinstance(each, ir.Call)}
    return bool(names & {"ok", "is_shutdown"}) or (isinstance(node.test, ir.Const) and not has_exit)
