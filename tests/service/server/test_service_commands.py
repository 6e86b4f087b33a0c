"""`rtron serve`, `rtron token` and `rtron user`, as somebody types them."""

import re
import signal
import socket
import stat
import subprocess
import sys
import time

import httpx
import pytest
from forked_service import ForkedService
from harness import free_port, wait_for
from service_app import TLS
from systemd_socket import SystemdSocket

from rtron.cli.main import main
from rtron.errors import InputError
from rtron.service.config import ServiceConfig
from rtron.service.domain.one_time_codes import code_at, step_at
from rtron.service.server.app import create_app
from rtron.service.server.database_setup import hold_instance_lock
from rtron.service.store.accounts.passwords import verify_password
from rtron.service.store.accounts.users import get_user


@pytest.fixture(autouse=True)
def state_home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))


def start_rtron(folder, *arguments):
    command = [sys.executable, "-m", "rtron", *map(str, arguments)]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )


@pytest.fixture
def here(tmp_path, monkeypatch, capsys):
    """Run `start_rtron` in this process, for what ends before anything is served."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["rtron", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return ended.value.code, said.out, said.err

    return run


class ServeProcess:
    """`rtron serve` in a folder, with what it says in a file."""

    def __init__(self, folder, *arguments):
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.said = folder / "said.txt"
        self.said.write_text("")
        self.process = self._start(folder, ["--port", str(self.port), *arguments])

    def _start(self, folder, arguments):
        return ForkedService(arguments, folder, self.said)

    def __enter__(self):
        try:
            wait_for(self._is_ready)
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        self.process.kill()
        self.process.wait(120)

    def _is_ready(self):
        assert self.process.poll() is None, self.said.read_text()
        try:
            return httpx.get(f"{self.url}/readyz", timeout=5, verify=TLS).status_code == 200
        except httpx.HTTPError:
            return False

    def login(self, password):
        login = {"name": "admin", "password": password}
        return httpx.post(f"{self.url}/api/v1/login", json=login, timeout=120).status_code


class TypedServeProcess(ServeProcess):
    """The same, started by its command."""

    def _start(self, folder, arguments):
        command = [sys.executable, "-m", "rtron", "serve", *arguments]
        with self.said.open("w") as said:
            return subprocess.Popen(command, cwd=folder, stderr=said, stdout=said)


def test_the_first_start_tells_the_password_once(tmp_path, here):
    with TypedServeProcess(tmp_path) as serving:
        wait_for(lambda: "change it in the console" in serving.said.read_text())
        said = serving.said.read_text()
        (password,) = re.findall(r"password (\S+)\n", said)
        assert serving.url in said
        assert f"database: {tmp_path / 'rtron' / 'rtron.db'}\n" in said
        assert serving.login(password) == 200
        serving.process.send_signal(signal.SIGTERM)
        assert serving.process.wait(120) == 0
    assert stat.S_IMODE((tmp_path / "rtron" / "rtron.db").stat().st_mode) == 0o600
    with TypedServeProcess(tmp_path, "--log-level", "debug") as serving:
        assert serving.login(password) == 200
        code, out, err = here("user", "password", "admin")
        assert (code, err) == (0, "")
        reset = out.strip()
        assert serving.login(password) == 401
        assert serving.login(reset) == 200
        serving.process.send_signal(signal.SIGINT)
        assert serving.process.wait(120) == 0
        said = serving.said.read_text()
        assert password not in said
        assert reset not in said
        assert "Traceback" not in said


def test_two_services_on_one_database_are_refused(tmp_path, here):
    with ServeProcess(tmp_path) as serving:
        code, _, err = here("serve", "--port", str(serving.port))
    assert code == 2
    assert "another `rtron serve` works on this database" in err
    assert "help: " in err
    assert "password" not in err


def test_a_service_that_was_killed_leaves_no_lock(tmp_path):
    with ServeProcess(tmp_path) as killed:
        pass
    assert killed.process.returncode == -signal.SIGKILL
    with ServeProcess(tmp_path) as serving:
        assert serving.login("not the password") == 401


def test_a_port_that_is_taken_is_told(tmp_path):
    with socket.socket() as sock:
        sock.bind(("127.0.0.1", 0))
        sock.listen()
        port = sock.getsockname()[1]
        ran = start_rtron(tmp_path, "serve", "--port", port)
    assert ran.returncode == 2
    assert f"cannot listen on 127.0.0.1 port {port}" in ran.stderr
    assert "help: " in ran.stderr
    assert "password" not in ran.stderr
    with ServeProcess(tmp_path) as serving:
        wait_for(lambda: "password" in serving.said.read_text())


def test_one_service_at_a_time_on_a_file(tmp_path):
    path = tmp_path / "rtron.db"
    with (
        hold_instance_lock(path),
        pytest.raises(InputError, match="another"),
        hold_instance_lock(path),
    ):
        pass
    with hold_instance_lock(path):
        pass


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--host", "0.0.0.0"], "there is no TLS"),
        (["--tls-cert", "x.pem"], "a certificate and its key"),
        (["--tls-cert", "x.pem", "--tls-key", "y.pem"], "x.pem: No such file"),
        (["--port", "70000"], "is not a port"),
        (["--database", "mysql://x/y"], "mysql is not supported"),
        (["--database", "none/r.db"], "none/r.db: No such file"),
        (["--keep-days", "0"], "more than 0"),
    ],
)
def test_bad_options_are_2_with_a_help_line(tmp_path, here, arguments, said):
    code, _, err = here("serve", *arguments)
    assert code == 2
    assert said in err
    assert "help: " in err
    assert not (tmp_path / "rtron" / "rtron.db").exists()


def test_without_tls_the_network_is_warned_of(tmp_path):
    with ServeProcess(tmp_path, "--host", "0.0.0.0", "--insecure-http") as serving:
        wait_for(lambda: "WARNING: no TLS" in serving.said.read_text())
        said = "only to the names 0.0.0.0, 127.0.0.1, ::1, localhost"
        assert said in serving.said.read_text()


def test_a_name_is_enough(tmp_path):
    words = ["--host", "0.0.0.0", "--insecure-http", "--allow-host", "x.example"]
    with ServeProcess(tmp_path, *words) as serving:
        wait_for(lambda: "WARNING: no TLS" in serving.said.read_text())
        assert "only to the names" not in serving.said.read_text()


def test_without_the_extra_it_says_what_to_install(tmp_path):
    code = (
        "import sys; sys.modules['fastapi'] = None; sys.argv = ['rtron', *sys.argv[1:]];"
        "from rtron.cli.main import main; main()"
    )
    for words in (["serve"], ["user", "password", "admin"], ["token", "revoke", "x"]):
        command = [sys.executable, "-c", code, *words]
        ran = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
        )
        assert ran.returncode == 2
        assert "the security service needs fastapi" in ran.stderr
        assert 'pip install "rtron[service]"' in ran.stderr


@pytest.mark.parametrize(
    "words",
    [
        ["token", "create", "a", "--scope", "read"],
        ["token", "revoke", "a"],
        ["user", "password", "admin"],
    ],
)
def test_a_database_that_is_not_there_is_not_made(tmp_path, here, words):
    code, _, err = here(*words)
    assert code == 2
    assert "there is no such database" in err
    assert "give --database as `rtron serve` has it" in err
    assert not (tmp_path / "rtron" / "rtron.db").exists()


def test_a_guards_token_is_made_before_the_first_start(tmp_path, here):
    assert here("user", "add", "admin", "--role", "admin")[0] == 0
    words = ["token", "create", "car1", "--scope", "guard", "--robot", "car1"]
    code, out, err = here(*words, "--token-file", "t")
    assert (code, err) == (0, "")
    file = tmp_path / "t"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    secret = file.read_text().strip()
    assert secret not in out
    service = create_app(ServiceConfig(database=tmp_path / "rtron" / "rtron.db")).state
    assert service.collector.authenticate(secret) == "car1"
    assert here("token", "revoke", "car1")[0] == 0
    assert service.collector.authenticate(secret) is None
    service.service.database.close()


def test_a_program_renews_the_token_in_its_file(tmp_path, here):
    with ServeProcess(tmp_path) as serving:
        assert here("token", "create", "ci", "--scope", "read", "--token-file", "t")[0] == 0
        first = (tmp_path / "t").read_text()
        words = ["token", "renew", "--service", serving.url, "--token-file"]
        assert here(*words, "t") == (0, "ci is renewed\n", "")
        second = (tmp_path / "t").read_text()
        assert stat.S_IMODE((tmp_path / "t").stat().st_mode) == 0o600
        for secret, status in ((first, 401), (second, 200)):
            headers = {"Authorization": f"Bearer {secret.strip()}"}
            url = f"{serving.url}/api/v1/robots"
            assert httpx.get(url, headers=headers, timeout=120).status_code == status
        (tmp_path / "old").write_text(first)
        code, _, err = here(*words, "old")
        assert (code, "unknown, over or revoked" in err) == (2, True)


def test_a_second_factor_is_enrolled_and_removed_on_the_database(tmp_path, here):
    assert here("user", "add", "mary", "--role", "admin")[0] == 0
    command = [sys.executable, "-m", "rtron", "user", "second-factor", "mary"]

    def run(answer):
        pipe, is_key = subprocess.PIPE, lambda line: line.startswith("key: ")
        with subprocess.Popen(
            command, cwd=tmp_path, stdin=pipe, stdout=pipe, stderr=pipe, text=True
        ) as process:
            key = next(filter(is_key, process.stderr), "key: none").split()[1]
            out, err = process.communicate(answer(key) + "\n", timeout=120)
        return process.returncode, out, err

    code, out, err = run(lambda _: "not a code")
    assert (code, out, "the code is wrong" in err) == (2, "", True)
    code, out, err = run(lambda key: code_at(key, step_at(time.time_ns())))
    assert (code, len(out.splitlines())) == (0, 11)
    assert run(lambda _: "")[0] == 2
    code, out, _ = here("user", "second-factor", "mary", "--remove")
    assert (code, "password alone" in out) == (0, True)


def test_a_file_that_is_there_is_not_overwritten_and_no_token_made(tmp_path, here):
    assert here("user", "add", "admin", "--role", "admin")[0] == 0
    file = tmp_path / "t"
    file.write_text("mine")
    words = ["token", "create", "ci", "--scope", "read", "--token-file", "t"]
    code, _, err = here(*words)
    assert code == 2
    assert "File exists" in err
    assert file.read_text() == "mine"
    file.unlink()
    assert here(*words)[0] == 0
    code, _, err = here(*words[:-1], "u")
    assert code == 2
    assert "a token ci already" in err
    assert not (tmp_path / "u").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["token", "create", "a b", "--scope", "read"], "name: "),
        (["token", "create", "a", "--scope", "guard"], "belong together"),
        (["token", "create", "a", "--scope", "read", "--robot", "r"], "belong together"),
        (["token", "revoke", "a"], "there is no token a"),
        (["user", "add", "a/b", "--role", "admin"], "name: "),
        (["user", "password", "mary"], "there is no user mary"),
    ],
)
def test_what_cannot_be_is_2_with_the_reason(here, words, said):
    assert here("user", "add", "admin", "--role", "admin")[0] == 0
    code, out, err = here(*words)
    assert (code, out) == (2, "")
    assert said in err


def test_a_user_is_added_with_a_password_that_works(tmp_path, here):
    code, out, err = here("user", "add", "mary", "--role", "developer", "--password-file", "p")
    assert (code, err) == (0, "")
    password = (tmp_path / "p").read_text().strip()
    assert password not in out
    service = create_app(ServiceConfig(database=tmp_path / "rtron" / "rtron.db")).state.service
    with service.database.session() as session:
        assert verify_password(password, get_user(session, "mary").password_hash)
    service.database.close()
    assert re.fullmatch(r"([a-z2-9]{6}-){3}[a-z2-9]{6}", password)


def test_systemd_hears_of_the_start_the_loop_and_the_end(tmp_path, monkeypatch):
    with SystemdSocket(tmp_path) as systemd:
        for name, value in systemd.environment.items():
            monkeypatch.setenv(name, value)
        with TypedServeProcess(tmp_path) as serving:
            wait_for(lambda: systemd.lines().count("WATCHDOG=1") > 3)
            assert systemd.lines()[:3] == ["STATUS=serving", "READY=1", "WATCHDOG=1"]
            serving.process.send_signal(signal.SIGTERM)
            assert serving.process.wait(30) == 0
        assert systemd.lines()[-1] == "STOPPING=1"
