"""A keystore is written as SROS2 has it, changed where it differs, and never trusted."""

import os
import shutil
import stat
import subprocess
from datetime import datetime, timedelta, timezone

import pytest
from keystores import NOW, YEAR, access_of, change_of, changed, changes, settings, write

from rtron.errors import InputError
from rtron.security.sros2 import layout
from rtron.security.sros2.certificates import load_certificate, load_key
from rtron.security.sros2.dds_topics import DdsRights
from rtron.security.sros2.documents import Permissions, Protection, permissions_xml
from rtron.security.sros2.layout import Keystore
from rtron.security.sros2.signed_document import sign_document
from rtron.security.sros2.state import read_state

ENCLAVE_FILES = {
    "cert.pem",
    "crl.pem",
    "governance.p7s",
    "identity_ca.cert.pem",
    "key.pem",
    "permissions.p7s",
    "permissions.xml",
    "permissions_ca.cert.pem",
}
ENCLAVES = {"/rtron_guard", "/rtron_verify", "/nav", "/base"}


@pytest.fixture
def keystore(tmp_path):
    folder = tmp_path / "keystore"
    write(folder)
    return folder


def serial(folder, enclave):
    path = folder / "enclaves" / enclave / "cert.pem"
    return load_certificate(path.read_bytes(), str(path)).serial_number


def revoked(folder):
    return read_state(Keystore(folder), NOW).revoked


def rights_in(folder, enclave):
    return read_state(Keystore(folder), NOW).enclaves[enclave].permissions.rights


def test_it_is_laid_out_as_sros2_lays_it_out(keystore):
    assert {each.name for each in keystore.iterdir()} == {"public", "private", "enclaves"}
    for enclave in ("nav", "base", "rtron_guard", "rtron_verify"):
        assert {each.name for each in (keystore / "enclaves" / enclave).iterdir()} == ENCLAVE_FILES
    authorities = {"identity_ca.key.pem", "permissions_ca.key.pem"}
    assert {each.name for each in (keystore / "private").iterdir()} == authorities


def test_keys_are_their_owner_s_alone(keystore):
    keys = [*keystore.rglob("*key.pem")]
    assert len(keys) == 2 + len(ENCLAVES)
    assert {stat.S_IMODE(each.lstat().st_mode) for each in keys} == {0o600}


def test_openssl_accepts_every_signature(keystore):
    for signed in keystore.rglob("*.p7s"):
        authority = keystore / "public" / "permissions_ca.cert.pem"
        command = ["openssl", "smime", "-verify", "-text", "-in", signed, "-CAfile", authority]
        ran = subprocess.run(
            [*command, "-attime", str(int(NOW.timestamp()))], capture_output=True, check=False
        )
        assert ran.returncode == 0, ran.stderr


def test_openssl_accepts_every_certificate(keystore):
    authority = keystore / "public" / "identity_ca.cert.pem"
    for certificate in keystore.glob("enclaves/*/cert.pem"):
        command = ["openssl", "verify", "-CAfile", authority, "-attime", str(int(NOW.timestamp()))]
        subprocess.run([*command, certificate], check=True, capture_output=True)


def test_a_second_run_changes_nothing(keystore):
    before = {each: each.stat().st_mtime_ns for each in keystore.rglob("*")}
    assert not write(keystore)
    assert {each: each.stat().st_mtime_ns for each in keystore.rglob("*")} == before


def test_a_moved_keystore_is_the_same(keystore, tmp_path):
    moved = tmp_path / "elsewhere"
    keystore.rename(moved)
    assert not changes(moved)


def test_what_is_added_is_signed_and_the_identity_stays(keystore):
    number = serial(keystore, "nav")
    planned = write(keystore, access_of("/odom", "/map"))
    assert changed(planned) == {"/nav"}
    assert change_of(planned, "/nav").too_narrow.publish == {"rt/map"}
    assert "rt/map" in rights_in(keystore, "/nav").publish
    assert serial(keystore, "nav") == number


