"""Clients, plans and sessions for the tests of the bridge."""

import json
from functools import partial

from rtron.bridge.common.message_types import MessageTypes
from rtron.bridge.common.plan_topics import PlanTopics
from rtron.bridge.protocol import effects
from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.protocol.client_state import ClientRates
from rtron.bridge.protocol.session import ClientSession
from rtron.bridge.rights.document import BridgeRights
from rtron.bridge.rights.rights_file import parse_rights
from rtron.bridge.rights.tokens import token_hash
from rtron.errors import SourceError
from rtron.planning.plan_file.loader import parse_plan
from rtron.vocabulary import SECOND

WALL = 1_700_000_000 * SECOND
TOKEN = "rtb_web"
SET_BOOL = "bool data\n---\nbool success\nstring message\n"
PLAN = """
app: demo
ros: {ros}
grcn:
  - id: gr_base
    topic: /cmd_vel
    type: geometry_msgs/Twist
    domain: Control
    kind: command
    sharing: contend
    mode: enforce
    policy: Preemption
    flows:
      - {{name: nav, publisher: /nav, priority: 1}}
      - {{name: web, publisher: /bridge/web, priority: 2}}
    successors: [/base]
"""
RIGHTS = """
schema: rtron.bridge/1
origins: ["https://robot.example"]
clients:
  - name: web
    tokens: ["{token}"]
    publish:
      - {{topic: /cmd_vel, type: geometry_msgs/Twist, rate: 10}}
      - {{topic: /chat, type: std_msgs/String, rate: 10}}
    subscribe:
      - {{topic: /odom, type: nav_msgs/Odometry, rate: 10}}
      - {{topic: /chat, type: std_msgs/String, rate: 100}}
    call:
      - {{service: /lamp, type: std_srvs/SetBool, rate: 5}}
    parameters: {{read: ["/nav/*"], write: [/nav/speed]}}
    limits: {{frames: 100, bytes: 100000, message: 10000, queue: 5, calls: 2, call_timeout: 3}}
  - name: screen
    tokens: ["{other}"]
    subscribe:
      - {{topic: /chat, type: std_msgs/String}}
    limits: {{message: 10000}}
"""


def plan(ros=1):
    return parse_plan(PLAN.format(ros=ros))


def rights(text=RIGHTS) -> BridgeRights:
    return parse_rights(text.format(token=token_hash(TOKEN), other=token_hash("rtb_screen")))


def interface_text(type, kind):
    if (type, kind) == ("a/Dock", "action"):
        return "int32 berth\n---\nbool docked\n---\nfloat32 distance\n"
    if type != "std_srvs/SetBool":
        raise SourceError(f"the service type {type} is not installed here")
    return SET_BOOL


def types(known):
    return MessageTypes(known, interface_text)


class Talk:
    """A session, and a clock that the test moves."""

    def __init__(self, name="web", text=RIGHTS, ros=1):
        known = plan(ros)
        client = next(each for each in rights(text).clients if each.name == name)
        self.types = types(known)
        self.approvals = Approvals()
        self._open = partial(
            ClientSession, client, PlanTopics(known), self.types, ros, ClientRates(), self.approvals
        )
        self.session = self._open()
        self.now = 1000 * SECOND

    def come_again(self):
        """Leave, and sign in once more."""
        self.session = self._open()

    def say(self, op, **fields):
        """Send a frame, and return what is decided."""
        return self.send(json.dumps({"op": op, **fields}))

    def send(self, text):
        return self.session.receive(text, self.now, WALL)

    def wait(self, seconds):
        """Let time pass, and return what is decided then."""
        self.now += int(seconds * SECOND)
        return self.session.tick(self.now)

    def deliver(self, topic, message):
        return self.session.deliver(topic, message, self.now)

    def refusal(self, op, **fields):
        """Send a frame that is refused, and return the reason."""
        return reason(self.say(op, **fields))


def frames(decided):
    """Return the frames that a client gets."""
    texts = []
    for each in decided:
        if isinstance(each, effects.SendAnswer):
            texts.append(each.text)
        elif isinstance(each, effects.SendMessage):
            texts += each.frames
    return [json.loads(text) for text in texts]


def reason(decided):
    """Return the reason of the one refusal, which is all that is decided but an answer."""
    statuses = [each for each in frames(decided) if each["op"] == "status"]
    assert [each["level"] for each in statuses] == ["error"]
    others = [each for each in decided if not isinstance(each, effects.SendAnswer)]
    assert others == []
    return statuses[0]["msg"]
