"""Who is at the control socket: two that work as one user are two persons, and one stays one."""

import json
import os
import pwd
import subprocess
import sys
import threading

import pytest

from rtron.guard.core.control_socket import ControlSocket
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.system.unix_socket import local_users, login_user

CLIENT = """
import pathlib, socket, sys
if sys.argv[2]:
    pathlib.Path("/proc/self/loginuid").write_text(sys.argv[2])
with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
    sock.connect(sys.argv[1])
    sock.sendall(b"{}\\n")
    print(sock.makefile().readline())
"""


@pytest.fixture
def path(tmp_path):
    """A control socket that tells each client as whom it is known."""
    loop, path = EventLoop(), tmp_path / "own" / "guard.sock"
    control = ControlSocket(loop, path, lambda who, request: {"who": who})
    control.open()
    thread = threading.Thread(target=loop.run)
    thread.start()
    yield path
    loop.post(loop.stop)
    thread.join()
    control.close()
    loop.close()


def person(path, login=""):
    """Return as whom a process is known whose session has a login."""
    command = [sys.executable, "-c", CLIENT, str(path), str(login)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if "PermissionError" in done.stderr or "FileNotFoundError" in done.stderr:
        pytest.skip("this user may not choose a login here")
    return json.loads(done.stdout)["who"]


def test_two_persons_that_work_as_one_user_are_two(path):
    daemon = next(uid for uid, name in local_users().items() if name == "daemon")
    assert person(path, daemon) == "daemon"
    assert person(path, 54321) == "54321"


def test_who_has_no_login_is_the_user_that_it_works_as(path):
    assert person(path, (1 << 32) - 1) == pwd.getpwuid(os.getuid()).pw_name


def test_of_a_process_that_is_not_there_no_login_is_known():
    assert login_user(1 << 30) is None