def test_what_is_taken_away_ends_the_former_identity_since_its_permission_holds(keystore):
    number = serial(keystore, "nav")
    planned = write(keystore, access_of())
    assert change_of(planned, "/nav").too_wide.publish == {"rt/odom"}
    assert serial(keystore, "nav") != number
    assert revoked(keystore) == {number}
    assert not changes(keystore, access_of())


def test_a_wildcard_of_somebody_else_covers_and_is_too_wide(keystore):
    everything = DdsRights(publish=frozenset({"rt/*", "*"}), subscribe=frozenset({"*"}))
    sign_permissions(keystore, "/nav", everything)
    change = change_of(changes(keystore), "/nav")
    assert change.too_wide.publish == {"rt/*", "*"}
    assert not change.too_narrow


def sign_permissions(folder, enclave, rights, **more):
    defaults = {"domains": frozenset({0}), "not_before": NOW, "not_after": NOW + YEAR}
    document = permissions_xml(Permissions(enclave=enclave, rights=rights, **defaults | more))
    certificate = load_certificate((folder / "public/permissions_ca.cert.pem").read_bytes(), "")
    key = load_key((folder / "private/permissions_ca.key.pem").read_bytes(), "")
    signed = sign_document(document, certificate, key)
    (folder / "enclaves" / enclave.lstrip("/") / "permissions.p7s").write_bytes(signed)


def test_what_expires_soon_is_renewed_without_revocation(keystore):
    later = NOW + YEAR - timedelta(days=29)
    number = serial(keystore, "nav")
    planned = write(keystore, now=later)
    assert changed(planned) == ENCLAVES
    assert serial(keystore, "nav") != number
    assert revoked(keystore) == frozenset()
    assert not changes(keystore, now=later)


def test_what_has_expired_is_told_and_renewed(keystore):
    later = NOW + YEAR + timedelta(days=1)
    planned = changes(keystore, now=later)
    assert any("expired" in each for each in change_of(planned, "/nav").new_identity)
    assert any("expired" in each for each in change_of(planned, "/nav").problems)
    write(keystore, now=later)
    assert not changes(keystore, now=later)


def test_an_enclave_is_revoked_and_gets_another_identity(keystore):
    number = serial(keystore, "nav")
    write(keystore, revoke=("/nav",))
    assert revoked(keystore) == {number}
    assert serial(keystore, "nav") != number


def test_an_enclave_that_no_process_uses_is_told_and_goes_when_it_is_revoked(keystore):
    shutil.copytree(keystore / "enclaves/nav", keystore / "enclaves/old/nav", symlinks=True)
    assert changes(keystore).unused == ("/old/nav",)
    write(keystore, revoke=("/old/nav",))
    assert not (keystore / "enclaves/old").exists()
    assert serial(keystore, "nav") in revoked(keystore)
    assert any("revoked" in each for each in change_of(changes(keystore), "/nav").new_identity)


def test_only_what_is_there_can_be_revoked(keystore):
    with pytest.raises(InputError, match="no enclave /nva") as raised:
        changes(keystore, revoke=("/nva",))
    assert "/nav" in raised.value.help


def test_another_domain_or_protection_is_signed_anew(keystore):
    planned = write(keystore, domain=7, protection=Protection.SIGN)
    assert changed(planned) == ENCLAVES
    assert any("id is 0" in each for each in planned.governance)
    assert any("metadata_protection_kind" in each for each in planned.governance)
    assert not changes(keystore, domain=7, protection=Protection.SIGN)


@pytest.mark.parametrize("missing", sorted(ENCLAVE_FILES))
def test_an_enclave_that_was_written_in_part_is_completed(keystore, missing):
    (keystore / "enclaves/nav" / missing).unlink()
    assert changed(changes(keystore)) == {"/nav"}
    write(keystore)
    assert not changes(keystore)


@pytest.mark.parametrize("count", range(1, 40, 3))
def test_a_run_that_dies_at_any_moment_is_completed_by_the_next(tmp_path, monkeypatch, count):
    replace, left = layout.replace_file, [count]

    def dying(*arguments):
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        replace(*arguments)

    monkeypatch.setattr(layout, "replace_file", dying)
    try:
        write(tmp_path / "keystore")
    except KeyboardInterrupt:
        assert changes(tmp_path / "keystore")
    monkeypatch.setattr(layout, "replace_file", replace)
    write(tmp_path / "keystore")
    assert not changes(tmp_path / "keystore")


