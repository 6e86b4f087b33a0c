"""The launch file that starts an app guarded: ours around the app's own, which stays as it is.

It is Python that reads as a table and a hundred lines of `launch`'s public API; it needs no RTron
where it runs. What its own text says of launch and launch_ros holds from Humble on.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from pprint import pformat

from rtron.errors import InputError
from rtron.planning.instrument.common.remaps import private_names
from rtron.vocabulary import Stream

PrivateNames = Mapping[str, Mapping[str, str]]
"""Each node of a plan, a name or a pattern, with its private names by the public ones."""

_TEMPLATE = "wrapper.py.in"
_HEADER = "Starts the app guarded. Written by `rtron instrument`"
_PLACEHOLDER = re.compile(r"__(APP|GUARD|REMAPS|EXPECTED|PREFIX|CELLS|ENVIRONMENT)__")


def remap_table(enforced: tuple[Stream, ...]) -> PrivateNames:
    """Return the private names of every node that the plan has in an enforced stream."""
    flows = (flow.publisher for stream in enforced for flow in stream.flows)
    successors = (node for stream in enforced for node in stream.successors)
    return {name: private_names(name, enforced) for name in sorted({*flows, *successors})}


@dataclass(frozen=True, slots=True)
class WrappedStart:
    """What comes before the app; the paths of scripts are from the launch file's own folder.

    First the script `guard` starts, if any. Every process of the app starts through the script
    `prefix`, if any, with the variables of the `environment`, and the nodes of `cells` through that
    of their cell.
    """

    guard: str = ""
    prefix: str = ""
    environment: Mapping[str, str] = field(default_factory=dict)
    cells: Mapping[str, str] = field(default_factory=dict)


def wrapper_text(
    app: str,
    table: PrivateNames,
    start: WrappedStart = WrappedStart(),
    expected: Collection[str] | None = None,
) -> str:
    """Return the launch file that includes `app`.

    `expected` are the nodes that nothing else starts, None for all.
    """
    template = files("rtron.planning.instrument.ros2").joinpath(_TEMPLATE).read_text()
    names = {node: dict(private) for node, private in table.items()}
    expected_nodes = sorted(table if expected is None else expected)
    values = {
        "APP": app,
        "GUARD": start.guard,
        "REMAPS": names,
        "EXPECTED": expected_nodes,
        "PREFIX": start.prefix,
        "CELLS": dict(start.cells),
        "ENVIRONMENT": dict(start.environment),
    }
    return _PLACEHOLDER.sub(
        lambda hole: pformat(values[hole[1]], width=88, sort_dicts=False), template
    )


def is_wrapper(path: str) -> bool:
    """Tell whether a launch file is one of ours; raise InputError if it cannot be read."""
    try:
        with Path(path).open(errors="replace") as file:
            return path.endswith(".py") and _HEADER in file.read(len(_HEADER) + 10)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path=path) from None
