"""Guards and people behind HAProxy with the configuration that comes with RTron."""

import asyncio
import json
import os
import shutil
import ssl
import subprocess
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from queue import SimpleQueue
from threading import Thread

import httpx
import pytest
from controller_setup import hello, plan
from harness import free_port, wait_for
from replica_processes import LIMIT_S, create_secret

from rtron.guard.link.audit_heads import HeadsFile
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.service_connection import ServiceConnection
from rtron.guard.link.spool import Spool

GUARDS = 12
CONFIGURATION = Path(__file__).parents[3] / "deploy" / "haproxy.cfg"
_PROGRAM = shutil.which("haproxy", path=f"{os.environ['PATH']}:/usr/sbin")

pytestmark = pytest.mark.skipif(
    _PROGRAM is None, reason="Debian's haproxy is not installed: make setup"
)


class Balancer:
    """HAProxy before two replicas, and a person who trusts its certificate."""

    def __init__(self, replicas, certificate, folder):
        self.ca, key = certificate
        self.url = f"https://localhost:{(port := free_port())}"
        both = folder / "both.pem"
        both.write_text(self.ca.read_text() + key.read_text())
        first, second = (f"127.0.0.1:{each.port}" for each in replicas)
        environ = {"RTRON_FIRST": first, "RTRON_SECOND": second, "RTRON_CERTIFICATE": str(both)}
        self._log = (folder / "haproxy.log").open("w")
        self.process = subprocess.Popen(
            [_PROGRAM, "-db", "-f", CONFIGURATION],
            env=environ | {"RTRON_LISTEN": f"127.0.0.1:{port}"},
            stdout=self._log,
            stderr=self._log,
        )
        self.person = httpx.Client(
            base_url=f"{self.url}/api/v1",
            headers={"Authorization": f"Bearer {replicas.secret}"},
            verify=ssl.create_default_context(cafile=self.ca),
            timeout=LIMIT_S,
        )

    def is_listening(self):
        """Tell whether it takes connections."""
        assert self.process.poll() is None, Path(self._log.name).read_text()
        with suppress(httpx.ConnectError):
            return self.person.get("/me").status_code == 200

    def close(self):
        """End it."""
        self.person.close()
        self.process.terminate()
        self.process.wait(LIMIT_S)
        self._log.close()


@pytest.fixture
def balancer(balanced_replicas, certificate, tmp_path):
    running = Balancer(balanced_replicas, certificate, tmp_path)
    try:
        wait_for(running.is_listening)
        yield running
    finally:
        running.close()


class EchoHandler(BaseHTTPRequestHandler):
    """Answers with the headers that it got."""

    def do_GET(self):
        body = json.dumps({name.lower(): value for name, value in self.headers.items()}).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_arguments):
        """Say nothing."""


class Echoes(list):
    """A backend that stands for both replicas."""

    secret = "nobody's"

    def __init__(self, server):
        super().__init__([server, server])
        self[0].port = server.server_port


@pytest.fixture
def echoes():
    with ThreadingHTTPServer(("127.0.0.1", 0), EchoHandler) as server:
        thread = Thread(target=server.serve_forever, args=[0.05])
        thread.start()
        yield Echoes(server)
        server.shutdown()
        thread.join()


def test_what_a_client_says_of_itself_reaches_no_replica(echoes, certificate, tmp_path):
    balancer = Balancer(echoes, certificate, tmp_path)
    said = {"Client-Cert": ":AAAA:", "X-Forwarded-For": "10.9.9.9", "X-Forwarded-Proto": "http"}
    try:
        wait_for(balancer.is_listening)
        heard = balancer.person.get("/me", headers=said).json()
    finally:
        balancer.close()
    assert "client-cert" not in heard
    assert (heard["x-forwarded-for"], heard["x-forwarded-proto"]) == ("127.0.0.1", "https")


class LinkedGuard:
    """The link process's connection for a robot, and the settings that it gets."""

    def __init__(self, balancer, robot, secret, folder):
        folder.mkdir()
        (folder / "token").write_text(secret)
        self._options = LinkOptions(
            service=balancer.url,
            token_file=folder / "token",
            robot=robot,
            state=folder,
            ca=balancer.ca,
        )
        self.robot, self.stop = robot, None

    async def run(self):
        """Connect, again and again, until it is cancelled."""
        with closing(Spool(self._options.spool_file)) as spool:
            connection = ServiceConnection(
                self._options, spool, self._take_settings, HeadsFile(self._options.audit_heads_file)
            )
            connection.announce(hello(plan(), app="app"))
            await connection.run()

    def _take_settings(self, message):
        self.stop = message.settings.stop


@contextmanager
def linked(guards):
    """Let guards connect until the end of the block."""
    loops = SimpleQueue()

    async def run_all():
        ending = asyncio.Event()
        tasks = [asyncio.create_task(guard.run()) for guard in guards]
        loops.put((asyncio.get_running_loop(), ending))
        await ending.wait()
        for task in tasks:
            task.cancel()
        results = await asyncio.gather(*tasks, return_exceptions=True)
        assert all(isinstance(each, asyncio.CancelledError) for each in results)

    with ThreadPoolExecutor(1) as thread:
        running = thread.submit(asyncio.run, run_all())
        loop, ending = loops.get(timeout=LIMIT_S)
        try:
            yield
        finally:
            loop.call_soon_threadsafe(ending.set)
        running.result(LIMIT_S)


@pytest.fixture
def guards(balanced_replicas, balancer, tmp_path):
    linked_guards = []
    for robot in (f"robot{number}" for number in range(GUARDS)):
        secret = create_secret(balanced_replicas.database, robot, "guard", robot=robot)
        linked_guards.append(LinkedGuard(balancer, robot, secret, tmp_path / robot))
    return linked_guards


def connections(replica, secret):
    """Return how many guards are connected to a replica."""
    answer = httpx.get(f"{replica.url}/metrics", headers={"Authorization": f"Bearer {secret}"})
    return int(float(answer.text.split("\nrtron_guards_connected ")[1].split()[0]))


def test_guards_of_a_killed_replica_go_to_the_other_and_stops_reach_them(
    balanced_replicas, balancer, guards
):
    killed, other = balanced_replicas
    secret = balanced_replicas.secret
    with linked(guards):
        wait_for(lambda: connections(killed, secret) + connections(other, secret) == GUARDS)
        assert min(connections(each, secret) for each in (killed, other)) > 0
        killed.kill()
        wait_for(lambda: connections(other, secret) == GUARDS)
        for guard in guards:
            answer = balancer.person.post(f"/robots/{guard.robot}/stop", json={"reason": "kill"})
            assert answer.json()["connected"]
        wait_for(lambda: all(guard.stop for guard in guards))
