"""A guarded robot with a bridge, an agent at `rtron mcp`, one that goes past it, and a person."""

import asyncio
import json
import os
import re
import sys
import time
from contextlib import AsyncExitStack, ExitStack, suppress
from pathlib import Path

from agent_plan import AGENT, PERSON, PLAN, RIGHTS, ROGUE, SPEED, TURN
from harness import LIMIT_S, SOURCE, WaitLimit, wait_for
from mcp import Client
from mcp.client.stdio import StdioServerParameters
from memory_bridge import hear, say
from websockets.sync.client import connect

from rtron.bridge.agents.agent_commands import AgentCommands
from rtron.bridge.agents.app_client import AppClient
from rtron.bridge.common.message_types import MessageTypes
from rtron.cli.support.control_request import send_request
from rtron.errors import InputError
from rtron.messages.ros1.service_types import find_interface_text
from rtron.planning.plan_file.loader import parse_plan
from rtron.vocabulary import Mode, Stream

ROBOT = Path(__file__).parent / "nodes" / "robot.py"
REQUEST = "/rtron/leases/base/request"
KITCHEN = (2.0, 4.0)
_LISTENS = re.compile(r"listens at ws://127\.0\.0\.1:(\d+)/")
_ROUNDING = 1e-6
_PAUSE_S = 0.02


PLACE = Stream(
    topic="/place",
    type="geometry_msgs/Pose2D",
    mode=Mode.OBSERVE,
    flows=(),
    stages=(),
    successors=(),
)


