"""One call of a webhook: signed, in bounded time, following no redirect."""

import hashlib
import hmac
from dataclasses import dataclass
from urllib.parse import urlunsplit

import httpx
from anyio import fail_after, to_thread

from rtron.errors import RTronError
from rtron.service.alerts.webhook_url import Target, check_url, look_up

SIGNATURE = "X-RTron-Signature"
TIMESTAMP = "X-RTron-Timestamp"
_PATIENCE_S = 10.0


class CallError(Exception):
    """A webhook was not reached or did not take the alert; the text holds nothing of its URL."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Letter:
    """An alert for one webhook, as bytes."""

    url: str
    secret: str
    body: bytes


def new_client() -> httpx.AsyncClient:
    """Return a client that uses no proxy and no password of the environment."""
    return httpx.AsyncClient(trust_env=False, follow_redirects=False, timeout=_PATIENCE_S)


async def post(client: httpx.AsyncClient, letter: Letter, seconds: int) -> None:
    """Send a letter, `seconds` since 1970; CallError says why it was not taken."""
    try:
        with fail_after(_PATIENCE_S):
            target = check_url(letter.url)
            address = await to_thread.run_sync(look_up, target, abandon_on_cancel=True)
            status = await _status(client, _request(client, target, address, letter, seconds))
    except TimeoutError:
        raise CallError("no answer in time") from None
    except RTronError as error:
        raise CallError(str(error)) from None
    except httpx.HTTPError as error:
        raise CallError(f"no connection: {type(error).__name__}") from None
    if not httpx.codes.is_success(status):
        raise CallError(f"it answered {status}")


def signature(secret: str, seconds: int, body: bytes) -> str:
    """Return HMAC-SHA256 of `seconds`, a dot and the body, as the header has it."""
    signed = hmac.new(secret.encode(), f"{seconds}.".encode() + body, hashlib.sha256)
    return f"sha256={signed.hexdigest()}"


async def _status(client: httpx.AsyncClient, request: httpx.Request) -> int:
    response = await client.send(request, stream=True)
    await response.aclose()
    return response.status_code


def _request(
    client: httpx.AsyncClient, target: Target, address: str, letter: Letter, seconds: int
) -> httpx.Request:
    """Make the request to the address that was checked, under the host's name."""
    path, _, query = target.path.partition("?")
    url = urlunsplit((target.scheme, _place(address, target.port), path, query, ""))
    headers = {
        "Host": _place(target.host, target.port),
        "Content-Type": "application/json",
        "User-Agent": "rtron",
        TIMESTAMP: str(seconds),
        SIGNATURE: signature(letter.secret, seconds, letter.body),
    }
    extensions = {"sni_hostname": target.host}
    return client.build_request(
        "POST", url, content=letter.body, headers=headers, extensions=extensions
    )


def _place(host: str, port: int) -> str:
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
