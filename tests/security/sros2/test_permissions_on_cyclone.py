"""What Cyclone DDS itself makes of a keystore, without ROS: Debian's library, where it is."""

import ctypes.util
import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from datetime import datetime, timedelta, timezone
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path

import pytest
from harness import wait_for
from keystores import access_of, forge, write
from ros2_harness import reserve_domain

from rtron.security.sros2.dds_topics import dds_rights

PROGRAM = Path(__file__).parents[1] / "nodes" / "cyclone_participant.py"
PLUGINS = next(Path("/usr/lib").glob("*/libddsc0debian"), None)
HAS_CYCLONE = ctypes.util.find_library("ddsc") is not None and PLUGINS is not None
pytestmark = pytest.mark.skipif(not HAS_CYCLONE, reason="no libddsc with DDS-Security is here")
OUT, FLOW = "rt/rtron/cmd_vel/out", "rt/rtron/cmd_vel/flow1"
TOPICS = (
    *(OUT, FLOW, "rt/cmd_vel", "rt/odom", "rt/rosout", "rt/clock", "rt/parameter_events", "rt/x"),
    *("ros_discovery_info", "rt/diagnostics", "rt/rtron/ping", "rt/rtron/self_1"),
    *("rq/nav/set_parametersRequest", "rr/nav/set_parametersReply", "rt/rtron_guard", "rt/"),
)
NOW = datetime.now(timezone.utc)
LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo' multicast='true'/>"
    "</Interfaces></General></Domain></CycloneDDS>"
)


@pytest.fixture
def domain():
    with reserve_domain() as number:
        yield number


@pytest.fixture
def keystore(tmp_path, domain):
    write(tmp_path / "keystore", now=NOW, domain=domain)
    return tmp_path / "keystore"


def command(folder, domain, *words):
    return [sys.executable, PROGRAM, folder, str(domain), *words]


def environ():
    path = os.pathsep.join(filter(None, (str(PLUGINS), os.environ.get("LD_LIBRARY_PATH"))))
    kept = {name: text for name, text in os.environ.items() if name != "LD_PRELOAD"}
    return kept | {"LD_LIBRARY_PATH": path, "CYCLONEDDS_URI": LOOPBACK}


def asked(folder, domain, *topics):
    ran = subprocess.run(
        command(folder, domain, "may", *topics),
        capture_output=True,
        check=False,
        env=environ(),
        text=True,
        timeout=30,
    )
    return json.loads(ran.stdout) if ran.returncode == 0 else ran.stderr


@pytest.mark.parametrize(
    "process", access_of("/odom").processes, ids=lambda each: each.name.strip("/")
)
def test_each_enclave_may_do_exactly_what_its_rights_say(keystore, domain, process):
    rights = dds_rights(process.rights)
    found = asked(keystore / "enclaves" / process.name.strip("/"), domain, *TOPICS)
    expected = {
        topic: [
            any(fnmatchcase(topic, each) for each in rights.publish),
            any(fnmatchcase(topic, each) for each in rights.subscribe),
        ]
        for topic in TOPICS
    }
    assert found == expected


def test_in_another_domain_nothing_is_allowed(keystore, domain):
    assert "no participant" in asked(keystore / "enclaves/nav", domain + 100, FLOW)


def test_what_has_expired_has_no_participant(tmp_path, domain):
    write(tmp_path / "old", now=NOW - timedelta(days=400), domain=domain)
    assert "no participant" in asked(tmp_path / "old/enclaves/nav", domain, FLOW)


@pytest.mark.parametrize("name", ["cert.pem", "permissions.p7s", "governance.p7s"])
def test_a_file_of_another_keystore_makes_no_participant(tmp_path, keystore, domain, name):
    write(tmp_path / "other", now=NOW, domain=domain)
    (keystore / "enclaves/nav" / name).unlink()
    shutil.copy(tmp_path / "other/enclaves/nav" / name, keystore / "enclaves/nav" / name)
    assert "no participant" in asked(keystore / "enclaves/nav", domain, FLOW)


@contextmanager
def staying(folder, domain, *words, tmp_path):
    """Run a participant meanwhile; give what returns what it has printed."""
    log = tmp_path / f"{len([*tmp_path.glob('*.out')])}.out"
    given = {"stdin": subprocess.PIPE, "env": environ()}
    line = command(folder, domain, *words)
    with log.open("w") as out, subprocess.Popen(line, stdout=out, stderr=out, **given) as process:
        try:
            wait_for(lambda: log.read_text() or process.poll() is not None, 20, "a participant")
            yield log.read_text
        finally:
            process.kill()


def test_the_keys_of_a_revoked_enclave_connect_to_nobody(tmp_path, keystore, domain):
    stolen = tmp_path / "stolen"
    shutil.copytree(keystore, stolen, symlinks=True)
    write(keystore, now=NOW, domain=domain, revoke=("/nav",))
    pair = (keystore / "enclaves/nav", keystore / "enclaves/rtron_guard")
    connect_two_beside(stolen / "enclaves/nav", pair, FLOW, domain, tmp_path)


def test_permissions_of_its_own_making_help_nobody_who_has_an_identity(tmp_path, keystore, domain):
    intruder = forge(tmp_path / "forged", keystore, domain) / "enclaves/nav"
    assert asked(intruder, domain, OUT) == {OUT: [True, True]}
    pair = (keystore / "enclaves/rtron_guard", keystore / "enclaves/base")
    connect_two_beside(intruder, pair, OUT, domain, tmp_path)


def test_a_certificate_without_its_key_connects_to_nobody(tmp_path, keystore, domain):
    write(tmp_path / "other", now=NOW, domain=domain)
    copy = tmp_path / "copy"
    shutil.copytree(keystore, copy, symlinks=True)
    shutil.copy(tmp_path / "other/enclaves/rtron_guard/key.pem", copy / "enclaves/rtron_guard")
    pair = (keystore / "enclaves/rtron_guard", keystore / "enclaves/base")
    connect_two_beside(copy / "enclaves/rtron_guard", pair, OUT, domain, tmp_path)


def connect_two_beside(intruder, pair, topic, domain, tmp_path):
    """Let a writer and a reader meet while an intruder writes, who has to meet neither."""
    start = partial(staying, tmp_path=tmp_path)
    with (
        start(pair[1], domain, "read", topic) as reader,
        start(intruder, domain, "write", topic) as third,
        start(pair[0], domain, "write", topic) as writer,
    ):
        assert "up" in third()
        wait_for(lambda: "matched 1" in reader() and "matched 1" in writer(), 20, "the two")
        assert "matched 2" not in reader()
        assert "matched" not in third()