class AgentWorld:
    """What a sequence acts on; `async with` connects the agents and the person."""

    def __init__(self, ros, folder):
        self.told = folder / "told"
        self.control = Path(os.environ["XDG_RUNTIME_DIR"]) / "agents.sock"
        self.plan, rights = folder / "rtron.yaml", folder / "bridge.yaml"
        self.plan.write_text(PLAN)
        rights.write_text(RIGHTS)
        self.guard = ros.rtron("guard", "--plan", self.plan, "--control-socket", self.control)
        files = ("--plan", self.plan, "--rights", rights)
        self.bridge = ros.rtron("bridge", *files, "--port", "0")
        remaps = ("/cmd_vel:=/rtron/cmd_vel/out", "/goal:=/rtron/goal/out")
        ros.spawn("/usr/bin/python3", ROBOT, self.told, "__name:=robot", *remaps)
        wait_for(lambda: _LISTENS.search(self.bridge.log), what="the bridge")
        wait_for(lambda: ros.subscribers("/rtron/cmd_vel/out"), what="the robot")
        wait_for(lambda: ros.publishers("/rtron/cmd_vel/out"), what="the guard")
        self.address = f"ws://127.0.0.1:{_LISTENS.search(self.bridge.log)[1]}/"

    async def __aenter__(self):
        self._stack = AsyncExitStack()
        plan = parse_plan(PLAN)
        types = MessageTypes(plan, find_interface_text)
        self.person = AppClient(plan, PERSON, types, self.address, "person")
        await self.person.open()
        self._stack.push_async_callback(self.person.close)
        self.person_commands = AgentCommands(self.person)
        self._rogue_stack = ExitStack()
        self.connect_rogue()
        variables = {"RTRON_BRIDGE_TOKEN": "agent", "PYTHONPATH": str(SOURCE)}
        arguments = ("rtron", "mcp", str(self.plan), "--name", "agent", "--bridge", self.address)
        server = StdioServerParameters(
            command=sys.executable, args=["-m", *arguments], env=variables
        )
        self.agent = await self._stack.enter_async_context(Client(server))
        return self

    async def __aexit__(self, *_):
        self._rogue_stack.close()
        await self._stack.aclose()

    async def tool(self, name, *, paced=True, **arguments):
        """Call a tool as the agent; slower, if it is told to, unless it is not `paced`."""
        while True:
            result = await self.agent.call_tool(name, arguments)
            text = result.content[0].text if result.content else ""
            answer = {"ok": False, "reason": text} if result.is_error else json.loads(text)
            if not paced or answer.get("rule") != "rate of calls":
                return answer
            await asyncio.sleep(_PAUSE_S * 10)

    def connect_rogue(self):
        """Connect the agent that goes past `rtron mcp`; the bridge may have sent it away."""
        self._rogue_stack.close()
        address = f"{self.address}?token=rogue"
        options = {"compression": None, "proxy": None, "max_queue": None, "open_timeout": LIMIT_S}
        wait_for(lambda: self._try_connect(address, options), what="a connection")

    def _try_connect(self, address, options):
        with suppress(Exception):
            self.rogue = self._rogue_stack.enter_context(connect(address, **options))
            return True
        return False

    def raw(self, op, **fields):
        """Send a frame past `rtron mcp`."""
        with suppress(Exception):
            say(self.rogue, op, **fields)

    def raw_text(self, text):
        with suppress(Exception):
            self.rogue.send(text)

    def publish(self, topic, type, message, **more):
        self.raw("publish", topic=topic, type=type, msg=message, **more)

    def drive_raw(self, speed=0.1, times=5):
        """Publish velocities past `rtron mcp`, one that is neutral before."""
        for value in (0.0, *[speed] * times):
            self.publish("/cmd_vel", "geometry_msgs/Twist", {"linear": {"x": value}})

    def ask_raw(self, text):
        self.publish(REQUEST, "std_msgs/String", {"data": text})

    async def take_raw(self):
        """Let the rogue have the lease."""
        for _ in range(20):
            self.ask_raw("acquire to drive")
            with suppress(AssertionError):
                await self.until(lambda: self.holder == ROGUE, limit_s=1)
                return
        raise AssertionError("the rogue gets no lease")

    @property
    def holder(self):
        return self.person.report.holder("base")

    def control_guard(self, **request):
        """Ask the guard as a person beside the robot."""
        return send_request(self.control, request)

    async def place(self, x, y):
        """Put the robot somewhere, and wait until the guard knows."""
        blocks = KITCHEN[0] <= x <= KITCHEN[1] and KITCHEN[0] <= y <= KITCHEN[1]
        stands = {"x": x, "y": y, "theta": 0.0}
        while self._rule("stay_put") is not blocks:
            await self.person.publish(PLACE, stands)
            await self.person.wait_for_report(1)

    def _rule(self, name):
        return self.person.report.rule_blocks(name, time.monotonic_ns())

    async def until(self, condition, limit_s=LIMIT_S):
        limit = WaitLimit(limit_s=limit_s)
        while not condition():
            limit.check()
            await asyncio.sleep(_PAUSE_S)

    async def settle(self):
        """Wait until bridge and guard have seen all that was sent."""
        with suppress(Exception):
            say(self.rogue, "call_service", service="/rosapi/get_time", id="barrier")
            while hear(self.rogue).get("id") != "barrier":
                pass
        assert await self.person.wait_for_report(LIMIT_S, "/cmd_vel")

    async def calm(self):
        """Bring everything to rest: no leases, no stop, the robot at its place."""
        await self.tool("stop")
        for source in self.control_guard(release="", reason="")["stops"]:
            await self.until(lambda source=source: self._is_released(source))
        while self.holder:
            with suppress(InputError):
                self.control_guard(lease="base", do="end", to="", reason="the next sequence")
            with suppress(AssertionError):
                await self.until(lambda: not self.holder, limit_s=0.5)
        self.connect_rogue()
        await self.place(0.0, 0.0)
        await self.until(self._is_at_rest)

    def _is_released(self, source):
        with suppress(InputError):
            self.control_guard(release=source, reason="the next sequence")
            return True
        return False

    def _is_at_rest(self):
        moves = [each["velocity"] for each in self.lines() if "velocity" in each]
        return not moves or not any(moves[-1])

    def lines(self):
        """Return all that has reached the robot."""
        text = self.told.read_text() if self.told.exists() else ""
        return [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]


def is_forbidden(line, *, may_move):
    """Tell whether what reached the robot never should have: whatever the policies say of it."""
    if "chat" in line:  # nobody has approved any
        return True
    if "goal" in line:
        return all(KITCHEN[0] <= each <= KITCHEN[1] for each in line["goal"])
    ahead, side, turn = line["velocity"]
    is_within = abs(ahead) + abs(side) <= SPEED + _ROUNDING and abs(turn) <= TURN + _ROUNDING
    return not is_within or (not may_move and any(line["velocity"]))


__all__ = ["AGENT", "PERSON", "ROGUE", "AgentWorld", "is_forbidden"]
