"""The script that starts a process in its enclave: a node that tries sees no other one's key.

It runs as an ordinary user, whoever runs the tests.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from file_tree import write
from harness import wait_for

from rtron.planning.instrument.ros2.enclaves import ENCLAVE_SCRIPT, Enclaves

NOBODY = 65534
AS_USER = (
    ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
    if os.geteuid() == 0
    else []
)
NAMESPACE = [*AS_USER, "unshare", "--user", "--map-root-user", "--mount", "true"]
HAS_NAMESPACES = subprocess.run(NAMESPACE, check=False, capture_output=True).returncode == 0
needs_namespaces = pytest.mark.skipif(
    not HAS_NAMESPACES, reason="this system allows no user namespaces"
)
PYTHON = shutil.which("python3", path=os.defpath) if AS_USER else sys.executable
pytestmark = pytest.mark.skipif(PYTHON is None, reason="no Python that an ordinary user may run")
ENCLAVE_FILES = ("cert.pem", "key.pem", "permissions.p7s")
TRY = """
import json, os, signal, sys
def read(path):
    try:
        return open(path).read()
    except OSError as error:
        return type(error).__name__
print(json.dumps({
    "files": {path: read(path) for path in json.loads(sys.argv[1])},
    "words": sys.argv[2:],
    "pid": os.getpid(),
    "uid": os.getuid(),
    "folder": os.getcwd(),
    "enclave": os.environ.get("ROS_SECURITY_ENCLAVE_OVERRIDE"),
}), flush=True)
"""


@pytest.fixture
def folder():
    """Return a folder that the ordinary user owns."""
    path = Path(tempfile.mkdtemp(prefix="rtron-enclave-"))
    yield path
    shutil.rmtree(path)


@pytest.fixture
def keystore(folder):
    root = folder / "key store"
    for enclave in ("rtron_guard", "nav", "nav/inner", "base"):
        at = root / "enclaves" / enclave
        at.mkdir(parents=True)
        for name in ENCLAVE_FILES:
            (at / name).write_text(f"{name} of {enclave}")
        depth = enclave.count("/") + 2
        (at / "identity_ca.cert.pem").symlink_to("../" * depth + "public/identity_ca.cert.pem")
        (at / "governance.p7s").symlink_to("../" * (depth - 1) + "governance.p7s")
    (root / "enclaves/governance.p7s").write_text("governance")
    for part, name in (("public", "identity_ca.cert.pem"), ("private", "identity_ca.key.pem")):
        (root / part).mkdir()
        (root / part / name).write_text(name)
    return root


@pytest.fixture
def start(folder, keystore):
    """Return a function that starts a command through the script, as the ordinary user."""
    enclaves = Enclaves(
        keystore=keystore,
        of_nodes={"/nav": "/nav", "/nav/inner": "/nav/inner", "/teleop_*": "/base"},
        of_programs={"p/x": "/base"},
    )
    write(folder, enclaves.texts())
    (folder / ENCLAVE_SCRIPT).chmod(0o755)
    for path in (folder, *folder.rglob("*")):
        os.chown(path, *(2 * [NOBODY if AS_USER else -1]), follow_symlinks=False)

    def started(*command, **more):
        return subprocess.Popen(
            [*AS_USER, folder / ENCLAVE_SCRIPT, *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=folder,
            **more,
        )

    return started


def tried(start, paths, *words):
    process = start(PYTHON, "-c", TRY, json.dumps([*map(str, paths)]), *words)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 0, err
    return process, json.loads(out), err


@needs_namespaces
def test_a_node_reads_its_own_enclave_and_nothing_else(start, keystore):
    own, others = keystore / "enclaves/nav", ("rtron_guard", "nav/inner", "base")
    paths = [
        *(own / name for name in (*ENCLAVE_FILES, "identity_ca.cert.pem", "governance.p7s")),
        *(keystore / "enclaves" / other / "key.pem" for other in others),
        keystore / "private/identity_ca.key.pem",
        keystore / "public/identity_ca.cert.pem",
        f"/proc/{os.getpid()}/root{keystore}/enclaves/rtron_guard/key.pem",
    ]
    _, told, err = tried(start, paths, "--ros-args", "-r", "__node:=nav", "-r", "__ns:=/")
    found = dict(zip(paths, told["files"].values(), strict=True))
    assert err == ""
    assert found[own / "key.pem"] == "key.pem of nav"
    assert found[own / "governance.p7s"] == "governance"
    assert found[own / "identity_ca.cert.pem"] == "identity_ca.cert.pem"
    assert found[keystore / "public/identity_ca.cert.pem"] == "identity_ca.cert.pem"
    hidden = [
        path for path, text in found.items() if text in ("FileNotFoundError", "PermissionError")
    ]
    assert hidden == [*paths[5:9], paths[-1]]


@needs_namespaces
def test_a_node_cannot_take_away_what_hides_the_keys(start, keystore):
    key = keystore / "enclaves/rtron_guard/key.pem"
    script = f'umount "{keystore}/enclaves"; unshare -rm umount "{keystore}/enclaves"; cat "{key}"'
    process = start("sh", "-c", script, "sh", "--ros-args", "-r", "__node:=nav")
    out, err = process.communicate(timeout=20)
    assert process.returncode != 0
    assert out == ""
    assert err.count("umount:") == 2


@needs_namespaces
def test_a_node_cannot_look_through_a_process_outside(start, keystore):
    with subprocess.Popen([*AS_USER, "sleep", "60"]) as outside:
        try:
            name = Path(f"/proc/{outside.pid}/comm")
            wait_for(lambda: name.read_text() == "sleep\n", what="the process of the user")
            path = f"/proc/{outside.pid}/root{keystore}/enclaves/rtron_guard/key.pem"
            plain = subprocess.run([*AS_USER, "cat", path], check=True, capture_output=True)
            _, told, _ = tried(start, [path], "--ros-args", "-r", "__node:=nav")
        finally:
            outside.kill()
    assert plain.stdout == b"key.pem of rtron_guard"
    assert [*told["files"].values()] == ["PermissionError"]


@needs_namespaces
def test_the_process_stays_the_one_that_launch_started(start, folder):
    process, told, _ = tried(start, [], "--ros-args", "-r", "__node:=nav")
    assert told["pid"] == process.pid
    assert told["uid"] == (NOBODY if AS_USER else os.getuid())
    assert told["folder"] == str(folder)


@needs_namespaces
def test_the_signal_of_launch_reaches_the_node(start):
    code = (
        "import signal, sys\n"
        "signal.signal(signal.SIGINT, lambda *_: sys.exit(7))\n"
        "print('ready', flush=True)\n"
        "signal.pause()"
    )
    process = start(PYTHON, "-c", code, "--ros-args", "-r", "__node:=nav")
    assert process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 7
    process.communicate()


@pytest.mark.parametrize(
    ("words", "enclave"),
    [
        (["--ros-args", "-r", "__node:=nav", "-r", "__ns:=/"], "/nav"),
        (["--ros-args", "-r", "__ns:=/nav", "-r", "__node:=inner"], "/nav/inner"),
        (["--ros-args", "-r", "__node:=nav", "-r", "__node:=x"], "/nav"),
        (["--ros-args", "-r", "__node:=teleop_17"], "/base"),
    ],
)
def test_a_node_gets_the_enclave_of_its_name(start, words, enclave):
    _, told, _ = tried(start, [], *words)
    assert told["words"] == [*words, "--ros-args", "--enclave", enclave]
    assert told["enclave"] is None


def test_a_program_without_a_name_gets_the_enclave_of_its_package(start, folder):
    program = folder / "lib" / "p" / "x"
    program.parent.mkdir(parents=True)
    program.write_text('#!/bin/sh\necho "$ROS_SECURITY_ENCLAVE_OVERRIDE"\n')
    program.chmod(0o755)
    out, _ = start(program).communicate(timeout=20)
    assert out == "/base\n"


@pytest.mark.parametrize("name", ["other", "*", "na?", "$(id)", "nav x"])
def test_a_node_that_is_not_known_gets_none(start, keystore, name):
    paths = [keystore / "enclaves/nav/key.pem"]
    _, told, err = tried(start, paths, "--ros-args", "-r", f"__node:={name}")
    assert told["enclave"] == "/rtron_unknown"
    assert told["words"] == ["--ros-args", "-r", f"__node:={name}"]
    assert f"RTron: /{name}: has no enclave" in err
    if HAS_NAMESPACES:
        assert [*told["files"].values()] == ["FileNotFoundError"]


def test_where_nothing_can_hide_the_keys_it_is_told_and_goes_on(start, folder):
    fake = folder / "bin"
    fake.mkdir()
    (fake / "unshare").write_text("#!/bin/sh\nexit 1\n")
    (fake / "unshare").chmod(0o755)
    environ = {**os.environ, "PATH": f"{fake}:{os.environ['PATH']}"}
    process = start("sh", "-c", "echo here", "--ros-args", "-r", "__node:=nav", env=environ)
    out, err = process.communicate(timeout=20)
    assert out == "here\n"
    assert "can read the keys of all enclaves" in err


@needs_namespaces
def test_what_is_loaded_into_every_program_is_loaded_into_the_process_alone(start, folder):
    library = folder / "absent library.so"
    environ = {**os.environ, "LD_PRELOAD": str(library)}
    process = start(
        "sh", "-c", 'echo "$LD_PRELOAD"', "--ros-args", "-r", "__node:=nav", env=environ
    )
    out, err = process.communicate(timeout=20)
    assert out == f"{library}\n"
    assert "RTron:" not in err


@needs_namespaces
def test_a_process_whose_keys_cannot_be_shown_does_not_start(start, keystore):
    shutil.rmtree(keystore / "enclaves/nav")
    process = start("sh", "-c", "echo here", "--ros-args", "-r", "__node:=nav")
    out, _ = process.communicate(timeout=20)
    assert (out, process.returncode) == ("", 1)


@pytest.fixture
def zenoh_keystore(keystore):
    """Return a keystore that has the files for Zenoh, too."""
    for enclave in ("nav", "base"):
        (keystore / "enclaves" / enclave / "zenoh.json5").write_text(f"session of {enclave}")
    (keystore / "zenoh").mkdir()
    (keystore / "zenoh/key.pem").write_text("the router's key")
    return keystore


CONFIG = 'echo "$ZENOH_SESSION_CONFIG_URI|$ZENOH_CONFIG_OVERRIDE"; cat "$ZENOH_SESSION_CONFIG_URI"'
OF_USER = {"ZENOH_SESSION_CONFIG_URI": "mine.json5", "ZENOH_CONFIG_OVERRIDE": "mode='peer'"}


def ran(start, script, *words, **more):
    process = start("sh", "-c", script, "sh", *words, env=os.environ | OF_USER, **more)
    return process.communicate(timeout=20)[0]


@needs_namespaces
def test_a_process_has_its_own_session_of_zenoh_and_not_the_routers_key(zenoh_keystore, start):
    script = f'{CONFIG}; cat "{zenoh_keystore}/zenoh/key.pem" || echo hidden'
    own = zenoh_keystore / "enclaves/nav/zenoh.json5"
    out = ran(start, script, "--ros-args", "-r", "__node:=nav")
    assert out == f"{own}|\nsession of navhidden\n"


def test_a_process_without_an_enclave_has_no_session_of_zenoh(zenoh_keystore, start):
    out = ran(start, CONFIG, "--ros-args", "-r", "__node:=stranger")
    assert out == "|\n"


def test_without_zenoh_a_session_of_ones_own_stays(keystore, start):
    out = ran(start, CONFIG, "--ros-args", "-r", "__node:=nav")
    assert out == "mine.json5|mode='peer'\n"
