"""What an incident's file says of itself: MCAP metadata, written by the guard.

Each part is JSON under the key `json`; the first has its main values as texts, too, which other
programs show. Who reads it checks it, since files come from anywhere.
"""

import json
from dataclasses import fields
from typing import Any

from rtron.vocabulary import IncidentHeader, Plan, Settings

INCIDENT, PLAN, SETTINGS = "rtron.incident", "rtron.plan", "rtron.settings"
FORMER_SETTINGS = "rtron.former_settings"
"""The names of the metadata."""
DECISIONS = "/rtron/decisions"
"""The channel of all that is no message of the app."""


def encode_settings(settings: Settings) -> str:
    """Write settings as JSON."""
    return _json(settings)


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
        INCIDENT: {**shown, "json": _json(header)},
        PLAN: {"json": _json(plan)},
        SETTINGS: {"json": settings},
        **former,
    }


def _json(value: IncidentHeader | Plan | Settings) -> str:
    return json.dumps(value, default=_fields, ensure_ascii=False, separators=(",", ":"))


def _fields(value: Any) -> dict[str, Any]:  # noqa: ANN401 - any of the dataclasses in a document
    return {each.name: getattr(value, each.name) for each in fields(value)}
