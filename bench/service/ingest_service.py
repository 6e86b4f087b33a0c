"""The security service on SQLite: `python -m bench.service.ingest_service FOLDER ROBOTS`.

Prints a line of JSON, `{"port", "tokens": {robot: token}}`, and serves until it is stopped.
"""

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from rtron.demos.runtime.isolation import free_port
from rtron.service.config import ServiceConfig
from rtron.service.domain.principal import AccessScope
from rtron.service.server.app import create_app
from rtron.service.server.http import serve
from rtron.service.store.accounts.tokens import TokenSpec, create_token
from rtron.service.store.database import Database

FILE = "rtron.db"


def main() -> None:
    """Serve."""
    folder, robots = Path(sys.argv[1]), int(sys.argv[2])
    database = Database(folder / FILE)
    tokens = dict(_tokens(database, robots))
    database.close()
    config = ServiceConfig(database=folder / FILE, port=free_port())
    app = create_app(config)
    server_info = json.dumps({"port": config.port, "tokens": tokens})
    serve(app, config, lambda: print(server_info, flush=True))


def _tokens(database: Database, robots: int) -> Iterator[tuple[str, str]]:
    for robot in (f"robot{index}" for index in range(robots)):
        wish = TokenSpec(name=robot, scopes=[AccessScope.GUARD], robot=robot)
        with database.session() as session:
            yield robot, create_token(session, time.time_ns(), "bench", wish)[1]


if __name__ == "__main__":
    main()
