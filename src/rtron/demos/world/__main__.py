"""`python -m rtron.demos.world SOCKET SPEED`: the simulated world of the case studies.

It serves the device protocol on a Unix socket until SIGINT or SIGTERM.
"""

import asyncio
import logging
import signal
import sys
from contextlib import suppress
from pathlib import Path

from rtron.demos.world.server import WorldServer


async def _serve(path: Path, speed: float) -> None:
    serving = asyncio.ensure_future(WorldServer(speed).run(path))
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, serving.cancel)
    with suppress(asyncio.CancelledError):
        await serving


if __name__ == "__main__":
    logging.basicConfig(format="world: %(message)s", level=logging.WARNING)
    asyncio.run(_serve(Path(sys.argv[1]), float(sys.argv[2])))
