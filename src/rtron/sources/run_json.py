"""A measured run as JSON, schema `rtron.run/1`: read from a file, and written.

Keys are those of `rtron.vocabulary.Run`; durations are whole nanoseconds.
"""

import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, FailFast, Field, TypeAdapter, ValidationError, with_config

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded
from rtron.vocabulary import (
    RUN_SCHEMA,
    DurationFigures,
    EventFigures,
    MonitorFigures,
    Run,
    StreamFigures,
    ValueFigures,
)

MAX_BYTES = 16 * 1024 * 1024
MOST = 2**63 - 1
_LONGEST_TEXT = 1000
_SHOWN = 60
_HELP = "`rtron guard --dry-run --figures RUN.json` writes such files"
_RISING = ("p50", "p99", "p999", "max")


@with_config(ConfigDict(extra="forbid", strict=True, allow_inf_nan=False))
@dataclass(frozen=True, slots=True, kw_only=True)
class RunDocument:
    """The JSON document of a run, its keys as they are written."""

    schema: Literal["rtron.run/1"]
    app: str
    ros: Annotated[int, Field(ge=1, le=2)] = 1
    duration: int = 0
    streams: Annotated[tuple[StreamFigures, ...], FailFast()] = ()
    monitors: Annotated[tuple[MonitorFigures, ...], FailFast()] = ()
    events: Annotated[tuple[EventFigures, ...], FailFast()] = ()


_DOCUMENT = TypeAdapter(RunDocument)


def read_run(path: Path) -> Run:
    """Read a run; InputError where it is no run, or its figures contradict each other."""
    data = read_bounded(path, MAX_BYTES)
    try:
        document = _DOCUMENT.validate_json(data)
    except ValidationError as error:
        raise _fault(error, str(path)) from None
    fault = next(_faults(document, ""), None)
    if fault:
        raise InputError(fault, path=str(path), help=_HELP)
    return Run(**{field.name: getattr(document, field.name) for field in fields(Run)})


def run_to_json(run: Run) -> dict[str, Any]:
    """Return a run as a JSON document."""
    return {"schema": RUN_SCHEMA, **asdict(run)}


def _fault(error: ValidationError, path: str) -> InputError:
    """Return the first fault that pydantic found, as an InputError."""
    first = min(error.errors(include_url=False), key=lambda each: each["loc"] != ("schema",))
    if first["type"] == "json_invalid":
        reason = first["ctx"]["error"]
        line = re.search(r"line (\d+)", reason)
        at = int(line[1]) if line else 0
        return InputError(f"not JSON: {reason}", path=path, line=at, help=_HELP)
    place = "".join(f"[{each}]" if isinstance(each, int) else f".{each}" for each in first["loc"])
    told = first["msg"][:_SHOWN].replace("Unexpected keyword argument", "no key of a run")
    where = place[: 2 * _SHOWN].removeprefix(".") or "the document"
    return InputError(f"{where}: {told}", path=path, help=_HELP)


def _faults(noun: Any, place: str) -> Iterator[str]:  # noqa: ANN401 - whatever a run is made of
    """Yield what no run can say: numbers below 0 or without bound, quantiles that fall."""
    if isinstance(noun, tuple):
        for at, each in enumerate(noun):
            yield from _faults(each, f"{place}[{at}]")
    elif is_dataclass(noun):
        for field in fields(noun):
            yield from _faults(getattr(noun, field.name), f"{place}.{field.name}".strip("."))
        if isinstance(noun, (DurationFigures, ValueFigures)):
            yield from _falling(noun, place)
    elif isinstance(noun, str):
        if len(noun) > _LONGEST_TEXT:
            yield f"{place}: longer than {_LONGEST_TEXT} characters"
    elif not 0 <= noun <= MOST:
        yield f"{place}: not between 0 and {MOST}"


def _falling(figures: DurationFigures | ValueFigures, place: str) -> Iterator[str]:
    values = [getattr(figures, name) for name in _RISING]
    if isinstance(figures, ValueFigures):
        values.insert(0, figures.min)
    if values != sorted(values):
        yield f"{place}: quantiles that fall"
