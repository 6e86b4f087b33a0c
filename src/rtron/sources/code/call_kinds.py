"""What a call is for, by its name: it only logs, reads or prepares something, or stops a motion."""

import re
from itertools import chain

from rtron.sources.code import ir
from rtron.sources.code.interpreter.execution.exceptions import is_logging_call
from rtron.sources.code.ir.references import callee_names, ir_nodes

_LOGGING = re.compile(
    r"(?:log)?_?(?:debug|info|warn|warning|error|fatal|critical)(?:_\w+)?|[gG]et_?[lL]ogger"
)
_LOGGERS = re.compile(r"rospy|_?log(?:ger|ging)?|[gG]et_?[lL]ogger")
_READING = re.compile(
    r"(?:get|read|recv|receive|is|has|in|wait|flush|connect|join|init|begin|setup|available"
    r"|close|reset_(?:in|out)put|tc|cf|fcntl|select|poll)(?:_\w+|[A-Z]\w*|(?:set|get)\w+|flush)?"
)
_STOPPING = re.compile(r"stop|halt|brake|idle|off(?:$|_)|zero|neutral|disable|release|shut_?down")
_SETTING_UP = re.compile(
    r"_*(?:set)?_?(?:mode|freq\w*|frequency|baud\w*|timeout|warnings|address|parity|limits?"
    r"|pulse_width_range|update_rate|rate|range|direction|log_?level|callback\w*|subscribe"
    r"|register\w*|add_\w+|on_\w+|enable\w*|start|open|run_forever|loop\w*|attach\w*|load\w*"
    r"|configure\w*|create\w*|reset\w*|clear\w*|make\w*|cleanup)"
)


def only_logs(call: ir.Call) -> bool:
    """Return whether a call does nothing but write to a log, or to the terminal."""
    name = next(callee_names(call.function), "")
    if isinstance(call.function, ir.Attr) and _LOGGING.fullmatch(name):
        owner = chain.from_iterable(map(callee_names, ir_nodes(call.function.owner)))
        return name.lower().startswith("get") or any(map(_LOGGERS.fullmatch, owner))
    return is_logging_call(call) or (name == "print" and not call.keywords)


def only_reads(name: str) -> bool:
    """Return whether what is called so only asks an object, or prepares or closes it."""
    return bool(_READING.fullmatch(name))


def only_prepares(name: str) -> bool:
    """Return whether what is called so only prepares hardware."""
    return bool(_SETTING_UP.fullmatch(name))


def stops_motion(name: str) -> bool:
    """Return whether the name of what is called has a word of what ends a motion."""
    return bool(_STOPPING.search(name))
