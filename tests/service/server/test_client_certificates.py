"""Guards' certificates over real TLS, and as a reverse proxy hands them on."""

import base64
import ssl
import subprocess
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from urllib.parse import quote

import httpx
import pytest
from anyio.from_thread import start_blocking_portal
from controller_setup import hello, plan
from harness import is_open
from service_app import AccountFactory, open_app, serve_in_thread
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidMessage, InvalidStatus

from rtron.errors import InputError
from rtron.guard.link.options import LinkOptions
from rtron.service.config import ServiceConfig, Tls
from rtron.service.server.app import create_app
from rtron.wire.common.link_protocol import NewSettings, decode_to_guard, encode_from_guard

LIMIT_S = 120


class Authority:
    """A certificate authority made with openssl, as an operator makes one."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        self.certificate = folder / "ca.pem"
        command = ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
        command += ["-days", "2", "-subj", "/CN=guards", "-keyout", "ca.key", "-out", "ca.pem"]
        self._openssl(*command)

    def issue(self, name, days="2", usage="clientAuth"):
        """Return the files of a certificate and its key."""
        extensions = self.folder / f"{name}.ext"
        extensions.write_text(f"extendedKeyUsage={usage}\nsubjectAltName=DNS:{name}\n")
        command = ["req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
        self._openssl(
            *command, "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.csr"
        )
        command = ["x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key"]
        command += ["-CAcreateserial", "-days", days, "-extfile", f"{name}.ext"]
        self._openssl(*command, "-out", f"{name}.pem")
        return self.folder / f"{name}.pem", self.folder / f"{name}.key"

    def _openssl(self, *arguments):
        subprocess.run(["openssl", *arguments], cwd=self.folder, check=True, capture_output=True)


@pytest.fixture
def authority(tmp_path):
    return Authority(tmp_path / "authority")


@pytest.fixture
def config(database_file, authority, certificate):
    cert, key = certificate
    return ServiceConfig(
        database=database_file, tls=Tls(cert=cert, key=key), client_ca=authority.certificate
    )


@pytest.fixture
def app(config):
    with open_app(config) as app:
        yield app


@pytest.fixture
def port(app, config):
    with serve_in_thread(app, config) as port:
        yield port


@pytest.fixture
def token(app):
    return AccountFactory(app.state.service).token_headers("car1", "guard", robot="car1")


def options(tmp_path, port, trusted, shown=(None, None)):
    return LinkOptions(
        service=f"https://localhost:{port}",
        token_file=Path("none"),
        robot="car1",
        state=tmp_path,
        ca=trusted,
        certificate=shown[0],
        key=shown[1],
    )


@contextmanager
def guard(url, headers, tls=None):
    """A guard that said hello; as in the product, one thread writes and reads its TLS."""
    connection = connect(url, additional_headers=headers, ssl=tls, proxy=None, open_timeout=LIMIT_S)
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(connection) as socket:
        portal.call(partial(socket.send, encode_from_guard(hello(plan())), text=True))
        assert isinstance(decode_to_guard(portal.call(socket.recv)), NewSettings)
        yield socket


def over_tls(tmp_path, port, certificate, token, shown=(None, None)):
    made = options(tmp_path, port, certificate[0], shown)
    return guard(made.url, token, made.tls_context())


def refusal(refused):
    return refused.value.response.status_code, refused.value.response.body.decode()


def test_a_guard_connects_with_its_robots_certificate(
    tmp_path, port, authority, certificate, token, app
):
    with over_tls(tmp_path, port, certificate, token, authority.issue("car1")):
        assert app.state.service.hub.is_connected("car1")


@pytest.mark.parametrize("name", ["car2", "CAR1", "car1.evil.example"])
def test_a_token_with_another_certificate_is_worthless(
    tmp_path, port, authority, certificate, token, name
):
    shown = authority.issue(name)
    with (
        pytest.raises(InvalidStatus) as refused,
        over_tls(tmp_path, port, certificate, token, shown),
    ):
        pass
    assert refusal(refused) == (403, "the guard's certificate is not that of car1")


def test_a_token_without_a_certificate_is_worthless(tmp_path, port, certificate, token):
    with pytest.raises(InvalidStatus) as refused, over_tls(tmp_path, port, certificate, token):
        pass
    assert refusal(refused) == (403, "the guard shows no certificate")


def test_certificates_of_others_over_or_for_servers_do_not_get_as_far(
    tmp_path, port, authority, certificate, token
):
    other = Authority(tmp_path / "other")
    for shown in (
        other.issue("car1"),
        authority.issue("car1", days="-1"),
        authority.issue("car1", usage="serverAuth"),
    ):
        with (
            pytest.raises((OSError, EOFError, InvalidMessage, ConnectionClosed)),
            over_tls(tmp_path, port, certificate, token, shown),
        ):
            pass


def test_a_certificate_is_no_token(tmp_path, port, authority, certificate):
    wrong = {"Authorization": "Bearer rtron_wrong"}
    with (
        pytest.raises(InvalidStatus) as refused,
        over_tls(tmp_path, port, certificate, wrong, authority.issue("car1")),
    ):
        pass
    assert refusal(refused)[0] == 401


def test_browsers_and_programs_need_no_certificate(port, certificate):
    context = ssl.create_default_context(cafile=certificate[0])
    url = f"https://localhost:{port}/healthz"
    assert httpx.get(url, verify=context, timeout=LIMIT_S).status_code == 200


def test_a_header_counts_for_nothing_without_a_proxy(tmp_path, port, authority, certificate, token):
    header = {"Client-Cert": rfc9440(authority.issue("car1")[0])}
    with (
        pytest.raises(InvalidStatus) as refused,
        over_tls(tmp_path, port, certificate, token | header),
    ):
        pass
    assert refusal(refused)[1] == "the guard shows no certificate"


def rfc9440(certificate):
    der = ssl.PEM_cert_to_DER_cert(certificate.read_text())
    return f":{base64.b64encode(der).decode()}:"


def nginx(certificate):
    return quote(certificate.read_text(), safe="")


@pytest.fixture
def proxied(tmp_path, authority):
    """A service behind a proxy at 127.0.0.1, and a way to it that is no proxy."""
    config = ServiceConfig(
        database=tmp_path / "proxied.db", proxies=("127.0.0.1",), client_ca=authority.certificate
    )
    app = create_app(config)
    token = AccountFactory(app.state.service).token_headers("car1", "guard", robot="car1")
    with serve_in_thread(app, config) as port:
        yield f"ws://127.0.0.1:{port}/link/v1", token


@pytest.mark.parametrize("encode", [rfc9440, nginx])
def test_a_proxy_hands_the_certificate_on(proxied, authority, encode):
    url, token = proxied
    with guard(url, token | {"Client-Cert": encode(authority.issue("car1")[0])}):
        pass


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (lambda a: None, "the guard shows no certificate"),
        (lambda a: "", "the guard shows no certificate"),
        (lambda a: "::", "the guard shows no certificate"),
        (lambda a: ":!!!:", "the guard shows no certificate"),
        (lambda a: "car1", "the guard shows no certificate"),
        (lambda a: ":AAAA:", "the guard's certificate cannot be read"),
        (lambda a: rfc9440(a.issue("car2")[0]), "the guard's certificate is not that of car1"),
        (
            lambda a: rfc9440(Authority(a.folder / "x").issue("car1")[0]),
            "the guard's certificate is not of this service's authority",
        ),
        (
            lambda a: rfc9440(a.issue("car1", days="-1")[0]),
            "the guard's certificate is not valid now",
        ),
        (
            lambda a: rfc9440(a.issue("car1", usage="serverAuth")[0]),
            "the guard's certificate is not for clients",
        ),
    ],
)
def test_what_a_proxy_hands_on_is_checked(proxied, authority, value, reason):
    url, token = proxied
    header = value(authority)
    headers = token if header is None else token | {"Client-Cert": header}
    with pytest.raises(InvalidStatus) as refused, guard(url, headers):
        pass
    assert refusal(refused) == (403, reason)


def test_two_certificates_are_none(proxied, authority):
    url, token = proxied
    value = rfc9440(authority.issue("car1")[0])
    headers = [*token.items(), ("Client-Cert", value), ("Client-Cert", value)]
    with pytest.raises(InvalidStatus) as refused, guard(url, headers):
        pass
    assert refusal(refused)[1] == "the guard shows no certificate"


def test_from_elsewhere_the_header_counts_for_nothing(tmp_path, authority):
    config = ServiceConfig(
        database=tmp_path / "rtron.db", proxies=("10.0.0.1",), client_ca=authority.certificate
    )
    app = create_app(config)
    token = AccountFactory(app.state.service).token_headers("car1", "guard", robot="car1")
    headers = token | {"Client-Cert": rfc9440(authority.issue("car1")[0])}
    with (
        serve_in_thread(app, config) as port,
        pytest.raises(InvalidStatus) as refused,
        guard(f"ws://127.0.0.1:{port}/link/v1", headers),
    ):
        pass
    assert refusal(refused)[1] == "the guard shows no certificate"


def test_a_thief_of_a_guards_token_cannot_renew_it_past_the_certificate(port, certificate, token):
    context = ssl.create_default_context(cafile=certificate[0])
    url = f"https://localhost:{port}/api/v1/tokens/renewal"
    assert httpx.post(url, headers=token, verify=context, timeout=LIMIT_S).status_code == 403


def test_an_authority_needs_tls(tmp_path, authority):
    with pytest.raises(InputError, match="without TLS"):
        ServiceConfig(database=tmp_path / "rtron.db", client_ca=authority.certificate)


def test_an_authority_that_is_none_is_told(tmp_path, certificate):
    cert, key = certificate
    for content in ("", "no certificate"):
        (tmp_path / "ca.pem").write_text(content)
        with pytest.raises(InputError, match=r"ca\.pem|certificates"):
            create_app(
                ServiceConfig(
                    database=tmp_path / "rtron.db",
                    tls=Tls(cert=cert, key=key),
                    client_ca=tmp_path / "ca.pem",
                )
            )
        assert not is_open(tmp_path / "rtron.db")


def test_a_guards_files_are_checked_before_it_starts(tmp_path, authority, certificate):
    good = options(tmp_path, 8600, certificate[0], authority.issue("car1"))
    good.check_tls()
    for wrong in (
        replace(good, key=None),
        replace(good, certificate=None),
        replace(good, service="http://localhost:8600"),
        replace(good, key=certificate[1]),
        replace(good, ca=tmp_path / "none.pem"),
    ):
        with pytest.raises(InputError):
            wrong.check_tls()
