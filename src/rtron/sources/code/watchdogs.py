"""Signs that a program notices when no more messages come: watchdogs, and waits with a limit."""

import re
from collections.abc import Iterable

from rtron.sources.code import ir
from rtron.sources.code.function_steps import (
    ADDING,
    SELF,
    FunctionSteps,
    assignments,
    given,
    is_called_stop,
    is_constant,
    is_zero,
    last_name,
    mentioned_names,
)
from rtron.sources.code.ir.references import ir_nodes

CLOCKS = frozenset(
    [
        *("now", "time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "get_time"),
        *("get_rostime", "utcnow", "millis", "micros", "clock_gettime", "gettimeofday", "stamp"),
        *("default_timer", "perf_counter_ns", "HAL_GetTick", "xTaskGetTickCount", "ticks_ms"),
        *("esp_timer_get_time", "get_absolute_time", "time_us_64", "rmw_uros_epoch_millis"),
    ]
)
"""Names of functions and members that tell the time."""
_TIMERS = re.compile(r"timer|watch_?dog", re.IGNORECASE)
_RESTARTS = frozenset({"reset", "start", "restart", "cancel", "stop", "feed", "kick", "setPeriod"})
_TIMER_MAKERS = frozenset({"Timer", "createTimer", "create_timer", "create_wall_timer"})
_ALARMS = frozenset(
    {"call_later", "call_at", "expires_after", "expires_from_now", "setitimer", "alarm"}
)
"""What a callback starts anew, and what comes where no more does."""
_TIMED_WAITS = frozenset({"wait_for", "wait_until", "get_nowait"})
_SILENCE = frozenset(
    [
        *("deadline_callback", "SubscriptionEventCallbacks", "count_publishers"),
        *("get_publisher_count", "get_publishers_info_by_topic", "getNumPublishers"),
    ]
)
"""What tells a subscription that no message came, or that nobody sends any."""
_KEEPING = ADDING | {"update", "set", "setattr", "setdefault", "store"}
_SLEEPS = frozenset({"sleep", "usleep", "msleep", "nanosleep", "sleep_for", "delay"})
_ZERO_TEXT = re.compile(r"[^1-9]*0[^1-9]*")


def may_be_watched(reached: list[FunctionSteps], others: list[FunctionSteps]) -> bool:
    """Return whether a program may learn that messages ended, or moves only so long for each.

    A callback restarts a timer, keeps the time, or sends a stop by itself; or others ask who sends.
    """
    has_question = any(not _SILENCE.isdisjoint(mentioned_names(o.function.body)) for o in others)
    members = [pair for each in others for pair in each.members]
    timers = {name for name, value in members if mentioned_names(value) & _TIMER_MAKERS}
    restarts = any(_starts_timer(c.function, timers) for each in reached for c in each.calls)
    signs = (_keeps_time, _stops_after_waiting)
    return has_question or restarts or any(sign(each) for each in reached for sign in signs)


def _stops_after_waiting(code: FunctionSteps) -> bool:
    """Return whether a function waits, and sends something like a stop thereafter."""
    waits = [call.line for call in code.calls if last_name(call.function) in _SLEEPS]
    return bool(waits) and any(
        is_called_stop(call) or any(map(is_zero, given(call))) or any(map(_may_be_zero, call.args))
        for call in code.calls
        if call.line >= min(waits) and last_name(call.function) not in _SLEEPS
    )


def _may_be_zero(value: ir.Expr) -> bool:
    """Return whether what is sent may mean a stop: a text of zeros, or what is called low."""
    if isinstance(value, ir.Const) and isinstance(value.value, (str, bytes)):
        text = value.value if isinstance(value.value, str) else value.value.decode("latin-1")
        return bool(_ZERO_TEXT.fullmatch(text))
    return last_name(value) in {"LOW", "False"} or value == ir.Const(value=False)


def clock_functions(functions: Iterable[ir.Function]) -> frozenset[str]:
    """Return the names of functions that return the time, as it is or in another unit."""
    returned = [
        (function.name.rpartition("::")[2], node.value)
        for function in functions
        for node in ir_nodes(function.body)
        if isinstance(node, ir.Return) and node.value is not None
    ]
    others = {name for name, value in returned if not _is_clock_reading(value)}
    return frozenset(name for name, _ in returned) - others


def _is_clock_reading(value: ir.Expr) -> bool:
    """Return whether a value is a clock's, changed by numbers alone."""
    sides = [(n.left, n.right) for n in ir_nodes(value) if isinstance(n, ir.Binary)]
    is_plain = all(any(map(is_constant, each)) for each in sides)
    return is_plain and bool(mentioned_names(value) & CLOCKS - {"stamp"})


def has_timed_wait(reached: list[FunctionSteps], others: list[FunctionSteps]) -> bool:
    """Return whether somebody waits for the message for so long."""
    shared = set[str]().union(*(mentioned_names(each.function.body) for each in reached)) - SELF
    return any(
        (last_name(call.function) in _TIMED_WAITS or _is_wait(call))
        and mentioned_names(call) - {last_name(call.function)} & shared
        for each in others
        for call in each.calls
    )


def _is_wait(call: ir.Call) -> bool:
    name = last_name(call.function)
    is_timed = any(key == "timeout" for key, _ in call.keywords)
    is_timed |= len(call.args) > 1 and call.args[0] == ir.Const(value=True)
    return (name in {"get", "wait"} and is_timed) or (name == "wait" and bool(call.args))


def _keeps_time(code: FunctionSteps) -> bool:
    """Return whether a function puts the time where no test of a member would find it.

    In an item, something else's member, a global or beside other values, but in no header.
    """
    for node in ir_nodes(code.function.body):
        for target, value in assignments(node):
            if is_time(value, code) and _is_hidden(target, value, code):
                return True
        is_keeping = isinstance(node, ir.Call) and last_name(node.function) in _KEEPING
        given = (*node.args, *(v for _, v in node.keywords)) if is_keeping else ()
        if any(is_time(each, code) for each in given):
            return True
    return False


def _is_hidden(target: ir.Expr, value: ir.Expr, code: FunctionSteps) -> bool:
    if "stamp" in mentioned_names(target):
        return False
    is_item = isinstance(target, ir.Index) and last_name(target) not in code.declared
    is_others = isinstance(target, ir.Attr) and not isinstance(target.owner, ir.Name)
    is_beside = isinstance(value, ir.SequenceExpr) and bool(code.member(target))
    return is_item or is_others or is_beside or last_name(target) in code.globals


def is_time(value: ir.Expr, code: FunctionSteps) -> bool:
    """Return whether a value is now, or a message's stamp; a local may hold it."""
    names, clocks = mentioned_names(value), CLOCKS | code.clocks
    return bool(names & clocks) or any(
        name in names and mentioned_names(given) & clocks for name, given in code.locals
    )


def _starts_timer(function: ir.Expr, timers: set[str]) -> bool:
    """Return whether a timer starts anew, which stops something where no more comes."""
    if isinstance(function, ir.Attr) and function.name in _RESTARTS:
        names = mentioned_names(function.owner)
        return bool(names & timers) or any(map(_TIMERS.search, names))
    return last_name(function) in _TIMER_MAKERS | _ALARMS
