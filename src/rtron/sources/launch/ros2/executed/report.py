"""What a visit wrote: its process ran strange code, so it is checked as a stranger's file."""

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from rtron.errors import InputError, SourceError
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.ros2.limits import MAX_FILES, MAX_NAMES, MAX_NODES
from rtron.sources.launch.ros2.substitutions.substitution import MAX_LONG, MAX_PRINTED

MAX_BYTES = 16 * 2**20
MAX_WORDS = 10_000
MAX_PARAMETERS = 100_000

Text: TypeAlias = Annotated[str, Field(max_length=MAX_LONG)]
Long: TypeAlias = Annotated[str, Field(max_length=MAX_PRINTED)]
Words: TypeAlias = Annotated[tuple[Long, ...], Field(max_length=MAX_WORDS)]
Scalar: TypeAlias = bool | int | float | Long
Value: TypeAlias = Scalar | Annotated[list[Scalar], Field(max_length=MAX_PARAMETERS)]
Given: TypeAlias = Annotated[tuple[tuple[Text, Value], ...], Field(max_length=MAX_PARAMETERS)]


class _Strict(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class Place(_Strict):
    """Where something stands; the line is 0 where it is not known."""

    file: Text
    line: int = Field(ge=0, lt=2**31)


class _Start(_Strict):
    """What processes and components have; `shared` of the remaps are for all nodes."""

    package: Text = ""
    program: Text = ""
    shared: int = Field(ge=0, le=MAX_WORDS)
    event: Text
    place: Place


class Process(_Start):
    """A process or node: the words of its own command line, and those that launch adds."""

    kind: Literal["process", "node", "lifecycle_node", "container"]
    words: Words
    added: Words = ()
    shell: bool = False
    environ: Annotated[dict[Text, Text], Field(max_length=MAX_NAMES)]


class Component(_Start):
    """A component, and the container that is asked to load it."""

    kind: Literal["component"]
    container: Text
    name: Text
    namespace: Text
    remaps: Words
    parameters: Given
    extra: Given


class Declared(_Strict):
    """An argument that the file declares."""

    name: Text
    default: Long | None
    description: Text
    place: Place


class Inclusion(_Strict):
    """A file that is included, with the arguments it is given."""

    file: Text
    arguments: Annotated[tuple[tuple[Text, Long], ...], Field(max_length=MAX_NAMES)]
    place: Place


class Fault(_Strict):
    """The exception that ended a launch."""

    text: Text
    place: Place


class Note(_Strict):
    """What the visit could not see."""

    why: Text
    place: Place


class Report(_Strict):
    """What a visit found; `missing` says why launch cannot be imported."""

    schema_: Literal["rtron.visit/1"] = Field(alias="schema")
    starts: Annotated[
        tuple[Annotated[Process | Component, Field(discriminator="kind")], ...],
        Field(max_length=MAX_NODES),
    ]
    arguments: Annotated[tuple[Declared, ...], Field(max_length=MAX_NAMES)]
    includes: Annotated[tuple[Inclusion, ...], Field(max_length=MAX_FILES)]
    notes: Annotated[tuple[Note, ...], Field(max_length=MAX_NAMES)]
    commands: Annotated[tuple[Text, ...], Field(max_length=MAX_NAMES)]
    error: Fault | None
    missing: Text


def read_report(path: Path) -> Report:
    """Return what a visit wrote; raise SourceError where that is not what a visit writes."""
    if path.is_symlink() or not path.is_file():
        raise SourceError("the visit of the launch file wrote nothing")
    try:
        return Report.model_validate_json(read_bounded(path, MAX_BYTES))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"][:6]))
        raise SourceError(f"the visit of the launch file wrote: {place}: {first['msg']}") from None
    except InputError as error:
        raise SourceError(f"the visit of the launch file wrote a file {error.why}") from None
