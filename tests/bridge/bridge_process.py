"""`rtron bridge` as a process, beside a ROS of the test's own, and clients that are processes."""

import json
import re
import sys
from pathlib import Path

from file_tree import write
from harness import LIMIT_S, wait_for
from websockets.sync.client import connect

from rtron.bridge.rights.tokens import token_hash

CLIENT = Path(__file__).parent / "nodes" / "roslibpy_client.py"
PLAN = """
schema: rtron.plan/1
app: demo
ros: {ros}
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/Twist
    domain: Control
    kind: command
    sharing: contend
    mode: enforce
    policy: Preemption
    successors: [/driver]
    flows:
      - {{name: nav, publisher: /nav, priority: 1}}
      - {{name: web, publisher: /bridge/web, priority: 2}}
"""
RIGHTS = f"""
schema: rtron.bridge/1
max_clients: 200
clients:
  - name: web
    tokens: ["{token_hash("web")}"]
    publish:
      - {{topic: /cmd_vel, type: geometry_msgs/Twist, rate: 50}}
      - {{topic: /chat, type: std_msgs/String}}
    subscribe:
      - {{topic: /cmd_vel, type: geometry_msgs/Twist, rate: 100}}
      - {{topic: /chat, type: std_msgs/String}}
    call:
      - {{service: /driver/set_logger_level, type: roscpp/SetLoggerLevel}}
      - {{service: /lamp, type: std_srvs/SetBool, rate: 10}}
      - {{service: /nobody, type: std_srvs/SetBool}}
    parameters: {{read: ["/nav/*", "/lamp:*"], write: [/nav/speed, "/lamp:speed"]}}
    limits: {{call_timeout: 5}}
  - name: screen
    tokens: ["{token_hash("screen")}"]
    subscribe:
      - {{topic: /chat, type: std_msgs/String}}
"""
LEASED_PLAN = PLAN.replace("policy: Preemption", "policy: Lease\n    lease: base").replace(
    "grcn:", "leases:\n  - {{name: base, ttl: 60 s}}\ngrcn:", 1
)
LEASED_PLAN = LEASED_PLAN.replace("priority: 1", "rank: autonomy").replace(
    "priority: 2", "rank: remote_operator"
)
LEASED_RIGHTS = f"""
schema: rtron.bridge/1
clients:
  - name: web
    tokens: ["{token_hash("web")}"]
    publish:
      - {{topic: /cmd_vel, type: geometry_msgs/Twist, rate: 50}}
      - {{topic: /rtron/leases/base/request, type: std_msgs/String}}
"""
SERVICES = {
    "roscpp/srv/SetLoggerLevel.srv": "string logger\nstring level\n---\n",
    "std_srvs/srv/SetBool.srv": "bool data\n---\nbool success\nstring message\n",
}
_LISTENS = re.compile(r"listens at ws://127\.0\.0\.1:(\d+)/")


class BridgeProcess:
    """A bridge of the test's own; its clients end with the ROS that they were started in."""

    def __init__(self, ros, generation, rights=RIGHTS, plan=PLAN, services=SERVICES):
        self.ros = ros
        self.plan = ros.folder / "rtron.yaml"
        self.rights = ros.folder / "bridge.yaml"
        self.plan.write_text(plan.format(ros=generation))
        self.rights.write_text(rights)
        write(ros.folder, services)
        files = ("--plan", self.plan, "--rights", self.rights)
        self.process = ros.rtron("bridge", *files, "--port", "0")
        wait_for(lambda: _LISTENS.search(self.log) or self.process.ended, what="the bridge")
        assert not self.process.ended, self.log
        self.port = int(_LISTENS.search(self.log)[1])

    @property
    def log(self):
        return self.process.log

    def client(self, token, *what):
        """Start a client with roslibpy."""
        process = self.ros.spawn(sys.executable, CLIENT, self.port, token, *what)
        wait_for(lambda: "connected" in process.log or process.ended, what="roslibpy")
        assert "connected" in process.log, process.log + self.log
        return process

    def connect(self, token):
        """Return a WebSocket of this process, signed in."""
        address = f"ws://127.0.0.1:{self.port}/?token={token}"
        return connect(address, compression=None, proxy=None, max_queue=None)

    def guard(self):
        """Start a guard with the plan of the bridge."""
        return self.ros.rtron("guard", "--plan", self.plan)


def hear_until(socket, is_it):
    """Return the first frame that is the right one."""
    while not is_it(frame := json.loads(socket.recv(LIMIT_S))):
        pass
    return frame


def acquire_at_once(bridge):
    """Ask for a lease in the first frame, and wait until the guard grants it."""
    guard = bridge.guard()
    wait_for_word(guard, "guarding 1 topics")
    with bridge.connect("web") as web:
        request = {"op": "publish", "topic": "/rtron/leases/base/request"}
        web.send(json.dumps(request | {"msg": {"data": "acquire at once"}}))
        wait_for_word(guard, "acquire by /bridge/web: base is granted to /bridge/web")


def drive_unheard(bridge):
    """Drive where no guard is; return what the client is told."""
    with bridge.connect("web") as web:
        web.send(json.dumps({"op": "publish", "topic": "/cmd_vel", "msg": {"linear": {"x": 0.3}}}))
        return hear_until(web, lambda frame: frame.get("level") == "error")["msg"]


def wait_for_word(process, word):
    """Wait until a process says a word; return all that it has said."""
    wait_for(lambda: word in process.log or process.ended, what=f"{word!r} of {process.program}")
    assert word in process.log, process.log
    return process.log
