"""`rtron secure`."""

from datetime import datetime, timezone
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Domain, TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, STDOUT, Outcome, as_json
from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.reports.plan.keystore import KeystoreReport, ZenohReport
    from rtron.workflows.secure import SecureResult

_LONGEST_DAYS = 3600


def _complete_enclave(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the enclaves of the keystore on the line."""
    from rtron.security.access.rights import is_legal_name
    from rtron.security.sros2.layout import Keystore

    keystore = ctx.params.get("output")
    try:
        names = list(Keystore(Path(keystore)).enclave_names()) if keystore else []
    except (InputError, OSError):
        return []
    return [name for name in names if name.startswith(incomplete) and is_legal_name(name)]


class ProtectionOption(str, Enum):
    """What is done to the bytes on the wire."""

    SIGN = "sign"
    ENCRYPT = "encrypt"


def secure(  # noqa: PLR0913 - one for each option
    plan: Annotated[Path, typer.Argument(metavar="rtron.yaml", help="The plan.")],
    *,
    graph: Annotated[Path, typer.Option(metavar="GRAPH.json", help="The app's graph.")],
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="KEYSTORE",
            help="The keystore's folder; with --policy-only a file, - prints.",
        ),
    ] = STDOUT,
    diff: Annotated[
        bool, typer.Option("--diff", help="Change nothing: tell what differs in the keystore.")
    ] = False,
    policy_only: Annotated[
        bool,
        typer.Option(
            "--policy-only", help="Write SROS2's policy file, for `ros2 security`, and no keys."
        ),
    ] = False,
    protect: Annotated[
        ProtectionOption, typer.Option(help="Sign messages, or encrypt them, too.")
    ] = ProtectionOption.ENCRYPT,
    domain: Domain = None,
    days: Annotated[
        int,
        typer.Option(
            min=1,
            max=_LONGEST_DAYS,
            metavar="N",
            help="How long what is signed now is valid; a run renews what expires within 30 days.",
        ),
    ] = 365,
    operator: Annotated[
        bool,
        typer.Option(
            "--operator", help="Add an enclave that reads all topics, for `ros2 topic echo`."
        ),
    ] = False,
    revoke: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ENCLAVE",
            help="Take an enclave's certificate back; can be repeated.",
            autocompletion=_complete_enclave,
        ),
    ] = None,
    zenoh: Annotated[
        bool, typer.Option("--zenoh", help="Add the files for Zenoh's access control (rmw_zenoh).")
    ] = False,
    router: Annotated[
        str,
        typer.Option(
            metavar="HOST[:PORT]", help="Zenoh: where the router listens, and all connect to."
        ),
    ] = "localhost:7447",
    interface: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="Zenoh: processes come in by this alone; can be repeated."
        ),
    ] = None,
    installed: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Zenoh: the keystore's folder on the robot, which its files name; else KEYSTORE.",
        ),
    ] = None,
    format: Annotated[TextOrJson, typer.Option(help="A report, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Write the keystore with which SROS2 keeps strangers out of a guarded app.

    Each process gets an enclave, whose permissions are exactly what graph and
    plan say: its topics, services and actions, under the private names of the
    guarded launch. Only the guard's enclave may publish what the base reads.

    $ rtron secure rtron.yaml --graph graph.json -o keystore
    $ rtron secure rtron.yaml --graph graph.json -o keystore --diff
    $ rtron secure rtron.yaml --graph graph.json -o keystore --protect sign
    $ rtron secure rtron.yaml --graph graph.json -o keystore --revoke /old_node
    $ rtron secure rtron.yaml --graph graph.json --policy-only > policy.xml
    $ rtron instrument app.launch.py --plan rtron.yaml --keystore keystore ...

    A keystore that is there is changed where it differs: --diff shows it before,
    and compares a keystore that others have made, too. What its graph does not
    tell of a node is not allowed, and listed: look at it before you enforce.

    With --zenoh it also gets the files for rmw_zenoh: zenoh/router.json5 for the
    router (ZENOH_ROUTER_CONFIG_URI), which lets each process send and get what it
    may, and a zenoh.json5 for each enclave (ZENOH_SESSION_CONFIG_URI).

    $ rtron secure rtron.yaml --graph graph.json -o keystore --zenoh

    The keys in private/ sign everything. Keep that folder off the robot, and
    bring it back for the next change.

    Exit code: 0 written, or no difference; 1 --diff found one; 2 bad input.
    """
    from rtron.reports.plan.keystore import keystore_text, keystore_to_json
    from rtron.security.sros2.documents import Protection
    from rtron.security.zenoh.configuration import parse_router
    from rtron.workflows.secure import SecureRequest
    from rtron.workflows.secure import secure as run_secure

    if policy_only:
        return _policy(plan, graph, output, operator=operator)
    if output == STDOUT:
        raise InputError("no keystore is given", help="add -o KEYSTORE, or --policy-only")
    request = SecureRequest(
        plan=plan,
        graph=graph,
        keystore=output,
        now=datetime.now(timezone.utc),
        protection=Protection(protect.value),
        domain=domain,
        days=days,
        operator=operator,
        revoke=revoke or (),
        zenoh=parse_router(router, interface or ()) if zenoh else None,
        installed=installed,
    )
    report = _report(str(output), run_secure(request, write=not diff), written=not diff)
    as_text = format is TextOrJson.TEXT
    shown = keystore_text(report) if as_text else as_json(keystore_to_json(report))
    return Outcome(shown, FINDINGS if diff and report.differs else OK)


def _policy(plan: Path, graph: Path, output: Path, *, operator: bool) -> Outcome:
    from rtron.security.sros2.writer import policy_xml
    from rtron.workflows.secure import read_access

    policy = policy_xml(read_access(plan, graph, operator=operator))
    return Outcome(policy.decode(), to=output)


def _report(path: str, result: "SecureResult", *, written: bool) -> "KeystoreReport":
    from rtron.reports.plan.keystore import EnclaveReport, KeystoreReport

    processes = {process.name: process for process in result.access}
    changes = result.changes
    return KeystoreReport(
        path=path,
        written=written,
        is_new=changes.is_new,
        governance=changes.governance,
        enclaves=tuple(
            EnclaveReport(
                name=each.name,
                nodes=tuple(access.node for access in processes[each.name].nodes),
                rights=tuple(
                    f"{right.kind} {right.name}" for right in processes[each.name].own_rights
                ),
                is_new=each.is_new,
                reasons=(*each.new_identity, *each.problems),
                added=each.too_narrow.described(),
                removed=each.too_wide.described(),
            )
            for each in changes.enclaves
        ),
        revoked=changes.revoked,
        unused=changes.unused,
        problems=changes.problems,
        doubts=tuple((doubt.node, doubt.what, doubt.why) for doubt in result.access.doubts),
        zenoh=_zenoh_report(result),
    )


def _is_key_lost(result: "SecureResult") -> bool:
    """Tell whether a key is taken back that others may have, not only former permissions."""
    enclaves = result.changes.enclaves
    return bool(result.changes.revoked) or any(e.revokes and not e.too_wide for e in enclaves)


def _zenoh_report(result: "SecureResult") -> "ZenohReport | None":
    from rtron.reports.plan.keystore import ZenohReport

    changes = result.zenoh
    if changes is None:
        return None
    return ZenohReport(
        certificate=changes.certificate,
        files=changes.files,
        settings=changes.settings,
        new=changes.new,
        gone=changes.gone,
        added=changes.added,
        removed=changes.removed,
        revokes=_is_key_lost(result),
    )
