"""How users sign in at a provider: a TOML file, and the client's secret beside it."""

import sys
from pathlib import Path

from pydantic import ValidationError

from rtron.errors import InputError, plain_reason
from rtron.service.domain.oidc import OidcConfig

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_HELP = "docs/service.md shows such a file"


def read_oidc_config(path: Path) -> OidcConfig:
    """Read the file; InputError names the line or the key that is wrong."""
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(path), help=_HELP) from None
    except ValueError as error:
        raise InputError(f"it is not TOML: {error}", path=str(path), help=_HELP) from None
    for key in ("client_secret_file", "ca_file"):
        if isinstance(values.get(key), str):
            values[key] = str(path.parent / values[key])
    try:
        return OidcConfig.model_validate(values)
    except ValidationError as error:
        problem = error.errors(include_input=False)[0]
        location = ".".join(map(str, problem["loc"]))
        reason = plain_reason(problem["msg"])
        raise InputError(f"{location}: {reason}", path=str(path), help=_HELP) from None


def read_client_secret(config: OidcConfig) -> str | None:
    """Return the secret of the client, None for a public one; InputError if it cannot be read."""
    if config.client_secret_file is None:
        return None
    path = Path(config.client_secret_file)
    try:
        secret = path.read_text(encoding="utf-8").strip()
    except (OSError, ValueError) as error:
        raise InputError(f"the client's secret: {error}", path=str(path), help=_HELP) from None
    if not secret:
        raise InputError("it holds no secret", path=str(path), help=_HELP)
    return secret
