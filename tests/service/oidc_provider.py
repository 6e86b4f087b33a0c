"""A real OpenID provider on this machine (oidc-provider-mock), which here checks PKCE, too."""

import base64
import hashlib
import io
import json
import threading
from contextlib import contextmanager
from urllib.parse import parse_qs, urlsplit

import werkzeug.serving
import werkzeug.test
from oidc_provider_mock import User, app

GROUPS = "groups"


class Provider:
    """The provider as a WSGI app: it binds each code to the challenge that it was asked with.

    `rewrite` changes what the token endpoint says, as an attacker or a bad provider would. Some
    providers ignore the challenge: not `checks_challenge`.
    """

    def __init__(self):
        self._app = app(require_nonce=True, user_claims=list(self._users()))
        self._challenges = {}
        self.rewrite = lambda tokens: tokens
        self.checks_challenge = True
        self.requests = []
        self.url = self.secret_file = ""

    def _users(self):
        groups = {
            "mary": ["robot-developers", "everybody"],
            "ada": ["robot-admins"],
            "guest": ["everybody"],
            "admin": ["robot-admins"],
            "odd": ["robot-admins"],
        }
        for name, values in groups.items():
            told = {"preferred_username": "a b\u202e" if name == "odd" else name, GROUPS: values}
            yield User(sub=f"sub-{name}", claims=told)

    def set_claims(self, sub, claims):
        """Let a user have other claims from now on."""
        self._call("PUT", f"/users/{sub}", json.dumps(claims).encode(), "application/json")

    def __call__(self, environ, start_response):
        """Answer as the provider does, with PKCE."""
        path, query = environ["PATH_INFO"], parse_qs(environ.get("QUERY_STRING", ""))
        self.requests.append((environ["REQUEST_METHOD"], path))
        if path == "/oauth2/authorize":
            return self._app(environ, self._remember_code(query, start_response))
        if path == "/oauth2/token":
            return self._answer_token(environ, start_response)
        return self._app(environ, start_response)

    def _remember_code(self, query, start_response):
        def remember(status, headers, *more):
            code = parse_qs(urlsplit(dict(headers).get("Location", "")).query).get("code")
            if code:
                assert query["code_challenge_method"] == ["S256"]
                self._challenges[code[0]] = query["code_challenge"][0]
            return start_response(status, headers, *more)

        return remember

    def _answer_token(self, environ, start_response):
        body = environ["wsgi.input"].read(int(environ["CONTENT_LENGTH"]))
        form = parse_qs(body.decode())
        digest = hashlib.sha256(form.get("code_verifier", [""])[0].encode()).digest()
        shown = base64.urlsafe_b64encode(digest).decode().rstrip("=")
        is_right = self._challenges.pop(form["code"][0], None) == shown
        if self.checks_challenge and not is_right:
            start_response("400 Bad Request", [("Content-Type", "application/json")])
            return [b'{"error": "invalid_grant"}']
        status = []
        said = self._app(
            environ | {"wsgi.input": io.BytesIO(body)}, lambda *given: status.append(given)
        )
        answer = json.dumps(self.rewrite(json.loads(b"".join(said)))).encode()
        start_response(status[0][0], [("Content-Type", "application/json")])
        return [answer]

    def _call(self, method, path, body, media_type):
        answer = werkzeug.test.Client(self._app).open(
            path, method=method, data=body, content_type=media_type
        )
        assert answer.status_code < 300, answer.get_data(as_text=True)


@contextmanager
def running_provider():
    """Serve a provider on a free port until the end of the block."""
    provider = Provider()
    server = werkzeug.serving.make_server("localhost", 0, provider, threaded=True)
    provider.url = f"http://localhost:{server.server_port}"
    thread = threading.Thread(target=server.serve_forever, args=[0.05])
    thread.start()
    try:
        yield provider
    finally:
        server.shutdown()
        thread.join(60)
        server.server_close()
