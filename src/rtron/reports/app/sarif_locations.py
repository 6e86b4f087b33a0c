"""Where a fact was read, as SARIF says it: URIs, relative to the scanned folder where possible."""

from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from posixpath import normpath
from typing import Any
from urllib.parse import quote

from rtron.sanitize import sanitize
from rtron.vocabulary import Evidence

BASE = "SRCROOT"
_ADDRESSES = ("http://", "https://")
_PUBLIC = "github.com/"


def physical_location(evidence: Evidence, root: Path | None) -> dict[str, Any]:
    """Return a physicalLocation (SARIF 2.1.0 section 3.29); a line of 0 has no region."""
    location: dict[str, Any] = {"artifactLocation": _artifact(evidence.file, root)}
    if evidence.line > 0:
        location["region"] = {"startLine": evidence.line}
    return location


def logical_locations(nodes: Iterable[str]) -> list[dict[str, Any]]:
    """Return a logicalLocation for each node (SARIF 2.1.0 section 3.33)."""
    return [{"fullyQualifiedName": sanitize(node), "kind": "node"} for node in nodes]


def message(text: str) -> dict[str, Any]:
    """Return a plain message in which a stranger's brackets make no link (section 3.11.6)."""
    escaped = sanitize(text)
    for character in "\\[]":
        escaped = escaped.replace(character, f"\\{character}")
    return {"text": escaped}


def base_ids(root: Path | None) -> dict[str, Any]:
    """Return what the relative URIs are relative to; where `root` is relative, only in words."""
    if root is None:
        return {}
    base: dict[str, Any] = {"description": {"text": "The folder that was scanned."}}
    if root.is_absolute():
        base["uri"] = _file_uri(normpath(root.as_posix()).rstrip("/") + "/")
    return {BASE: base}


def _artifact(file: str, root: Path | None) -> dict[str, str]:
    if file.startswith(_PUBLIC):
        return {"uri": "https://" + quote(file, safe="/:@?&=%[]", errors="replace")}
    if file.lower().startswith(_ADDRESSES):
        return {"uri": quote(file, safe="/:@?&=%[]", errors="replace")}
    path = PurePosixPath(normpath(file))
    if root is not None:
        base = PurePosixPath(normpath(root.as_posix()))
        if path.is_relative_to(base) and ".." not in path.relative_to(base).parts:
            return {"uri": _quoted(str(path.relative_to(base))), "uriBaseId": BASE}
    return {"uri": _file_uri(str(path)) if path.is_absolute() else _quoted(str(path))}


def _file_uri(path: str) -> str:
    return f"file:///{_quoted(path.lstrip('/'))}"


def _quoted(path: str) -> str:
    return quote(path, errors="replace")
