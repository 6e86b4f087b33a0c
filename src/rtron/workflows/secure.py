"""Write the keystore of a guarded app, or tell what differs in it; find the enclaves in it."""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.ros2.enclaves import Enclaves
from rtron.planning.plan_file.loader import read_plan
from rtron.security.access.app_access import app_access
from rtron.security.access.rights import AppAccess
from rtron.security.sros2.changes import KeystoreChanges, KeystoreSettings, plan_changes
from rtron.security.sros2.documents import Protection
from rtron.security.sros2.layout import KEY, Keystore
from rtron.security.sros2.state import read_state
from rtron.security.sros2.writer import KeystoreWriter
from rtron.security.zenoh.access_control import guard_doubts
from rtron.security.zenoh.configuration import ZenohRouter
from rtron.security.zenoh.files import ZenohChanges, ZenohFiles, ZenohSettings
from rtron.sources.graph_json import read_graph
from rtron.vocabulary import InteractionGraph, Plan
from rtron.wire.ros2.domain_id import domain_id
from rtron.workflows.check_plan import require_fit

_PROGRAM = re.compile(r"[A-Za-z0-9][\w.+-]*/[\w.+-]+", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class SecureRequest:
    """A plan and its app's graph, and the keystore that is to say what they say.

    `days` is how long what is signed now is valid. `now` is an aware time. With `zenoh`, the
    keystore gets the files of Zenoh's access control, too; `installed` is where it is on the robot.
    """

    plan: Path
    graph: Path
    keystore: Path
    now: datetime
    protection: Protection = Protection.ENCRYPT
    domain: int | None = None
    days: int = 365
    operator: bool = False
    revoke: Sequence[str] = ()
    zenoh: ZenohRouter | None = None
    installed: Path | None = None


@dataclass(frozen=True, slots=True)
class SecureResult:
    """Who may do what, and what was changed, or would be; `zenoh` is None if it was not asked."""

    access: AppAccess
    changes: KeystoreChanges
    zenoh: ZenohChanges | None = None


def read_access(plan: Path, graph: Path, *, operator: bool = False) -> AppAccess:
    """Return who may do what in an app; InputError if the plan does not fit the graph."""
    read, app = read_plan(plan), read_graph(graph)
    require_fit(read, app)
    return app_access(app, read, operator=operator)


def secure(request: SecureRequest, *, write: bool) -> SecureResult:
    """Return what differs in a keystore, after it is written if that is asked for.

    InputError if it cannot be read or written, or leads out of its folder.
    """
    access = read_access(request.plan, request.graph, operator=request.operator)
    if request.zenoh:
        doubts = guard_doubts(read_plan(request.plan)) + access.doubts
        access = replace(access, doubts=doubts)
    keystore, settings = Keystore(request.keystore), _settings(request)
    zenoh = _zenoh_files(request, keystore, access, settings)
    with keystore.locked() if write else nullcontext():
        state = read_state(keystore, request.now)
        changes = plan_changes(state, access, settings)
        of_zenoh = zenoh.changes(state.identity_ca) if zenoh else None
        if write:
            writer = KeystoreWriter(keystore, settings)
            writer.apply(state, changes)
            if zenoh and of_zenoh:
                zenoh.write(of_zenoh, writer.identity_authority)
    return SecureResult(access, changes, of_zenoh)


def _zenoh_files(
    request: SecureRequest, keystore: Keystore, access: AppAccess, settings: KeystoreSettings
) -> ZenohFiles | None:
    if request.zenoh is None:
        return None
    zenoh = ZenohSettings(
        router=request.zenoh,
        domain=settings.domain,
        installed=request.installed or keystore.root,
        now=settings.now,
        renewed_before=settings.renewed_before,
        until=settings.until,
    )
    return ZenohFiles(keystore, access, zenoh)


def _settings(request: SecureRequest) -> KeystoreSettings:
    return KeystoreSettings(
        domain=domain_id(request.domain),
        protection=request.protection,
        now=request.now,
        life=timedelta(days=request.days),
        revoke=tuple(request.revoke),
    )


def find_enclaves(keystore: Path, graph: Path | None, plan: Plan) -> Enclaves:
    """Return which enclave each node and program gets; InputError if the keystore lacks one."""
    if graph is None:
        help = "add --graph: it tells which node runs in which process"
        raise InputError("--keystore without --graph", help=help)
    app = read_graph(graph)
    access = app_access(app, plan)
    _require(Keystore(keystore), access)
    of_nodes = {node.node: process.name for process in access for node in process.nodes}
    return Enclaves(
        keystore=keystore.resolve(), of_nodes=of_nodes, of_programs=_of_programs(app, of_nodes)
    )


def _require(keystore: Keystore, access: AppAccess) -> None:
    missing = [each.name for each in access if not (keystore.folder(each.name) / KEY).is_file()]
    if missing:
        help = "run `rtron secure` with the same plan and graph before"
        names = ", ".join(missing)
        raise InputError(f"has no enclave {names}", path=str(keystore.root), help=help)


def _of_programs(graph: InteractionGraph, of_nodes: Mapping[str, str]) -> Mapping[str, str]:
    """Return the enclaves of the programs that run in one process alone."""
    enclaves: dict[str, set[str]] = defaultdict(set)
    for node in graph.nodes:
        program = f"{node.package}/{node.executable}"
        if not node.process and node.name in of_nodes and _PROGRAM.fullmatch(program):
            enclaves[program].add(of_nodes[node.name])
    return {program: found.pop() for program, found in enclaves.items() if len(found) == 1}
