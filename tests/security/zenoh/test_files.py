"""Zenoh's files in a keystore: written once, changed where they differ, told before."""

import json
from dataclasses import replace
from datetime import timedelta
from pathlib import PurePosixPath

import pytest
from cryptography import x509
from keystores import NOW, YEAR, access_of, settings

from rtron.errors import InputError
from rtron.security.sros2.changes import plan_changes
from rtron.security.sros2.layout import Keystore
from rtron.security.sros2.state import read_state
from rtron.security.sros2.writer import KeystoreWriter
from rtron.security.zenoh.configuration import ZenohRouter, parse_router
from rtron.security.zenoh.files import ZenohFiles, ZenohSettings

ROUTER = ZenohRouter()


class Run:
    """Runs of `rtron secure --zenoh` on one keystore."""

    def __init__(self, folder):
        self.keystore = Keystore(folder)

    def write(self, access, now=NOW, **more):
        """Write the keystore; return what Zenoh's files differed in."""
        given = settings(now=now)
        state = read_state(self.keystore, now)
        writer = KeystoreWriter(self.keystore, given)
        writer.apply(state, plan_changes(state, access, given))
        files = self._files(access, now, **more)
        changes = files.changes(state.identity_ca)
        files.write(changes, writer.identity_authority)
        return changes

    def changes(self, access, now=NOW, **more):
        authority = read_state(self.keystore, now).identity_ca
        return self._files(access, now, **more).changes(authority)

    def _files(self, access, now, router=ROUTER, installed=None):
        given = settings(now=now)
        zenoh = ZenohSettings(
            router=router,
            domain=given.domain,
            installed=installed or self.keystore.root,
            now=now,
            renewed_before=given.renewed_before,
            until=given.until,
        )
        return ZenohFiles(self.keystore, access, zenoh)

    @property
    def router_file(self):
        return self.keystore.root / "zenoh/router.json5"

    def certificate(self):
        data = (self.keystore.root / "zenoh/cert.pem").read_bytes()
        return x509.load_pem_x509_certificate(data)

    def snapshot(self):
        return {path: path.read_bytes() for path in self.keystore.root.rglob("*") if path.is_file()}


@pytest.fixture
def run(tmp_path):
    return Run(tmp_path / "keystore")


@pytest.fixture
def written(run):
    run.write(access_of("/odom"))
    return run


def test_a_new_keystore_has_a_file_for_the_router_and_each_process(run):
    planned = run.write(access_of("/odom"))
    assert planned.certificate == ("is new",)
    assert set(planned.files) == {
        "zenoh/router.json5",
        *(
            f"enclaves/{name}/zenoh.json5"
            for name in ("base", "nav", "rtron_guard", "rtron_verify")
        ),
    }
    assert planned.new == ("/base", "/nav", "/rtron_guard", "/rtron_verify")
    assert (planned.added, planned.removed, planned.gone) == ({}, {}, ())
    config = json.loads((run.keystore.folder("/nav") / "zenoh.json5").read_text())
    for path in config["transport"]["link"]["tls"].values():
        assert not isinstance(path, str) or path.startswith(str(run.keystore.folder("/nav")))
    assert oct((run.keystore.root / "zenoh/key.pem").stat().st_mode)[-3:] == "600"


def test_a_second_run_changes_nothing(written):
    before = written.snapshot()
    assert not written.write(access_of("/odom"), now=NOW + timedelta(days=1))
    assert written.snapshot() == before


def test_looking_changes_nothing(written):
    before = written.snapshot()
    planned = written.changes(access_of("/scan"))
    assert planned.files == ("zenoh/router.json5",)
    key = "0/odom/$*::$*/**"
    assert f"sends put {key}" in planned.removed["/nav"]
    assert f"sends put {key.replace('odom', 'scan')}" in planned.added["/nav"]
    assert set(planned.added) == {"/nav"}
    assert written.snapshot() == before


def test_what_somebody_has_widened_is_found_and_taken_back(written):
    config = json.loads(written.router_file.read_text())
    for rule in config["access_control"]["rules"]:
        if rule["id"].startswith("/nav#") and "put" in rule["messages"]:
            rule["key_exprs"].append("**")
    config["access_control"]["default_permission"] = "allow"
    config["adminspace"]["enabled"] = True
    written.router_file.write_text(json.dumps(config))
    planned = written.write(access_of("/odom"))
    assert "sends put **" in planned.removed["/nav"]
    assert planned.settings == ("access_control", "adminspace")
    assert not written.changes(access_of("/odom"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "no JSON"),
        ("[]", "no configuration"),
        ('{"access_control": []}', "did not write"),
        ('{"access_control": {"rules": [{}]}}', "did not write"),
        (
            '{"access_control": {"policies": [{"rules": ["a"], "subjects": ["b"]}]}}',
            "did not write",
        ),
        ("{" * 100_000, "no JSON"),
        ("\ud800", "no JSON"),
    ],
)
def test_a_file_of_others_is_refused_and_stays(written, text, message):
    data = text.encode("utf-8", "surrogatepass")
    written.router_file.write_bytes(data)
    with pytest.raises(InputError, match=message):
        written.write(access_of("/odom"))
    assert written.router_file.read_bytes() == data


