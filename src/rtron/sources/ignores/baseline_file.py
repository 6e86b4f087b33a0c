"""An earlier scan's JSON report, as the baseline of the next one."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded
from rtron.vocabulary import RISKS_SCHEMA, Baseline

MAX_BYTES = 2**26
_HELP = "write one with `rtron scan … --format json -o FILE`"


def read_baseline(path: Path) -> Baseline:
    """Return what an earlier scan has found; raise InputError if the file is no such report."""
    try:
        document = json.loads(read_bounded(path, MAX_BYTES))
    except (ValueError, RecursionError) as error:
        raise InputError(f"not JSON: {error}", path=str(path), help=_HELP) from None
    if not isinstance(document, dict) or document.get("schema") != RISKS_SCHEMA:
        raise InputError(f"no report of a scan ({RISKS_SCHEMA})", path=str(path), help=_HELP)
    try:
        findings = [*document["findings"], *(each["finding"] for each in document["ignored"])]
        return Baseline(
            {_text(each, "fingerprint"): _text(each, "id") for each in findings},
            frozenset(_text(each, "id") for each in document["risks"]),
        )
    except (KeyError, TypeError):
        raise InputError("a finding is incomplete", path=str(path), help=_HELP) from None


def _text(entry: Mapping[str, Any], key: str) -> str:
    text = entry[key]
    if not isinstance(text, str):
        raise TypeError
    return text
