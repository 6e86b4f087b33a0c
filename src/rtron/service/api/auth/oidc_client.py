"""The protocol with an OpenID provider: authorization code with PKCE, state and nonce.

OpenID Connect Core 1.0, section 3.1; RFC 7636; RFC 9207. Authlib builds and checks what is said,
httpx carries it.
"""

import hmac
import json
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote_plus

import httpx
from authlib.oauth2.rfc6749.parameters import prepare_grant_uri, prepare_token_request
from authlib.oauth2.rfc7636 import create_s256_code_challenge
from authlib.oidc.core import CodeIDToken
from authlib.oidc.discovery import get_well_known_url
from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet

from rtron.service.domain.oidc import (
    OidcConfig,
    PendingSignIn,
    ProviderUser,
    SignInError,
    SignInProblem,
)

_TIMEOUT_S = 10.0
_LEEWAY_S = 60
_ALGORITHMS = ["RS256", "PS256", "ES256"]
"""Signatures with a key pair: what a client's secret signs, or nothing, proves nothing here."""


class OidcClient:
    """Talks with one provider; used in threads. SignInError for all that is not as it should be."""

    def __init__(self, config: OidcConfig, client_secret: str | None) -> None:
        self._config = config
        self._client_secret = client_secret
        verify = str(config.ca_file) if config.ca_file else True
        self._http = httpx.Client(timeout=_TIMEOUT_S, verify=verify, trust_env=False)
        self._metadata: Mapping[str, Any] | None = None
        self._keys: Any = None

    def close(self) -> None:
        """Close the connections to the provider."""
        self._http.close()

    def authorization_url(self, pending: PendingSignIn) -> str:
        """Return where the browser goes to sign in."""
        url: str = prepare_grant_uri(
            self._endpoint("authorization_endpoint"),
            client_id=self._config.client_id,
            response_type="code",
            redirect_uri=self._config.redirect_uri,
            scope=self._config.scope,
            state=pending.state,
            nonce=pending.nonce,
            code_challenge=create_s256_code_challenge(pending.verifier),
            code_challenge_method="S256",
        )
        return url

    def finish(
        self, answer: Mapping[str, str], pending: PendingSignIn, now_s: float
    ) -> ProviderUser:
        """Return who has signed in, of the provider's answer in the browser's address."""
        if not hmac.compare_digest(answer.get("state", "").encode(), pending.state.encode()):
            raise SignInError(SignInProblem.EXPIRED, "another state")
        if answer.get("iss", self._config.issuer) != self._config.issuer:
            raise SignInError(SignInProblem.FAILED, "the answer is of another provider")
        if "error" in answer or "code" not in answer:
            raise SignInError(SignInProblem.REFUSED)
        tokens = self._fetch_tokens(answer["code"], pending)
        claims = self._checked_claims(tokens, pending, now_s)
        if _lacks(claims, self._config.roles_claim):
            claims = {**self._userinfo(tokens, claims), **claims}
        return ProviderUser(
            subject=f"{self._config.issuer}\n{claims['sub']}",
            name=self._config.name_of(claims),
            roles=self._config.roles_of(claims),
            groups=self._config.groups_of(claims),
        )

    def _fetch_tokens(self, code: str, pending: PendingSignIn) -> Mapping[str, Any]:
        body = prepare_token_request(
            "authorization_code",
            code=code,
            redirect_uri=self._config.redirect_uri,
            code_verifier=pending.verifier,
            **({} if self._client_secret else {"client_id": self._config.client_id}),
        )
        headers = {"Content-Type": "application/x-www-form-urlencoded"}
        return self._request(
            "POST",
            self._endpoint("token_endpoint"),
            content=body,
            headers=headers,
            auth=self._client_auth(),
        )

    def _client_auth(self) -> httpx.BasicAuth | None:
        """Return the client's own credentials, encoded as RFC 6749, section 2.3.1, says."""
        if self._client_secret is None:
            return None
        return httpx.BasicAuth(quote_plus(self._config.client_id), quote_plus(self._client_secret))

    def _checked_claims(
        self, tokens: Mapping[str, Any], pending: PendingSignIn, now_s: float
    ) -> Mapping[str, Any]:
        """Return the claims of the ID token, whose signature and claims are checked."""
        try:
            token = self._verified(str(tokens.get("id_token", "")))
            claims = CodeIDToken(
                token.claims,
                token.header,
                options={
                    "iss": {"essential": True, "value": self._config.issuer},
                    "aud": {"essential": True, "value": self._config.client_id},
                },
                params={
                    "nonce": pending.nonce,
                    "client_id": self._config.client_id,
                    "access_token": tokens.get("access_token"),
                },
            )
            claims.validate(now=int(now_s), leeway=_LEEWAY_S)
        except (JoseError, ValueError) as error:
            raise SignInError(
                SignInProblem.FAILED, f"the ID token: {type(error).__name__}: {error}"
            ) from None
        if not (isinstance(claims["sub"], str) and claims["sub"]):
            raise SignInError(SignInProblem.FAILED, "the ID token names nobody")
        return dict(claims)

    def _verified(self, id_token: str) -> jwt.Token:
        """Check a signature; once more with new keys, as the provider may have changed them."""
        try:
            return jwt.decode(id_token, self._key_set(), algorithms=_ALGORITHMS)
        except (JoseError, ValueError):
            self._keys = None
            return jwt.decode(id_token, self._key_set(), algorithms=_ALGORITHMS)

    def _key_set(self) -> Any:  # noqa: ANN401 - joserfc's
        if self._keys is None:
            self._keys = KeySet.import_key_set(
                self._request("GET", self._endpoint("jwks_uri"))  # type: ignore[arg-type]
            )
        return self._keys

    def _userinfo(self, tokens: Mapping[str, Any], claims: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return what the provider says beside the ID token, of the same subject."""
        if not self._discovered().get("userinfo_endpoint"):
            return {}
        headers = {"Authorization": f"Bearer {tokens.get('access_token', '')}"}
        info = self._request("GET", self._endpoint("userinfo_endpoint"), headers=headers)
        if info.get("sub") != claims["sub"]:
            raise SignInError(SignInProblem.FAILED, "the user info is of another subject")
        return info

    def _endpoint(self, name: str) -> str:
        url = self._discovered().get(name)
        if not isinstance(url, str) or not url.startswith(_schemes(self._config.issuer)):
            raise SignInError(SignInProblem.FAILED, f"the provider has no {name}")
        return url

    def _discovered(self) -> Mapping[str, Any]:
        if self._metadata is None:
            url = get_well_known_url(self._config.issuer, external=True)
            metadata = self._request("GET", url)
            if metadata.get("issuer") != self._config.issuer:
                raise SignInError(SignInProblem.FAILED, "the provider has another issuer")
            self._metadata = metadata
        return self._metadata

    def _request(self, method: str, url: str, **options: Any) -> Mapping[str, Any]:  # noqa: ANN401 - httpx'
        try:
            answer = self._http.request(method, url, **options)
            answer.raise_for_status()
            document = answer.json()
        except (httpx.HTTPError, json.JSONDecodeError, UnicodeDecodeError) as error:
            raise SignInError(SignInProblem.FAILED, f"{method} {url}: {error}") from None
        if not isinstance(document, dict):
            raise SignInError(SignInProblem.FAILED, f"{method} {url}: not an object of JSON")
        return document


def _lacks(claims: Mapping[str, Any], path: str) -> bool:
    return path not in claims and path.partition(".")[0] not in claims


def _schemes(issuer: str) -> tuple[str, ...]:
    """Return how a provider's endpoints begin: a secure one has no insecure ones."""
    return ("https://",) if issuer.startswith("https:") else ("https://", "http://")
