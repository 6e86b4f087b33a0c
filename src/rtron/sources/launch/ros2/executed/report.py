"""What a visit wrote: its process ran strange code, so it is checked as a stranger's file."""

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from rtron.errors import InputError, SourceError, plain_reason
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.ros2.limits import MAX_FILES, MAX_NAMES, MAX_NODES
from rtron.sources.launch.ros2.substitutions.substitution import MAX_COMMAND_OUTPUT, MAX_GRAPH_TEXT

MAX_BYTES = 16 * 2**20
MAX_WORDS = 10_000
MAX_PARAMETERS = 100_000

Text: TypeAlias = Annotated[str, Field(max_length=MAX_GRAPH_TEXT)]
LongText: TypeAlias = Annotated[str, Field(max_length=MAX_COMMAND_OUTPUT)]
Words: TypeAlias = Annotated[tuple[LongText, ...], Field(max_length=MAX_WORDS)]
Scalar: TypeAlias = bool | int | float | LongText
Value: TypeAlias = Scalar | Annotated[list[Scalar], Field(max_length=MAX_PARAMETERS)]
ReportedParameters: TypeAlias = Annotated[
    tuple[tuple[Text, Value], ...], Field(max_length=MAX_PARAMETERS)
]


class _StrictModel(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class ReportedLocation(_StrictModel):
    """Where something stands; the line is 0 where it is not known."""

    file: Text
    line: int = Field(ge=0, lt=2**31)


class _ReportedStart(_StrictModel):
    """What processes and components have."""

    package: Text = ""
    program: Text = ""
    event: Text
    place: ReportedLocation


class ReportedProcess(_ReportedStart):
    """A process or node: the words of its own command line, and those that launch adds."""

    kind: Literal["process", "node", "lifecycle_node", "container"]
    words: Words
    added: Words = ()
    shell: bool = False
    environ: Annotated[dict[Text, Text], Field(max_length=MAX_NAMES)]


class ReportedComponent(_ReportedStart):
    """A component, and the container that is asked to load it."""

    kind: Literal["component"]
    container: Text
    name: Text
    namespace: Text
    remaps: Words
    parameters: ReportedParameters
    extra: ReportedParameters


class ReportedArgument(_StrictModel):
    """An argument that the file declares."""

    name: Text
    default: LongText | None
    description: Text
    place: ReportedLocation


class ReportedInclude(_StrictModel):
    """A file that is included, with the arguments it is given."""

    file: Text
    arguments: Annotated[tuple[tuple[Text, LongText], ...], Field(max_length=MAX_NAMES)]
    place: ReportedLocation


class ReportedError(_StrictModel):
    """The exception that ended a launch."""

    text: Text
    place: ReportedLocation


class ReportedNote(_StrictModel):
    """What the visit could not see."""

    why: Text
    place: ReportedLocation


class VisitReport(_StrictModel):
    """What a visit found; `missing` says why launch cannot be imported."""

    schema_: Literal["rtron.visit/1"] = Field(alias="schema")
    starts: Annotated[
        tuple[Annotated[ReportedProcess | ReportedComponent, Field(discriminator="kind")], ...],
        Field(max_length=MAX_NODES),
    ]
    arguments: Annotated[tuple[ReportedArgument, ...], Field(max_length=MAX_NAMES)]
    includes: Annotated[tuple[ReportedInclude, ...], Field(max_length=MAX_FILES)]
    notes: Annotated[tuple[ReportedNote, ...], Field(max_length=MAX_NAMES)]
    commands: Annotated[tuple[Text, ...], Field(max_length=MAX_NAMES)]
    error: ReportedError | None
    missing: Text


def read_report(path: Path) -> VisitReport:
    """Return what a visit wrote; raise SourceError where that is not what a visit writes."""
    if path.is_symlink() or not path.is_file():
        raise SourceError("the visit of the launch file wrote nothing")
    try:
        return VisitReport.model_validate_json(read_bounded(path, MAX_BYTES))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        json_path = ".".join(map(str, first["loc"][:6]))
        raise SourceError(
            f"the visit of the launch file wrote: {json_path}: {plain_reason(first['msg'])}"
        ) from None
    except InputError as error:
        raise SourceError(f"the visit of the launch file wrote a file {error.reason}") from None
