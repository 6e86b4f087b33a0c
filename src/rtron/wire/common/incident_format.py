"""What an incident's file says of itself: MCAP metadata, written by the guard, read by `rtron`.

Each part is JSON under the key `json`; the first has its main values as texts, too, which other
programs show. What is read is checked whole, since files come from anywhere: WireError.
"""

from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rtron.errors import WireError
from rtron.vocabulary import SECOND, IncidentHeader, Plan, Settings

INCIDENT, PLAN, SETTINGS = "rtron.incident", "rtron.plan", "rtron.settings"
FORMER_SETTINGS = "rtron.former_settings"
"""The names of the metadata."""
DECISIONS = "/rtron/decisions"
"""The channel of all that is no message of the app."""


LONGEST = 3600 * SECOND
"""More than any guard keeps, ns."""
_HEADER: TypeAdapter[IncidentHeader] = TypeAdapter(IncidentHeader)
_PLAN: TypeAdapter[Plan] = TypeAdapter(Plan)
_SETTINGS: TypeAdapter[Settings] = TypeAdapter(Settings)


def encode_settings(settings: Settings) -> str:
    """Write settings as JSON."""
    return _SETTINGS.dump_json(settings).decode()


def encode_metadata(
    header: IncidentHeader, plan: Plan, settings: str, former_settings: str = ""
) -> dict[str, dict[str, str]]:
    """Return the metadata of a file, by name; settings are JSON, `former_settings` if known."""
    cause = header.gravest
    shown = {
        "cause": f"{cause.kind}: {cause.topic} {cause.reason}",
        "app": header.app,
        "revision": str(header.revision),
        "rtron": header.rtron,
        "distribution": header.distribution,
    }
    former = {FORMER_SETTINGS: {"json": former_settings}} if former_settings else {}
    return {
        INCIDENT: {**shown, "json": _HEADER.dump_json(header).decode()},
        PLAN: {"json": _PLAN.dump_json(plan).decode()},
        SETTINGS: {"json": settings},
        **former,
    }


def decode_header(metadata: Mapping[str, Mapping[str, str]]) -> IncidentHeader:
    """Return what an incident is about; WireError if the file is none."""
    header: IncidentHeader = _decode(_HEADER, metadata, INCIDENT)
    if not header.causes:
        raise WireError("it names no cause")
    if not 0 <= header.begin <= header.causes[0].at < 1 << 63 or not (
        header.begin <= header.end <= header.begin + LONGEST
    ):
        raise WireError("its times are no guard's")
    return header


def decode_plan(metadata: Mapping[str, Mapping[str, str]]) -> tuple[Plan, Settings]:
    """Return the plan and the settings that were in force."""
    return _decode(_PLAN, metadata, PLAN), _decode(_SETTINGS, metadata, SETTINGS)


def decode_former_settings(metadata: Mapping[str, Mapping[str, str]]) -> Settings | None:
    """Return the settings that were in force before those; None if they are not known."""
    if FORMER_SETTINGS not in metadata:
        return None
    settings: Settings = _decode(_SETTINGS, metadata, FORMER_SETTINGS)
    return settings


def _decode(adapter: TypeAdapter[Any], metadata: Mapping[str, Mapping[str, str]], name: str) -> Any:  # noqa: ANN401 - as the adapter says
    text = metadata.get(name, {}).get("json")
    if text is None:
        raise WireError(f"it has no metadata {name}")
    try:
        return adapter.validate_json(text)
    except (ValidationError, RecursionError) as error:
        where = (
            error.errors(include_url=False, include_input=False)[0]["loc"]
            if isinstance(error, ValidationError)
            else ()
        )
        raise WireError(f"{name} is not as it should be: {'.'.join(map(str, where))}") from None
