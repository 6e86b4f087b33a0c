"""Zenoh's files in a keystore: what differs from what graph and plan say, and writing them.

zenoh/                       the router's configuration, certificate and key
enclaves/<name>/zenoh.json5  the configuration of a process, beside its certificate and key

Processes are known by the certificates that they have for SROS2. The router's is the only one that
names a host: so no process can take its place.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from itertools import product
from pathlib import Path, PurePath
from typing import Any

from cryptography import x509

from rtron.errors import InputError
from rtron.security.access.rights import AppAccess
from rtron.security.sros2.certificates import (
    Authority,
    certificate_pem,
    create_server,
    is_for_host,
    is_issued_by,
    key_pem,
    load_certificate,
    load_key,
)
from rtron.security.sros2.layout import CERTIFICATE, IDENTITY_CA, KEY, Keystore
from rtron.security.zenoh.configuration import TlsFiles, ZenohRouter, router_config, session_config

ROUTER_FOLDER, ROUTER_FILE, SESSION_FILE = "zenoh", "router.json5", "zenoh.json5"
_MAX_BYTES = 64 * 2**20
"""A router's configuration has some 8 kB for each process."""
_CONTROL = "access_control"
_DIRECTIONS = {"ingress": "sends", "egress": "gets"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohSettings:
    """What Zenoh's files are to say; `installed` is where the keystore is on the robot.

    What expires before `renewed_before` is renewed until `until`; `now` is an aware time.
    """

    router: ZenohRouter
    domain: int
    installed: PurePath
    now: datetime
    renewed_before: datetime
    until: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohChanges:
    """What differs: why the router gets a certificate, which files, and what processes may do.

    `new` and `gone` are processes; `added` and `removed` are what the others may send and get,
    under which keys.
    """

    certificate: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    new: tuple[str, ...] = ()
    gone: tuple[str, ...] = ()
    added: Mapping[str, tuple[str, ...]]
    removed: Mapping[str, tuple[str, ...]]

    def __bool__(self) -> bool:
        return bool(self.certificate or self.files)


class ZenohFiles:
    """The files that an app's keystore is to have for Zenoh."""

    def __init__(self, keystore: Keystore, access: AppAccess, settings: ZenohSettings) -> None:
        self._keystore = keystore
        self._settings = settings
        self._folder = keystore.root / ROUTER_FOLDER
        files = self._tls_files(self._folder)
        self._config = router_config(access, settings.router, files, settings.domain)
        self._contents = {self._folder / ROUTER_FILE: _as_bytes(self._config)}
        for process in access:
            folder = keystore.folder(process.name)
            config = session_config(settings.router, self._tls_files(folder))
            self._contents[folder / SESSION_FILE] = _as_bytes(config)

    def changes(self, authority: x509.Certificate | None) -> ZenohChanges:
        """Return what differs; InputError if a file leads out, or is no configuration."""
        self._keystore.check_folder(self._folder)
        path = self._folder / ROUTER_FILE
        found = _parse(self._keystore.read(path, _MAX_BYTES), str(path))
        now, then = _allowed(found, str(path)), _allowed(self._config, str(path))
        return ZenohChanges(
            certificate=tuple(self._certificate_problems(authority)),
            files=tuple(str(each.relative_to(self._keystore.root)) for each in self._differing()),
            settings=tuple(_differing_settings(found, self._config)) if found else (),
            new=tuple(sorted(then.keys() - now.keys())),
            gone=tuple(sorted(now.keys() - then.keys())),
            added=_difference(then, now),
            removed=_difference(now, then),
        )

    def write(self, changes: ZenohChanges, authority: Callable[[], Authority]) -> None:
        """Write what differs; `authority` is asked for only if the router gets a certificate."""
        settings, keystore = self._settings, self._keystore
        if changes.certificate:
            certificate, key = create_server(
                settings.router.host, authority(), settings.now, settings.until
            )
            keystore.write(self._folder / KEY, key_pem(key), private=True)
            keystore.write(self._folder / CERTIFICATE, certificate_pem(certificate))
        keystore.link(self._folder / IDENTITY_CA, keystore.public / IDENTITY_CA)
        for path in self._differing():
            keystore.write(path, self._contents[path])

    def _differing(self) -> list[Path]:
        read = self._keystore.read
        return [path for path, data in self._contents.items() if read(path, _MAX_BYTES) != data]

    def _certificate_problems(self, authority: x509.Certificate | None) -> Iterator[str]:
        """Yield why the router needs another certificate."""
        paths = [self._folder / name for name in (CERTIFICATE, KEY)]
        certificate_data, key_data = map(self._keystore.read, paths)
        if certificate_data is None or key_data is None:
            yield "is new"
            return
        try:
            certificate = load_certificate(certificate_data, str(paths[0]))
            key = load_key(key_data, str(paths[1]))
        except InputError as error:
            yield error.reason
            return
        settings = self._settings
        problems = {
            "is of another CA": authority is None or not is_issued_by(certificate, authority),
            "is not its key's": certificate.public_key() != key.public_key(),
            f"is not for {settings.router.host}": not is_for_host(
                certificate, settings.router.host
            ),
            f"expires on {certificate.not_valid_after_utc:%Y-%m-%d}": (
                certificate.not_valid_after_utc < settings.renewed_before
            ),
            "has a key that others can read": not self._keystore.is_private_file(paths[1]),
        }
        yield from (problem for problem, is_so in problems.items() if is_so)

    def _tls_files(self, folder: Path) -> TlsFiles:
        """Return the files of a folder, where they are on the robot."""
        installed = self._settings.installed / folder.relative_to(self._keystore.root)
        return TlsFiles(
            authority=installed / IDENTITY_CA,
            certificate=installed / CERTIFICATE,
            key=installed / KEY,
        )


def _as_bytes(config: Mapping[str, Any]) -> bytes:
    return json.dumps(config, indent=1).encode() + b"\n"


def _parse(data: bytes | None, path: str) -> dict[str, Any]:
    """Return a configuration that may be others'; nothing if there is none."""
    try:
        found = json.loads(data) if data else {}
    except ValueError as error:
        raise InputError(f"is no JSON: {error}", path=path, help="remove it") from None
    if not isinstance(found, dict):
        raise InputError("is no configuration of Zenoh", path=path, help="remove it")
    return found


def _allowed(config: Mapping[str, Any], path: str) -> dict[str, set[str]]:
    """Return what each process may send and get by a router's configuration."""
    control = config.get(_CONTROL, {})
    try:
        rules = {rule["id"]: set(_allowed_by(rule)) for rule in control.get("rules", ())}
        return {
            subject: set[str]().union(*(rules[rule] for rule in policy["rules"]))
            for policy in control.get("policies", ())
            for subject in policy["subjects"]
        }
    except (AttributeError, KeyError, TypeError):
        message = f"has an {_CONTROL} that RTron did not write"
        raise InputError(message, path=path, help="remove the file") from None


def _allowed_by(rule: Mapping[str, Any]) -> Iterator[str]:
    for flow, message, key in product(rule["flows"], rule["messages"], rule["key_exprs"]):
        yield f"{_DIRECTIONS[flow]} {message} {key}"


def _difference(
    left: Mapping[str, set[str]], right: Mapping[str, set[str]]
) -> dict[str, tuple[str, ...]]:
    """Return what a process that is on both sides may on the left and may not on the right."""
    both = left.keys() & right.keys()
    missing = {name: tuple(sorted(left[name] - right[name])) for name in sorted(both)}
    return {name: lines for name, lines in missing.items() if lines}


def _differing_settings(found: Mapping[str, Any], expected: Mapping[str, Any]) -> Iterator[str]:
    """Yield the sections that differ, beside the rules, which are told one by one."""
    found, expected = _without_rules(found), _without_rules(expected)
    for name in sorted(found.keys() | expected.keys()):
        if found.get(name) != expected.get(name):
            yield name


def _without_rules(config: Mapping[str, Any]) -> dict[str, Any]:
    control = config.get(_CONTROL, {})
    rest = {name: value for name, value in control.items() if name not in ("rules", "policies")}
    return {**config, _CONTROL: rest}