def test_the_keys_of_the_authorities_may_be_elsewhere_until_something_changes(keystore):
    shutil.rmtree(keystore / "private")
    assert not write(keystore)
    with pytest.raises(InputError, match=r"identity_ca\.key\.pem: is not there") as raised:
        write(keystore, access_of())
    assert "bring private/ back" in raised.value.help


def test_the_files_of_another_keystore_are_told_and_replaced(keystore, tmp_path):
    write(tmp_path / "other")
    for name in ("cert.pem", "key.pem", "permissions.p7s"):
        shutil.copy(tmp_path / "other/enclaves/nav" / name, keystore / "enclaves/nav" / name)
    change = change_of(changes(keystore), "/nav")
    assert "its certificate is of another CA" in change.new_identity
    assert any("not signed by" in each for each in change.problems)
    write(keystore)
    assert not changes(keystore)


def test_the_certificate_of_another_enclave_is_told(keystore):
    for name in ("cert.pem", "key.pem"):
        shutil.copy(keystore / "enclaves/base" / name, keystore / "enclaves/nav" / name)
    assert "its certificate is of '/base'" in change_of(changes(keystore), "/nav").new_identity


def test_a_permission_that_was_edited_after_it_was_signed_does_not_count(keystore):
    path = keystore / "enclaves/nav/permissions.p7s"
    path.write_bytes(path.read_bytes().replace(b"rt/odom", b"rt/evil"))
    assert any("not signed by" in each for each in change_of(changes(keystore), "/nav").problems)


@pytest.mark.parametrize(
    "text", [b"", b"\0" * 99, b'boundary="x"\n\n--x\n\n--x\n\n!!\n--x--', b"<"]
)
def test_a_permission_that_is_none_is_told(keystore, text):
    (keystore / "enclaves/nav/permissions.p7s").write_bytes(text)
    assert change_of(changes(keystore), "/nav").problems
    write(keystore)
    assert not changes(keystore)


def test_a_governance_of_somebody_else_is_told(keystore):
    (keystore / "enclaves/governance.p7s").write_bytes(b"nothing")
    planned = changes(keystore)
    assert planned.governance == ("is not there, or not signed",)
    assert planned.problems == ("governance.p7s is no signed document",)


def test_a_key_that_others_could_read_is_given_up(keystore):
    number = serial(keystore, "nav")
    (keystore / "enclaves/nav/key.pem").chmod(0o644)
    write(keystore)
    assert revoked(keystore) == {number}
    assert not changes(keystore)


def test_a_key_that_is_a_link_is_given_up(keystore):
    path = keystore / "enclaves/nav/key.pem"
    path.rename(keystore / "enclaves/nav/moved.pem")
    path.symlink_to("moved.pem")
    assert change_of(changes(keystore), "/nav").new_identity
    write(keystore)
    assert not path.is_symlink()


def test_a_link_out_of_the_keystore_is_refused(keystore, tmp_path):
    outside = tmp_path / "outside.pem"
    shutil.copy(keystore / "enclaves/nav/cert.pem", outside)
    (keystore / "enclaves/nav/cert.pem").unlink()
    (keystore / "enclaves/nav/cert.pem").symlink_to(outside)
    with pytest.raises(InputError, match="leads out of the keystore"):
        changes(keystore)


def test_a_folder_that_is_a_link_is_refused(keystore, tmp_path):
    (keystore / "enclaves").rename(tmp_path / "theirs")
    (keystore / "enclaves").symlink_to(tmp_path / "theirs")
    with pytest.raises(InputError, match="a link to one"):
        changes(keystore)


@pytest.mark.parametrize("name", ["public", "private", "enclaves", "enclaves/nav"])
def test_a_folder_that_others_may_write_is_refused(keystore, name):
    (keystore / name).chmod(0o777)
    with pytest.raises(InputError, match="may be changed by others"):
        changes(keystore)


def test_a_pipe_in_place_of_a_file_is_refused(keystore):
    (keystore / "enclaves/nav/cert.pem").unlink()
    os.mkfifo(keystore / "enclaves/nav/cert.pem")
    with pytest.raises(InputError, match="pipe"):
        changes(keystore)


