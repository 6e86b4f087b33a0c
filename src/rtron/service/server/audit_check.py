"""Checking and exporting the audit log: the database, or an export, and heads kept elsewhere."""

import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rtron.errors import InputError, WireError
from rtron.service.domain.audit_export import (
    chain_line,
    check_export,
    link_line,
    parse_lines,
    signed_heads,
)
from rtron.service.domain.hash_chain import DocumentSigner, Head, Witness
from rtron.service.store.chain_check import (
    DatabaseReport,
    all_chains,
    chain_links,
    check_database,
    snapshot,
)
from rtron.service.store.database import Database

Witnesses = Mapping[str, list[Witness]]


def check_audit_log(
    database: Database, heads_files: Sequence[Path], keys: Collection[str]
) -> DatabaseReport:
    """Check the database, also against the heads in files; `keys` (hex) may have signed."""
    witnesses, faults = _read_heads(heads_files, keys)
    with snapshot(database) as session:
        report = check_database(session, witnesses, keys)
    return DatabaseReport(report.chains, [*faults, *report.faults])


def check_audit_export(
    path: Path, heads_files: Sequence[Path], keys: Collection[str]
) -> DatabaseReport:
    """Check an export, also against the heads in files; InputError if it is none."""
    witnesses, faults = _read_heads([path, *heads_files], keys)
    try:
        reports = list(check_export(_lines(path), witnesses, keys))
    except WireError as error:
        raise InputError(str(error), path=str(path)) from None
    gone = sorted(witnesses.keys() - {report.chain for report in reports})
    return DatabaseReport(reports, [*faults, *(f"the chain {name} is not there" for name in gone)])


def export_audit_log(
    database: Database, signer: DocumentSigner, now: int, write: Callable[[str], object]
) -> None:
    """Write all chains as JSON Lines, with signed heads as of `now` (ns) at the end."""
    heads: dict[str, Head] = {}
    with snapshot(database) as session:
        for chain in all_chains(session):
            write(_text(chain_line(chain.name, chain.anchor)))
            for link in chain_links(session, chain):
                write(_text(link_line(link)))
            heads[chain.name] = Head(chain.number, chain.hash)
    write(_text(signer.sign_heads(now, heads)))


def _read_heads(paths: Iterable[Path], keys: Collection[str]) -> tuple[Witnesses, list[str]]:
    witnesses: dict[str, list[Witness]] = {}
    faults: list[str] = []
    for path in paths:
        found, wrong = signed_heads(_lines(path), keys, str(path))
        faults += wrong
        for chain, heads in found.items():
            witnesses.setdefault(chain, []).extend(heads)
    return witnesses, faults


def _lines(path: Path) -> Iterator[Mapping[str, Any]]:
    try:
        with path.open(encoding="utf-8") as file:
            yield from parse_lines(file)
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(path)) from None
    except (WireError, UnicodeDecodeError) as error:
        raise InputError(str(error), path=str(path)) from None


def _text(line: Mapping[str, Any]) -> str:
    return json.dumps(line) + "\n"
