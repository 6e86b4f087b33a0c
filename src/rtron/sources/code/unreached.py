"""Functions that join nodes but that nothing seen calls: noted, so that no one can hide there."""

from collections import defaultdict
from collections.abc import Iterable

from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir import Function
from rtron.sources.code.ir.references import called_names
from rtron.vocabulary import Evidence

ENDPOINT_CALLS = frozenset(
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
        "create_publisher",
        "create_subscription",
        "create_service",
        "create_client",
        "create_server",
        "create_generic_publisher",
        "create_generic_subscription",
    ]
)


def note_unreached(machine: AbstractMachine, functions: Iterable[tuple[str, Function]]) -> None:
    """Note the functions that would declare something and never ran, one note a file."""
    unreached: dict[str, list[tuple[str, Function]]] = defaultdict(list)
    for name, function in functions:
        ran = (function.file, function.line, function.name) in machine.executed_functions
        if function.body is not None and not ran and called_names(function) & ENDPOINT_CALLS:
            unreached[function.file].append((name, function))
    for file, found in unreached.items():
        more = f" and {len(found) - 1} more" if len(found) > 1 else ""
        name, first = found[0]
        location = Evidence(file=file, line=first.line)
        why = "joins nodes, but nothing that is seen calls it"
        machine.recorder.add_unresolved(f"{name}(){more}", why, location)