def test_a_loop_of_links_is_refused(keystore):
    path = keystore / "enclaves/nav/cert.pem"
    path.unlink()
    path.symlink_to("cert.pem")
    with pytest.raises(InputError, match="cannot be read"):
        changes(keystore)


def test_two_runs_do_not_change_it_at_once(keystore):
    second = Keystore(keystore).locked()
    with Keystore(keystore).locked(), pytest.raises(InputError, match="another process"):
        second.__enter__()


def test_an_authority_that_ends_before_what_it_would_sign_is_refused(keystore):
    with pytest.raises(InputError, match="expires sooner"):
        write(keystore, access_of(), now=NOW + 9.5 * YEAR)


def test_nothing_is_written_where_nothing_may_be(tmp_path):
    assert changes(tmp_path / "keystore").is_new
    assert not (tmp_path / "keystore").exists()
    assert settings().until == NOW + YEAR


@pytest.mark.parametrize("replaced", [False, True])
def test_a_revocation_list_that_is_lost_is_told_and_written_again(keystore, tmp_path, replaced):
    write(keystore, revoke=("/nav",))
    (keystore / "public" / "crl.pem").unlink()
    if replaced:
        write(tmp_path / "other")
        shutil.copy(tmp_path / "other" / "public" / "crl.pem", keystore / "public")
    planned = changes(keystore)
    assert planned
    assert "what was revoked counts again" in planned.problems[0]
    write(keystore)
    assert not changes(keystore).problems
    assert (keystore / "enclaves" / "nav" / "crl.pem").exists()


def test_the_revocation_list_of_an_authority_with_an_rsa_key_counts(keystore):
    paths = [keystore / "public" / name for name in ("identity_ca.cert.pem", "crl.pem")]
    config = keystore.parent / "ca.cnf"
    (keystore.parent / "index").touch()
    config.write_text("[ca]\ndefault_ca=a\n[a]\ndatabase=index\ndefault_md=sha256\n")
    made = ["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", "ca", "-subj", "/CN=a"]
    listed = ["ca", "-gencrl", "-keyfile", "ca", "-cert", paths[0], "-crldays", "9"]
    for command in (made, [*listed, "-config", config]):
        out = paths[command is not made]
        line = ["openssl", *command, "-out", out]
        subprocess.run(line, check=True, capture_output=True, cwd=keystore.parent)
    state = read_state(Keystore(keystore), datetime.now(timezone.utc))
    assert state.has_revocation_list


def test_every_enclave_has_the_new_revocation_list_at_once(keystore):
    copied = keystore / "enclaves" / "base" / "crl.pem"
    data = copied.read_bytes()
    copied.unlink()
    copied.write_bytes(data)
    write(keystore, revoke=("/nav",))
    assert copied.read_bytes() == (keystore / "public" / "crl.pem").read_bytes() != data


@pytest.mark.parametrize("authority", ["identity_ca", "permissions_ca"])
def test_a_key_of_an_authority_that_others_could_read_is_told(keystore, authority):
    key = keystore / "private" / f"{authority}.key.pem"
    key.chmod(0o640)
    assert f"{key.name} can be read by others" in changes(keystore).problems[0]
    key.rename(key.with_name("ca.key.pem")).chmod(0o600)
    key.symlink_to("ca.key.pem")
    assert not changes(keystore).problems


def test_an_enclave_that_is_a_link_is_refused_not_overlooked(keystore, tmp_path):
    shutil.copytree(keystore / "enclaves" / "rtron_guard", tmp_path / "stolen")
    (keystore / "enclaves" / "evil").symlink_to(tmp_path / "stolen")
    with pytest.raises(InputError, match="evil: is a link to a folder"):
        changes(keystore)


def test_a_hidden_folder_is_not_taken_for_an_enclave_of_the_app(keystore):
    shutil.copytree(keystore / "enclaves" / "nav", keystore / "enclaves" / ".nav", symlinks=True)
    planned = changes(keystore)
    assert planned.unused == ("/.nav",)
    assert not planned
