"""A client of the security service: JSON over HTTP with a token, by Python's own library."""

import json
import ssl
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from http.client import HTTPException
from pathlib import Path
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import quote, urlencode, urlsplit
from urllib.request import HTTPRedirectHandler, HTTPSHandler, ProxyHandler, Request, build_opener

from rtron.errors import InputError, RTronError, SourceError
from rtron.guard.system.durable_file import replace_file

_API = "/api/v1"
_TIMEOUT_S = 10.0
_MAX_RESPONSE_BYTES = 1 << 26
_MAX_TOKEN_BYTES = 1000
_WS = {"http": "ws", "https": "wss"}
_UNAUTHORIZED, _CONFLICT, _SERVER = 401, 409, 500


class RevisionConflictError(InputError):
    """Somebody else has changed the same thing meanwhile."""


@dataclass(frozen=True)
class SecurityServiceClient:
    """Calls one service with one token; InputError for what it refuses, SourceError if it is away.

    `ca` is a certificate authority of its own. Redirections and proxies are not followed: they
    would get the token.
    """

    service: str
    token: str
    ca: Path | None = None

    def get(self, *path: str, **query: object) -> Any:  # noqa: ANN401 - JSON
        """Return the resource at a path; None is left out of the query."""
        parameters = {key: value for key, value in query.items() if value is not None}
        return self._request("GET", path, query=urlencode(parameters))

    def patch(self, *path: str, body: object) -> Any:  # noqa: ANN401 - JSON
        """Change the resource at a path."""
        return self._request("PATCH", path, json.dumps(body).encode())

    def post(self, *path: str, body: object) -> Any:  # noqa: ANN401 - JSON
        """Create a resource at a path."""
        return self._request("POST", path, json.dumps(body).encode())

    def put(self, *path: str, data: bytes) -> Any:  # noqa: ANN401 - JSON
        """Put JSON at a path."""
        return self._request("PUT", path, data)

    def delete(self, *path: str, body: object) -> Any:  # noqa: ANN401 - JSON
        """Delete the resource at a path."""
        return self._request("DELETE", path, json.dumps(body).encode())

    def resolve_robot(self, name: str) -> str:
        """Return `name`, or else the only robot that the service knows."""
        if name:
            return name
        names = [robot["name"] for robot in self.get("robots")]
        if len(names) == 1:
            return str(names[0])
        help = f"give --robot: {', '.join(names[:20])}" if names else "start a guard with --service"
        raise InputError("which robot?" if names else "the service knows no robot", help=help)

    @property
    def live_url(self) -> str:
        """The address of the live WebSocket."""
        parts = urlsplit(self.service)
        return f"{_WS[parts.scheme]}://{parts.netloc}{parts.path.rstrip('/')}{_API}/live"

    @property
    def auth_headers(self) -> dict[str, str]:
        """The headers that authenticate the caller."""
        return {"Authorization": f"Bearer {self.token}"}

    @cached_property
    def tls_context(self) -> ssl.SSLContext | None:
        """How the service's certificate is checked; None without TLS."""
        if urlsplit(self.service).scheme != "https":
            return None
        try:
            return ssl.create_default_context(cafile=self.ca)
        except (OSError, ssl.SSLError) as error:
            raise InputError(f"{self.ca}: {error}", help="--ca takes a PEM file") from None

    def _request(
        self, method: str, path: tuple[str, ...], data: bytes | None = None, query: str = ""
    ) -> Any:  # noqa: ANN401 - JSON
        url = "/".join([self.service.rstrip("/") + _API, *(quote(part, safe="") for part in path)])
        request = Request(  # noqa: S310 - http or https, as `open_service_client` has checked
            f"{url}?{query}" if query else url,
            data=data,
            method=method,
            headers={**self.auth_headers, "Content-Type": "application/json"},
        )
        try:
            with self._opener.open(request, timeout=_TIMEOUT_S) as answer:
                return _decode_json(answer.read(_MAX_RESPONSE_BYTES + 1))
        except HTTPError as error:
            with error:
                raise _error_of(error) from None
        except (URLError, HTTPException, OSError) as error:
            help = "is `rtron serve` running there?"
            reason = error.reason if isinstance(error, URLError) else error
            raise SourceError(f"{self.service} does not answer: {reason}", help=help) from None

    @cached_property
    def _opener(self) -> Any:  # noqa: ANN401 - an OpenerDirector
        return build_opener(ProxyHandler({}), HTTPSHandler(context=self.tls_context), _NoRedirects)


class _NoRedirects(HTTPRedirectHandler):
    """Fails a call that is redirected."""

    def redirect_request(self, *_: object) -> None:
        return None


def open_service_client(
    service: str, token_file: Path | None, ca: Path | None
) -> SecurityServiceClient:
    """Return a client with the token of a file; InputError if there is none, or no such address."""
    parts = urlsplit(service)
    if parts.scheme not in _WS or not parts.hostname:
        help = "give the address of `rtron serve`, for example https://robots.example:8600"
        raise InputError(f"{service!r} is no address of a service", help=help)
    return SecurityServiceClient(service, _token(token_file), ca)


def renew_token_file(client: SecurityServiceClient, path: Path) -> str:
    """Renew a client's token, which is in a file; return what was done.

    InputError if the file cannot be replaced: its token then holds to its own end.
    """
    answer = client.post("tokens", "renewal", body={})
    try:
        replace_file(path.resolve(), f"{answer['secret']}\n".encode())
    except OSError as error:
        help = "put the token into a folder in which you may write"
        raise InputError(error.strerror or "cannot be written", path=str(path), help=help) from None
    replace(client, token=answer["secret"]).get("me")
    return f"{answer['name']} is renewed\n"


def _token(path: Path | None) -> str:
    help = "make one: rtron token create NAME --scope end_user --token-file FILE"
    if path is None:
        raise InputError("no token", help=f"give --token-file; {help}")
    try:
        with path.open("rb") as stream:
            text = stream.read(_MAX_TOKEN_BYTES + 1).decode("ascii").strip()
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(path), help=help) from None
    except UnicodeDecodeError:
        text = ""
    if not text or len(text) > _MAX_TOKEN_BYTES or not text.isprintable() or " " in text:
        raise InputError("holds no token", path=str(path), help=help)
    return text


def _decode_json(data: bytes) -> Any:  # noqa: ANN401 - JSON
    if len(data) > _MAX_RESPONSE_BYTES:
        raise SourceError("the service's answer is too long")
    try:
        return json.loads(data) if data else None
    except ValueError:
        raise SourceError("the service's answer is not JSON", help=_WRONG_ADDRESS_HELP) from None


def _error_of(error: HTTPError) -> RTronError:
    """Return the error of an answer: the caller's where the status says so."""
    problem = _problem(error)
    message, help = (
        str(problem.get("error") or f"the service answers {error.code}"),
        problem.get("help"),
    )
    if error.code == _CONFLICT:
        return RevisionConflictError(message, help=str(help or "look again, then ask again"))
    if error.code == _UNAUTHORIZED:
        return InputError(message, help=str(help or "the token is not known there"))
    kind = SourceError if error.code >= _SERVER or not problem else InputError
    return kind(message, help=str(help or ("" if problem else _WRONG_ADDRESS_HELP)))


def _problem(error: HTTPError) -> Mapping[str, Any]:
    try:
        problem = json.loads(error.read(_MAX_RESPONSE_BYTES))
    except (ValueError, OSError, HTTPException):
        return {}
    return problem if isinstance(problem, dict) else {}


_WRONG_ADDRESS_HELP = "is this really the address of `rtron serve`?"
