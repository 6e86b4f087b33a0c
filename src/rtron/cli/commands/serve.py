"""`rtron serve`."""

import gc
import logging
import re
import sys
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.commands.audit import AuditDirOption
from rtron.cli.commands.guard import LogLevel
from rtron.cli.commands.user import RoleOption
from rtron.cli.support.outcome import Outcome
from rtron.cli.support.service_database import (
    DEFAULT_DATABASE,
    DatabaseOption,
    prepare_database,
    require_service_packages,
)
from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.service.config import ServiceConfig, Tls

_MIB = 1 << 20


def serve(  # noqa: PLR0913 - one for each option
    *,
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="The address to listen on; 0.0.0.0 is all.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(metavar="N", help="The port to listen on.")] = 8600,
    database: DatabaseOption = DEFAULT_DATABASE,
    tls_cert: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The certificate and its chain, PEM.")
    ] = None,
    tls_key: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The certificate's private key, PEM.")
    ] = None,
    client_ca: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Guards show a certificate of this authority, PEM."),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Accept requests for this host name; can be repeated."),
    ] = None,
    proxy: Annotated[
        list[str] | None,
        typer.Option(metavar="ADDRESS", help="Trust this reverse proxy, which terminates TLS."),
    ] = None,
    insecure_http: Annotated[
        bool, typer.Option("--insecure-http", help="Listen on other addresses without TLS.")
    ] = False,
    oidc: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Users sign in at the OpenID provider of this file too."),
    ] = None,
    require_code: Annotated[
        list[RoleOption] | None,
        typer.Option(help="Users of this role log in with a one-time code; can be repeated."),
    ] = None,
    four_eyes: Annotated[
        bool, typer.Option("--four-eyes", help="A second admin approves what gives rights.")
    ] = False,
    audit_dir: AuditDirOption = None,
    heads_every: Annotated[
        float, typer.Option(metavar="SECONDS", help="How often the audit log is signed.")
    ] = 60.0,
    keep_days: Annotated[float, typer.Option(metavar="DAYS", help="Delete older events.")] = 30.0,
    keep_mb: Annotated[int, typer.Option(metavar="MB", help="The disk space for events.")] = 4096,
    log_level: Annotated[LogLevel, typer.Option(help="How much to log.")] = LogLevel.INFO,
) -> Outcome:
    r"""Run the security service: collector of the guards, API and console.

    Without options it serves this machine only, with a database of yours below
    ~/.local/state. It says where the database is.

    $ rtron serve
    $ rtron serve --database /var/lib/rtron/rtron.db
    $ rtron serve --database postgresql://rtron@db/rtron
    $ rtron serve --host 0.0.0.0 --allow-host robots.example.org \
          --tls-cert cert.pem --tls-key key.pem

    The first start creates the user admin and shows the password once. Each
    guard needs a token:

    $ rtron token create car1 --scope guard --robot car1 --token-file car1.token
    $ rtron guard --plan rtron.yaml --service http://127.0.0.1:8600 \
          --robot car1 --token-file car1.token

    Ctrl-C ends it; guards keep their last settings.

    Exit code: 0 ended, 2 bad options, port in use, or another service uses the
    database.
    """
    require_service_packages()
    _load_service()
    from rtron.service.config import ServiceConfig
    from rtron.service.domain.principal import UserRole
    from rtron.service.server.oidc_setup import read_oidc_config
    from rtron.service.store.retention import RetentionLimits

    _configure_logging(log_level)
    config = ServiceConfig(
        database=prepare_database(database),
        audit_dir=audit_dir,
        heads_interval_s=heads_every,
        host=host,
        port=port,
        tls=_tls_config(tls_cert, tls_key),
        client_ca=client_ca,
        allowed_hosts=tuple(allow_host or ()),
        proxies=tuple(proxy or ()),
        allow_insecure_http=insecure_http,
        oidc=read_oidc_config(oidc) if oidc else None,
        four_eyes=four_eyes,
        second_factor_roles=frozenset(UserRole(each.value) for each in require_code or ()),
        retention=RetentionLimits(max_days=keep_days, max_bytes=keep_mb * _MIB),
    )
    _run_service(config)
    return Outcome("")


def _load_service() -> None:
    """Load what serves; the search for garbage, of which there is none, took an eighth of it."""
    gc.disable()
    try:
        import rtron.service.server.app
        import rtron.service.server.http
        import rtron.service.server.oidc_setup  # noqa: F401 - `serve` imports from them
    finally:
        gc.freeze()
        gc.enable()


def _configure_logging(level: LogLevel) -> None:
    """Log to standard error; httpx would tell whole URLs, and a webhook's may hold a secret."""
    from rtron.guard.log_format import start_logging

    start_logging(level.value.upper())
    for name in ("httpx", "httpcore", "alembic"):
        logging.getLogger(name).setLevel(logging.WARNING)


def _run_service(config: "ServiceConfig") -> None:
    from rtron.service.server.app import create_app
    from rtron.service.server.database_setup import add_first_admin, hold_instance_lock
    from rtron.service.server.http import serve as run

    with hold_instance_lock(config.database):
        app = create_app(config)
        service = app.state.service

        def ready() -> None:
            _print_address(config, add_first_admin(service.database, service.clock()))

        with closing(service.database):
            run(app, config, ready)


def _print_address(config: "ServiceConfig", password: str | None) -> None:
    scheme = "https" if config.tls else "http"
    host = f"[{config.host}]" if ":" in config.host else config.host
    sys.stderr.write(f"RTron security service: {scheme}://{host}:{config.port}/\n")
    sys.stderr.write(f"database: {_without_password(str(config.database))}\n")
    if password:
        sys.stderr.write(f"first start: log in as admin with the password {password}\n")
        sys.stderr.write("it is shown this once; change it in the console\n")
    if not (config.is_local or config.allowed_hosts):
        sys.stderr.write(
            f"it answers only to the names {', '.join(sorted(config.host_names))}: "
            "give the name that others call it by with --allow-host\n"
        )
    if not (config.is_local or config.tls):
        sys.stderr.write(
            "WARNING: no TLS: whoever is on the network between can read passwords and tokens, "
            "and steer the robots with them\n"
        )


def _without_password(location: str) -> str:
    """Return a database's address without the password that a URL may have."""
    return re.sub(r"(//[^:/@]*):[^@]*@", r"\1@", location)


def _tls_config(cert: Path | None, key: Path | None) -> "Tls | None":
    from rtron.service.config import Tls

    if cert and key:
        return Tls(cert=cert, key=key)
    if cert or key:
        help = "give --tls-cert and --tls-key"
        raise InputError("TLS needs a certificate and its key", help=help)
    return None
