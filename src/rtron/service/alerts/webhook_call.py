"""One call of a webhook: signed, in bounded time, following no redirect."""

import hashlib
import hmac
import ssl
from dataclasses import dataclass
from functools import cache
from urllib.parse import urlunsplit

import httpx
from anyio import fail_after, to_thread

from rtron.errors import RTronError
from rtron.service.alerts.webhook_url import WebhookUrl, parse_webhook_url, resolve_address

SIGNATURE_HEADER = "X-RTron-Signature"
TIMESTAMP_HEADER = "X-RTron-Timestamp"
_TIMEOUT_S = 10.0


class WebhookCallError(Exception):
    """A webhook was not reached or did not take the alert; the text holds nothing of its URL."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WebhookCall:
    """An alert for one webhook, as bytes."""

    url: str
    secret: str
    body: bytes


def new_client() -> httpx.AsyncClient:
    """Return a client that uses no proxy and no password of the environment."""
    return httpx.AsyncClient(
        verify=_tls_context(), trust_env=False, follow_redirects=False, timeout=_TIMEOUT_S
    )


@cache
def _tls_context() -> ssl.SSLContext:
    """Return what all clients trust: to read the authorities takes 20 ms."""
    return httpx.create_ssl_context(trust_env=False)


async def send_call(client: httpx.AsyncClient, call: WebhookCall, timestamp: int) -> None:
    """Send a webhook call, `timestamp` since 1970; WebhookCallError says why it failed."""
    try:
        with fail_after(_TIMEOUT_S):
            target = parse_webhook_url(call.url)
            address = await to_thread.run_sync(resolve_address, target, abandon_on_cancel=True)
            status = await _status(client, _request(client, target, address, call, timestamp))
    except TimeoutError:
        raise WebhookCallError("no answer in time") from None
    except RTronError as error:
        raise WebhookCallError(str(error)) from None
    except httpx.HTTPError as error:
        raise WebhookCallError(f"no connection: {type(error).__name__}") from None
    if not httpx.codes.is_success(status):
        raise WebhookCallError(f"it answered {status}")


def signature(secret: str, timestamp: int, body: bytes) -> str:
    """Return HMAC-SHA256 of `timestamp`, a dot and the body, as the header has it."""
    signed = hmac.new(secret.encode(), f"{timestamp}.".encode() + body, hashlib.sha256)
    return f"sha256={signed.hexdigest()}"


async def _status(client: httpx.AsyncClient, request: httpx.Request) -> int:
    response = await client.send(request, stream=True)
    await response.aclose()
    return response.status_code


def _request(
    client: httpx.AsyncClient, target: WebhookUrl, address: str, call: WebhookCall, timestamp: int
) -> httpx.Request:
    """Make the request to the address that was checked, under the host's name."""
    path, _, query = target.path.partition("?")
    url = urlunsplit((target.scheme, _authority(address, target.port), path, query, ""))
    headers = {
        "Host": _authority(target.host, target.port),
        "Content-Type": "application/json",
        "User-Agent": "rtron",
        TIMESTAMP_HEADER: str(timestamp),
        SIGNATURE_HEADER: signature(call.secret, timestamp, call.body),
    }
    extensions = {"sni_hostname": target.host}
    return client.build_request(
        "POST", url, content=call.body, headers=headers, extensions=extensions
    )


def _authority(host: str, port: int) -> str:
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
