"""Keystores for an app of three processes, at a time of our own."""

import shutil
from datetime import datetime, timedelta, timezone

from plans import grcn, plan_of

from rtron.security.access.app_access import app_access
from rtron.security.access.rights import (
    AccessRight,
    AppAccess,
    NodeAccess,
    ProcessAccess,
    RightKind,
)
from rtron.security.sros2.changes import KeystoreSettings, plan_changes
from rtron.security.sros2.documents import Protection
from rtron.security.sros2.layout import Keystore
from rtron.security.sros2.state import read_state
from rtron.security.sros2.writer import KeystoreWriter
from rtron.vocabulary import Direction, Endpoint, InteractionGraph

NOW = datetime(2026, 3, 1, tzinfo=timezone.utc)
YEAR = timedelta(days=365)
PLAN = plan_of(grcn("/cmd_vel", ["/nav"], ["/base"]), app="robot", ros=2)


def access_of(*topics):
    """Return the rights of an app whose /nav publishes some topics beside its flow."""
    ends = [Endpoint(node="/nav", topic=each, direction=Direction.PUBLISH) for each in topics]
    return app_access(InteractionGraph(app="robot", ros=2, endpoints=tuple(ends)), PLAN)


def settings(now=NOW, **more):
    defaults = {"domain": 0, "protection": Protection.ENCRYPT, "now": now, "life": YEAR}
    return KeystoreSettings(**defaults | more)


def changes(folder, access=None, **more):
    given = settings(**more)
    state = read_state(Keystore(folder), given.now)
    return plan_changes(state, access or access_of("/odom"), given)


def write(folder, access=None, **more):
    """Write a keystore as a run does; return what it has changed."""
    given, keystore = settings(**more), Keystore(folder)
    state = read_state(keystore, given.now)
    planned = plan_changes(state, access or access_of("/odom"), given)
    KeystoreWriter(keystore, given).apply(state, planned)
    return planned


def changed(planned):
    """Return the names of the enclaves that change."""
    return {each.name for each in planned.enclaves if each}


def change_of(planned, name):
    (found,) = (each for each in planned.enclaves if each.name == name)
    return found


def forge(folder, keystore, domain):
    """Return a keystore of an insider: the identity of /nav, and permissions of its own making."""
    everything = frozenset(AccessRight(kind, "/*") for kind in RightKind)
    nav = ProcessAccess(name="/nav", nodes=(NodeAccess(node="/nav", rights=everything),))
    access = AppAccess(processes=(nav,))
    write(folder, access, now=datetime.now(timezone.utc), domain=domain)
    stolen = ("public/identity_ca.cert.pem", "public/crl.pem")
    for name in (*stolen, "enclaves/nav/cert.pem", "enclaves/nav/key.pem"):
        shutil.copy(keystore / name, folder / name)
    return folder
