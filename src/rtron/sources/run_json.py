"""A measured run as JSON, schema `rtron.run/1`: read from a file, and written.

Keys are those of `rtron.vocabulary.Run`; durations are whole nanoseconds.
"""

import json
import os
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, FailFast, Field, TypeAdapter, ValidationError, with_config

from rtron.errors import InputError, plain_reason
from rtron.sources.bounded_file import read_bounded
from rtron.vocabulary import (
    RUN_SCHEMA,
    DurationStatistics,
    EventStatistics,
    MeasuredRun,
    MonitorStatistics,
    StreamStatistics,
    ValueStatistics,
)

MAX_BYTES = 16 * 1024 * 1024
MAX_NUMBER = 2**63 - 1
_MAX_TEXT_LENGTH = 1000
_MAX_SHOWN = 60
_HELP = "`rtron guard --dry-run --measurements RUN.json` writes such files"
_QUANTILES = ("p50", "p99", "p999", "max")


@with_config(ConfigDict(extra="forbid", strict=True, allow_inf_nan=False))
@dataclass(frozen=True, slots=True, kw_only=True)
class RunDocument:
    """The JSON document of a run, its keys as they are written."""

    schema: Literal["rtron.run/1"]
    app: str
    ros: Annotated[int, Field(ge=1, le=2)] = 1
    duration: int = 0
    streams: Annotated[tuple[StreamStatistics, ...], FailFast()] = ()
    monitors: Annotated[tuple[MonitorStatistics, ...], FailFast()] = ()
    events: Annotated[tuple[EventStatistics, ...], FailFast()] = ()


_DOCUMENT = TypeAdapter(RunDocument)


def read_run(path: Path) -> MeasuredRun:
    """Read a run; InputError where it is no run, or its figures contradict each other."""
    data = read_bounded(path, MAX_BYTES)
    try:
        document = _DOCUMENT.validate_json(data)
    except ValidationError as error:
        raise _validation_error(error, str(path)) from None
    problem = next(_problems(document, ""), None)
    if problem:
        raise InputError(problem, path=str(path), help=_HELP)
    return MeasuredRun(
        **{field.name: getattr(document, field.name) for field in fields(MeasuredRun)}
    )


def run_to_json(run: MeasuredRun) -> dict[str, Any]:
    """Return a run as a JSON document."""
    return {"schema": RUN_SCHEMA, **asdict(run)}


@dataclass(frozen=True, slots=True)
class RunFileWriter:
    """Writes each run to a file in place of the one before; the guard's own process calls it."""

    path: Path

    def __call__(self, run: MeasuredRun) -> None:
        """Write a run; InputError if that is not possible."""
        temporary = self.path.with_name(f".{self.path.name}.{os.getpid()}")
        try:
            temporary.unlink(missing_ok=True)
            with temporary.open("x", encoding="utf-8") as file:
                file.write(json.dumps(run_to_json(run), indent=2) + "\n")
            temporary.replace(self.path)
        except OSError as error:
            reason = error.strerror or "cannot be written"
            raise InputError(reason, path=str(self.path), help="choose another file") from None
        finally:
            with suppress(OSError):  # a leftover does no harm; keep the first error
                temporary.unlink(missing_ok=True)


def _validation_error(error: ValidationError, path: str) -> InputError:
    """Return the first fault that pydantic found, as an InputError."""
    first = min(error.errors(include_url=False), key=lambda each: each["loc"] != ("schema",))
    if first["type"] == "json_invalid":
        reason = first["ctx"]["error"]
        line = re.search(r"line (\d+)", reason)
        line_number = int(line[1]) if line else 0
        return InputError(f"not JSON: {reason}", path=path, line=line_number, help=_HELP)
    json_path = "".join(
        f"[{each}]" if isinstance(each, int) else f".{each}" for each in first["loc"]
    )
    reason = plain_reason(first["msg"])[:_MAX_SHOWN]
    message = reason.replace("Unexpected keyword argument", "no key of a run")
    shown_path = json_path[: 2 * _MAX_SHOWN].removeprefix(".") or "the document"
    return InputError(f"{shown_path}: {message}", path=path, help=_HELP)


def _problems(value: Any, json_path: str) -> Iterator[str]:  # noqa: ANN401 - whatever a run is made of
    """Yield what no run can say: numbers below 0 or without bound, quantiles that fall."""
    if isinstance(value, tuple):
        for index, each in enumerate(value):
            yield from _problems(each, f"{json_path}[{index}]")
    elif is_dataclass(value):
        for field in fields(value):
            yield from _problems(getattr(value, field.name), f"{json_path}.{field.name}".strip("."))
        if isinstance(value, (DurationStatistics, ValueStatistics)):
            yield from _unordered_quantiles(value, json_path)
    elif isinstance(value, str):
        if len(value) > _MAX_TEXT_LENGTH:
            yield f"{json_path}: longer than {_MAX_TEXT_LENGTH} characters"
    elif not 0 <= value <= MAX_NUMBER:
        yield f"{json_path}: not between 0 and {MAX_NUMBER}"


def _unordered_quantiles(
    figures: DurationStatistics | ValueStatistics, json_path: str
) -> Iterator[str]:
    values = [getattr(figures, name) for name in _QUANTILES]
    if isinstance(figures, ValueStatistics):
        values.insert(0, figures.min)
    if values != sorted(values):
        yield f"{json_path}: quantiles that fall"