def test_a_link_that_leads_out_is_refused(written, tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("{}")
    written.router_file.unlink()
    written.router_file.symlink_to(secret)
    with pytest.raises(InputError, match="leads out"):
        written.write(access_of("/odom"))
    assert secret.read_text() == "{}"


def test_a_folder_that_others_may_write_is_refused(written):
    written.router_file.parent.chmod(0o777)
    with pytest.raises(InputError, match="may be changed by others"):
        written.changes(access_of("/odom"))


def test_the_routers_certificate_is_for_its_host_and_is_renewed(written):
    first = written.certificate()
    (name,) = first.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert name == x509.DNSName("localhost")
    later = NOW + YEAR - timedelta(days=29)
    assert written.write(access_of("/odom"), now=later).certificate == ("expires on 2027-03-01",)
    second = written.certificate()
    assert second.serial_number != first.serial_number
    assert written.write(access_of("/odom"), now=later, router=ZenohRouter(host="10.0.0.1"))
    third = written.certificate()
    (name,) = third.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert str(name.value) == "10.0.0.1"


def test_no_process_has_a_certificate_for_a_host(written):
    for path in written.keystore.enclaves.rglob("cert.pem"):
        certificate = x509.load_pem_x509_certificate(path.read_bytes())
        with pytest.raises(x509.ExtensionNotFound):
            certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName)


@pytest.mark.parametrize("name", ["cert.pem", "key.pem"])
def test_a_damaged_certificate_or_key_of_the_router_is_renewed(written, name):
    (written.router_file.parent / name).write_bytes(b"nonsense")
    assert written.write(access_of("/odom")).certificate
    assert not written.changes(access_of("/odom"))


def test_a_key_that_others_could_read_is_renewed(written):
    (written.router_file.parent / "key.pem").chmod(0o644)
    assert written.write(access_of("/odom")).certificate == ("has a key that others can read",)
    assert not written.changes(access_of("/odom"))


def test_without_the_authoritys_key_nothing_is_renewed(written):
    (written.keystore.private / "identity_ca.key.pem").unlink()
    with pytest.raises(InputError, match="is not there"):
        written.write(access_of("/odom"), router=ZenohRouter(host="robot.local"))
    assert not written.changes(access_of("/odom"))


def test_the_files_name_the_folder_on_the_robot(run):
    run.write(access_of("/odom"), installed=PurePosixPath("/etc/rtron"))
    tls = json.loads(run.router_file.read_text())["transport"]["link"]["tls"]
    assert tls["listen_private_key"] == "/etc/rtron/zenoh/key.pem"
    assert tls["root_ca_certificate"] == "/etc/rtron/zenoh/identity_ca.cert.pem"


def test_a_process_that_is_revoked_leaves_no_file(written):
    given = replace(settings(), revoke=("/nav",))
    state = read_state(written.keystore, NOW)
    rest = access_of()
    rest = replace(rest, processes=tuple(each for each in rest if each.name != "/nav"))
    planned = plan_changes(state, rest, given)
    KeystoreWriter(written.keystore, given).apply(state, planned)
    assert not written.keystore.folder("/nav").exists()


@pytest.mark.parametrize(
    ("address", "host", "port"),
    [
        ("localhost", "localhost", 7447),
        ("robot.local:7500", "robot.local", 7500),
        ("10.0.0.1:1", "10.0.0.1", 1),
        ("[fd00::1]:65535", "fd00::1", 65535),
        ("[::1]", "::1", 7447),
    ],
)
def test_an_address_of_the_router(address, host, port):
    router = parse_router(address)
    assert (router.host, router.port) == (host, port)


@pytest.mark.parametrize(
    "address",
    [
        "",
        ":7447",
        "0.0.0.0",
        "[::]",
        "localhost:0",
        "localhost:65536",
        "localhost:x",
        "localhost:7447#iface=eth0",
        "localhost?rel=0",
        "tcp/localhost:7447",
        "a;b",
        "a\nb",
        "fe80::1%eth0",
        "[fe80::1%eth0]:1",
        "-a",
        "a..b",
        "rob\u00f6t",
        "x" * 254,
    ],
)
def test_what_is_no_address_of_one_host_is_refused(address):
    with pytest.raises(InputError, match="is no"):
        parse_router(address)


@pytest.mark.parametrize("name", ["", "a b", "a/b", "lo:1", "x" * 16, "lo\n"])
def test_what_is_no_interface_is_refused(name):
    with pytest.raises(InputError, match="no network interface"):
        parse_router("localhost", [name])
