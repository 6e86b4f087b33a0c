"""Functions that join nodes but that nothing seen calls: noted, so that no one can hide there."""

from collections.abc import Iterable

from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.ir import Function
from rtron.sources.code.words import called_words
from rtron.vocabulary import Evidence

JOINS = frozenset(
    [
        "advertise",
        "advertiseCamera",
        "advertiseService",
        "subscribe",
        "subscribeCamera",
        "Publisher",
        "Subscriber",
        "SimpleActionClient",
        "SimpleActionServer",
    ]
)


def note_unreached(machine: Machine, functions: Iterable[Function]) -> None:
    """Note each function that would declare something and never ran."""
    for function in functions:
        ran = (function.file, function.line, function.name) in machine.ran
        if function.body is not None and not ran and called_words(function) & JOINS:
            place = Evidence(file=function.file, line=function.line)
            why = "joins nodes, but nothing that is seen calls it"
            machine.recorder.unresolved(f"{function.name}()", why, place)
