"""`rtron audit`."""

import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.outcome import FINDINGS, OK, Outcome, print_part
from rtron.cli.support.service_database import (
    DEFAULT_DATABASE,
    DatabaseOption,
    database_location,
    existing_database,
    require_service_packages,
)
from rtron.errors import InputError
from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from rtron.service.store.chain_check import DatabaseReport

audit = typer.Typer(name="audit", no_args_is_help=True, help="Check and export the audit log.")

AuditDirOption = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="The folder of the signing key, as `rtron serve` has it.  "
        "[default: FILE.audit beside the database, or rtron/audit in XDG_STATE_HOME]",
        show_default=False,
    ),
]


@audit.callback()
def audit_group() -> None:
    """Check and export the audit log and the events, which are in signed hash chains."""


@audit.command()
def verify(
    export: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="An export to check instead of the database."),
    ] = None,
    *,
    heads: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Heads kept elsewhere, or by a guard; can be repeated."),
    ] = None,
    key: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="A public key, PEM, that may sign; can be repeated."),
    ] = None,
    audit_dir: AuditDirOption = None,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Find what was changed, deleted, put in or cut off in the log and the events.

    Who can write the database can rewrite all of its hashes, too. Compare with
    heads that were kept elsewhere: the files of guards (audit_heads.jsonl in
    their state folder), of webhooks, a copy of heads.jsonl. Without --key the
    public keys in the folder of the signing key count.

    $ rtron audit verify --heads /mnt/elsewhere/heads.jsonl --heads car1.jsonl
    $ rtron audit verify log.jsonl --key public.pem

    Exit code: 0 whole, 1 not, 2 bad options.
    """
    require_service_packages()
    from rtron.service.server.audit_check import check_audit_export, check_audit_log
    from rtron.service.server.audit_key import folder_keys, load_public_keys
    from rtron.service.server.heads_journal import heads_files

    folder = _audit_folder(audit_dir, database)
    keys = load_public_keys(key) if key else folder_keys(folder)
    files = [*(heads or ()), *([] if export else heads_files(folder))]
    if export:
        return _show(check_audit_export(export, files, keys))
    with existing_database(database) as db:
        return _show(check_audit_log(db, files, keys))


@audit.command("export")
def export_log(
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Write it there, not to the terminal."),
    ] = None,
    audit_dir: AuditDirOption = None,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Write the log and the events as JSON Lines that can be checked alone.

    The last line is a signature over the ends of all chains, so this needs the
    signing key. Who has the file and the public key can check it.

    $ rtron audit export -o log.jsonl
    $ rtron audit verify log.jsonl --key public.pem

    Exit code: 0 written, 2 bad options.
    """
    with existing_database(database) as db:
        from rtron.service.server.audit_check import export_audit_log
        from rtron.service.server.audit_key import load_existing_signer

        signer = load_existing_signer(_audit_folder(audit_dir, database))
        try:
            with output.open("w", encoding="utf-8") if output else nullcontext() as file:
                write = file.write if file else print_part
                export_audit_log(db, signer, time.time_ns(), write)
        except OSError as error:
            raise InputError(error.strerror or "cannot be written", path=str(output)) from None
    return Outcome("")


def _audit_folder(given: Path | None, database: str) -> Path:
    from rtron.service.config import default_audit_folder

    return given or default_audit_folder(database_location(database))


def _show(report: "DatabaseReport") -> Outcome:
    lines = [*report.faults]
    for chain in report.chains:
        lines += [f"{chain.chain}: {fault}" for fault in chain.faults]
        if chain.more_faults:
            lines.append(f"{chain.chain}: and {chain.more_faults} more")
    lines.append(_summary(report))
    text = "".join(f"{sanitize(line)}\n" for line in lines)
    return Outcome(text, OK if report.is_whole else FINDINGS)


def _summary(report: "DatabaseReport") -> str:
    entries = sum(chain.end.number - chain.begin.number for chain in report.chains)
    heads = sum(chain.compared for chain in report.chains)
    state = "whole" if report.is_whole else "NOT whole"
    text = f"{len(report.chains)} chains with {entries} entries, compared with {heads} signed heads"
    if not heads:
        text += " (who can write the database could have rewritten it: give --heads)"
    return f"{state}: {text}"
