"""A robot on Zenoh: a router with RTron's configuration, and sessions that come in to it."""

import json
import time
from contextlib import ExitStack
from dataclasses import replace
from datetime import datetime, timedelta, timezone

import zenoh
from harness import free_port
from plans import grcn, plan_of
from rmw_zenoh_keys import data_key

from rtron.security.access.app_access import app_access
from rtron.security.sros2.changes import KeystoreSettings, plan_changes
from rtron.security.sros2.documents import Protection
from rtron.security.sros2.layout import Keystore
from rtron.security.sros2.state import read_state
from rtron.security.sros2.writer import KeystoreWriter
from rtron.security.zenoh.configuration import ZenohRouter
from rtron.security.zenoh.files import ZenohFiles, ZenohSettings
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Endpoint,
    InteractionGraph,
    Node,
    Service,
    ServiceClient,
)

LIMIT_S = 10
DOMAIN = 7
NOW = datetime.now(timezone.utc)
GUARD, NAV, BASE, MAPPER, OPERATOR = "/rtron_guard", "/nav", "/base", "/mapper", "/rtron_operator"
OUTPUT = data_key(DOMAIN, "/rtron/cmd_vel/out")
INPUT = data_key(DOMAIN, "/rtron/cmd_vel/flow1")
ODOM = data_key(DOMAIN, "/odom")
STOP = data_key(DOMAIN, "/base/stop", type="std_srvs::srv::dds_::Trigger_")


def _endpoint(node, topic, direction):
    return Endpoint(node=node, topic=topic, direction=direction)


ROBOT = InteractionGraph(
    app="robot",
    ros=2,
    nodes=tuple(Node(name=name) for name in (NAV, BASE, MAPPER)),
    endpoints=(
        _endpoint(NAV, "/cmd_vel", Direction.PUBLISH),
        _endpoint(BASE, "/cmd_vel", Direction.SUBSCRIBE),
        _endpoint(BASE, "/odom", Direction.PUBLISH),
        _endpoint(NAV, "/odom", Direction.SUBSCRIBE),
        _endpoint(MAPPER, "/map", Direction.PUBLISH),
        _endpoint(NAV, "/map", Direction.SUBSCRIBE),
    ),
    services=(Service(node=BASE, name="/base/stop"),),
    clients=(ServiceClient(node=NAV, name="/base/stop"),),
    actions=(
        Action(node=BASE, name="/dock", role=ActionRole.SERVER),
        Action(node=NAV, name="/dock", role=ActionRole.CLIENT),
    ),
)
PLAN = plan_of(grcn("/cmd_vel", [NAV], [BASE]), app="robot", ros=2)


def until(condition, what):
    """Wait until a condition holds; fail after a limit."""
    limit = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < limit, f"{what} not within {LIMIT_S} s"
        time.sleep(0.005)


class ZenohRobot:
    """A keystore for an app, its router, and sessions of its processes."""

    def __init__(self, folder, **router):
        self.keystore = Keystore(folder / "keystore")
        self.access = app_access(ROBOT, PLAN, operator=True)
        self.router = ZenohRouter(port=free_port(), **router)
        self._sessions = ExitStack()
        self._router_session = None

    def __enter__(self):
        self.write()
        self.start_router()
        return self

    def __exit__(self, *error):
        self._sessions.close()
        self.stop_router()

    def write(self, access=None, **changes):
        """Write the keystore as `rtron secure --zenoh` does, for another app or router if given."""
        self.access = access or self.access
        self.router = replace(self.router, **changes)
        settings = KeystoreSettings(
            domain=DOMAIN, protection=Protection.SIGN, now=NOW, life=timedelta(days=1)
        )
        state = read_state(self.keystore, NOW)
        writer = KeystoreWriter(self.keystore, settings)
        writer.apply(state, plan_changes(state, self.access, settings))
        files = ZenohFiles(self.keystore, self.access, self._settings())
        planned = files.changes(state.identity_ca)
        files.write(planned, writer.identity_authority)
        return planned

    def _settings(self):
        return ZenohSettings(
            router=self.router,
            domain=DOMAIN,
            installed=self.keystore.root,
            now=NOW,
            renewed_before=NOW,
            until=NOW + timedelta(days=1),
        )

    def router_config(self):
        return json.loads((self.keystore.root / "zenoh/router.json5").read_text())

    def start_router(self, **changes):
        self._router_session = zenoh.open(_as_config(self.router_config() | changes))

    def stop_router(self):
        self._router_session.close()

    def restart_router(self, **changes):
        self.stop_router()
        self.start_router(**changes)

    def session_config(self, process):
        return json.loads((self.keystore.folder(process) / "zenoh.json5").read_text())

    def session(self, process):
        """Return the session of one of the app's processes."""
        return self.open(self.session_config(process))

    def open(self, config):
        """Return a session with any configuration; it ends with the robot."""
        session = zenoh.open(_as_config(config))
        self._sessions.callback(session.close)
        return session

    def finish(self, session):
        """End a session, and wait until the router has done with all that it sent."""
        zid = str(session.zid())
        session.close()
        until(lambda: zid not in self._connected(), "the end of the session")

    def wait_for(self, *sessions):
        """Wait until sessions have come in."""
        zids = {str(session.zid()) for session in sessions}
        until(lambda: zids <= self._connected(), "the sessions at the router")

    def _connected(self):
        return {str(transport.zid) for transport in self._router_session.info.transports()}


def without(access, name):
    """Return an app without one of its processes."""
    return replace(access, processes=tuple(each for each in access if each.name != name))


class Driven:
    """A robot whose navigation drives its base through a guard that repeats everything."""

    def __init__(self, robot):
        self.robot = robot
        self.guard, self.nav, self.base = map(robot.session, (GUARD, NAV, BASE))
        self.output = self.guard.declare_publisher(OUTPUT)
        self._input = self.guard.declare_subscriber(INPUT, lambda m: self.output.put(m.payload))
        self.heard = Heard(self.base, OUTPUT)
        self.commands = self.nav.declare_publisher(INPUT)
        self.wait_for_route()

    def wait_for_route(self):
        until(lambda: self.output.matching_status.matching, "the guard's output has a subscriber")
        until(lambda: self.commands.matching_status.matching, "the guard subscribes the flow")

    def drive(self, payload=b"end"):
        """Let a command go through: what the navigation sent before is done with then."""
        self.commands.put(payload)
        until(lambda: payload in self.heard.payloads, f"{payload} at the base")


class Heard:
    """What a session hears under a key: payloads, and None for each delete."""

    def __init__(self, session, key):
        self.payloads = []
        self._subscriber = session.declare_subscriber(key, self._add)

    def _add(self, sample):
        is_put = sample.kind == zenoh.SampleKind.PUT
        self.payloads.append(bytes(sample.payload) if is_put else None)


class Server:
    """A service that a session offers, or says that it does."""

    def __init__(self, session, key, answer):
        self.asked = 0
        self._answer = answer
        self._queryable = session.declare_queryable(key, self._reply, complete=True)

    def _reply(self, query):
        self.asked += 1
        query.reply(STOP, self._answer)


def ask(session, key=STOP):
    """Return all answers to a request, which is made as rmw_zenoh does."""
    replies = session.get(key, target=zenoh.QueryTarget.ALL, payload=b"please", timeout=LIMIT_S)
    return [bytes(reply.ok.payload) for reply in replies if reply.ok]


def _as_config(config):
    return zenoh.Config.from_json5(json.dumps(config))
