import os
import ssl
import stat

import httpx
import pytest
from harness import LIMIT_S
from service_app import serve_in_thread

from rtron.errors import InputError
from rtron.service.config import ServiceConfig, Tls
from rtron.service.server.app import create_app
from rtron.service.server.database_setup import add_first_admin, open_database
from rtron.service.store.accounts.users import all_users
from rtron.service.store.retention import RetentionLimits


def test_it_serves_this_machine_alone():
    config = ServiceConfig()
    assert config.host == "127.0.0.1"
    assert config.is_local
    assert not config.is_secure
    assert config.host_names == {"localhost", "127.0.0.1", "::1"}


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.2", "robots.example"])
def test_other_addresses_need_tls_or_a_word(host, certificate):
    with pytest.raises(InputError, match="not this machine alone"):
        ServiceConfig(host=host)
    assert not ServiceConfig(host=host, allow_insecure_http=True).is_secure
    assert ServiceConfig(host=host, tls=Tls(cert=certificate[0], key=certificate[1])).is_secure


@pytest.mark.parametrize(
    "wrong",
    [
        {"port": -1},
        {"port": 65536},
        {"host": ""},
        {"host": "http://x"},
        {"allowed_hosts": ("a:80",)},
        {"allowed_hosts": ("*",)},
        {"allowed_hosts": ("a..b",)},
        {"proxies": ("proxy.example.org",)},
        {"proxies": ("10.0.0.1/8",)},
        {"proxies": ("*",)},
        {"retention": RetentionLimits(max_days=0, max_bytes=1 << 30)},
        {"retention": RetentionLimits(max_days=float("nan"), max_bytes=1 << 30)},
        {"retention": RetentionLimits(max_days=1, max_bytes=(1 << 20) - 1)},
    ],
)
def test_what_cannot_be_is_refused(wrong):
    with pytest.raises(InputError) as refused:
        ServiceConfig(**wrong)
    assert refused.value.help


def test_files_of_tls_are_looked_at_first(tmp_path, certificate):
    with pytest.raises(InputError, match="No such file"):
        ServiceConfig(tls=Tls(cert=tmp_path / "none.pem", key=certificate[1]))
    (tmp_path / "bad.pem").write_text("no key")
    config = ServiceConfig(tls=Tls(cert=certificate[0], key=tmp_path / "bad.pem"))
    with pytest.raises(InputError, match="TLS"), serve_in_thread(None, config):
        pass


def test_with_tls_the_cookie_is_bound_to_the_host_and_https(tmp_path, certificate):
    tls = Tls(cert=certificate[0], key=certificate[1])
    config = ServiceConfig(database=tmp_path / "r.db", tls=tls)
    app = create_app(config)
    password = add_first_admin(app.state.service.database, 0)
    trusted = ssl.create_default_context(cafile=certificate[0])
    with (
        serve_in_thread(app, config) as port,
        httpx.Client(
            base_url=f"https://localhost:{port}", verify=trusted, timeout=LIMIT_S
        ) as client,
    ):
        answer = client.post("/api/v1/login", json={"name": "admin", "password": password})
        cookie = answer.headers["set-cookie"]
        assert cookie.startswith("__Host-rtron=")
        assert "; Secure" in cookie
        assert "; HttpOnly" in cookie
        assert "max-age=" in answer.headers["strict-transport-security"]
        assert client.get("/api/v1/me").status_code == 200
        plain = {"Origin": f"http://localhost:{port}"}
        assert client.post("/api/v1/logout", headers=plain).json()["error"].startswith("that is a")


def test_only_a_known_proxy_is_believed_about_addresses(tmp_path):
    def address(config):
        app = create_app(config)
        with serve_in_thread(app, config) as port:
            forwarded = {"X-Forwarded-For": "203.0.113.9", "X-Forwarded-Proto": "https"}
            login = {"name": "x", "password": "y"}
            httpx.post(
                f"http://127.0.0.1:{port}/api/v1/login", json=login, headers=forwarded, timeout=60
            )
        return set(app.state.login_throttle._addresses)

    assert address(ServiceConfig(database=tmp_path / "a.db")) == {"127.0.0.1"}
    proxied = ServiceConfig(database=tmp_path / "b.db", proxies=("127.0.0.1",))
    assert proxied.is_secure
    assert address(proxied) == {"203.0.113.9"}
    other = ServiceConfig(database=tmp_path / "c.db", proxies=("10.0.0.1",))
    assert address(other) == {"127.0.0.1"}


def test_nobody_else_may_read_the_database(tmp_path):
    before = os.umask(0)
    try:
        database = open_database(tmp_path / "r.db")
        with database.session() as session:
            all_users(session)
            for file in tmp_path.iterdir():
                assert stat.S_IMODE(file.stat().st_mode) == 0o600
        database.close()
    finally:
        os.umask(before)


def test_a_place_that_is_none_is_told(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        open_database(tmp_path / "none" / "r.db")
    with pytest.raises(InputError, match="directory"):
        open_database(tmp_path)


def test_there_is_one_first_admin(tmp_path):
    database = open_database(tmp_path / "r.db")
    first = add_first_admin(database, 1)
    assert len(first) == 27
    assert add_first_admin(database, 2) is None
    with database.session() as session:
        (admin,) = all_users(session)
    assert (admin.name, admin.roles) == ("admin", ["admin", "developer", "end_user"])
    assert first not in admin.password_hash
    database.close()
