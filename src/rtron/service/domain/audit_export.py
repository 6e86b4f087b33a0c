"""Chains as JSON Lines that can be checked without the database, with the public key alone.

A line of its own begins each chain, with its anchor; a line for each entry follows. The last line
has the signed heads of all of them: without it an end could be cut off unseen.
"""

import json
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from rtron.errors import WireError
from rtron.service.domain.hash_chain import (
    HEADS_SCHEMA,
    ChainReport,
    Link,
    Witness,
    anchor_of,
    check_chain,
    heads_of,
    verify_document,
)

EXPORT_SCHEMA = "rtron.audit_export/1"
Lines = Iterable[Mapping[str, Any]]


def chain_line(chain: str, anchor: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return the line with which a chain begins."""
    return {"schema": EXPORT_SCHEMA, "chain": chain, "anchor": anchor}


def link_line(link: Link) -> dict[str, Any]:
    """Return the line of an entry."""
    return {"number": link.number, "hash": link.hash, "entry": link.content}


def parse_lines(text: Iterable[str]) -> Iterator[Mapping[str, Any]]:
    """Yield the objects of JSON Lines; WireError with the number of a line that is none."""
    for number, line in enumerate(text, 1):
        try:
            document = json.loads(line)
        except (ValueError, RecursionError):
            document = None
        if not isinstance(document, dict):
            raise WireError(f"line {number} is no JSON object")
        yield document


def signed_heads(
    lines: Lines, keys: Collection[str], source: str
) -> tuple[dict[str, list[Witness]], list[str]]:
    """Return the signed heads of each chain in some lines, and what is wrong with others.

    Lines of another schema are left out. `source` says where the lines are from.
    """
    witnesses: dict[str, list[Witness]] = {}
    faults = []
    for number, line in enumerate(lines, 1):
        if line.get("schema") != HEADS_SCHEMA:
            continue
        try:
            document = verify_document(line, keys, HEADS_SCHEMA)
            where = f"of line {number} of {source}"
            for chain, head in heads_of(document).items():
                witnesses.setdefault(chain, []).append(Witness(head, where))
        except WireError as error:
            faults.append(f"line {number} of {source}: {error}")
    return witnesses, faults


def check_export(
    lines: Lines, witnesses: Mapping[str, list[Witness]], keys: Collection[str]
) -> Iterator[ChainReport]:
    """Yield what a check of each chain in an export found; WireError if it is none."""
    remaining = iter(lines)
    line: Mapping[str, Any] | None = next(remaining, {})
    while line is not None and line.get("schema") == EXPORT_SCHEMA:
        links = _Links(remaining)
        yield _check(line, links, witnesses, keys)
        line = links.line_behind
    if line is not None and line.get("schema") != HEADS_SCHEMA:
        raise WireError("that is no export of the audit log")


def _check(
    line: Mapping[str, Any],
    links: "_Links",
    witnesses: Mapping[str, list[Witness]],
    keys: Collection[str],
) -> ChainReport:
    chain = str(line.get("chain"))
    begin, fault = anchor_of(line.get("anchor"), keys, chain)
    report = check_chain(chain, begin, links, None, witnesses.get(chain, ()))
    if fault:
        report.add(fault)
    if chain not in witnesses:
        report.add("no signed head of it is there, so its end may be cut off")
    return report


class _Links:
    """The entries of one chain, up to the line behind them."""

    def __init__(self, lines: Iterator[Mapping[str, Any]]) -> None:
        self._lines = lines
        self.line_behind: Mapping[str, Any] | None = None

    def __iter__(self) -> Iterator[Link]:
        for line in self._lines:
            if "schema" in line:
                self.line_behind = line
                return
            yield _parse_link(line)


def _parse_link(line: Mapping[str, Any]) -> Link:
    number, hash, entry = line.get("number"), line.get("hash"), line.get("entry")
    if not isinstance(number, int) or not isinstance(hash, str):
        raise WireError("an entry has no number or no hash")
    if entry is not None and not isinstance(entry, dict):
        raise WireError(f"entry {number} is none")
    return Link(number, hash, entry)
