"""The driven base under a guard that is linked to a security service, as their users run them."""

from pathlib import Path

from driven_base import CMD_VEL, CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import NODES, ROS_PYTHON, wait_for

ROBOT = "r1"
OUT = f"/rtron{CMD_VEL}/out"
FLOW1, FLOW2 = (f"/rtron{CMD_VEL}/flow{number}" for number in (1, 2))


def _proc(pid, file):
    return Path(f"/proc/{pid}/{file}").read_text()


def _children(pid):
    return _proc(pid, f"task/{pid}/children").split()


class LinkedApp:
    """The base with its guard; the service is a running one."""

    def __init__(self, ros1, service, plan=None):
        self.ros1, self.service = ros1, service
        self.plan = plan or drive_plan()
        self.driven = Driven(ros1.folder / "driven.txt")
        self.token = service.create_token(ROBOT, "guard", robot=ROBOT)
        self.guard = self.start_guard()
        driver = [ROS_PYTHON, NODES / "driver.py", self.driven.path, "__name:=driver"]
        ros1.spawn(*driver, f"{CMD_VEL}:={OUT}")
        wait_for(lambda: ros1.subscribers(OUT), what="the driver")
        wait_for(self.robot, what="the robot at the service")

    def start_guard(self):
        words = ["--service", self.service.url, "--token-file", self.token, "--robot", ROBOT]
        state = self.ros1.folder / "state"
        return start_guard(self.ros1, self.plan, CMD_VEL_GUARD, *words, "--state-dir", state)

    def navigate(self):
        nav = self.ros1.node("nav.py", "/nav", f"{CMD_VEL}:={FLOW1}")
        wait_for(self.driven.navigation, what="navigation at the driver")
        return nav

    def attack(self, rate=50):
        """Start the approved node that turns rogue."""
        return self.ros1.node("rogue.py", "/rogue", str(rate), f"{CMD_VEL}:={FLOW2}")

    def attack_by_hand(self, rate=50):
        """Start a node that the plan does not know."""
        return self.ros1.node("rogue.py", "/by_hand", str(rate))

    def process(self, name):
        """Return the process of the guard that is called so."""
        (server,) = _children(self.guard.pid)
        named = (pid for pid in _children(server) if _proc(pid, "comm").strip() == name)
        return next(named)

    def rests(self):
        """Tell whether the driver was told to rest last."""
        return all(float(each) == 0 for each in self.driven.messages()[-1])

    def robot(self):
        return self.service.state(ROBOT)

    def stream(self):
        robot = self.robot()
        return (robot["state"]["streams"] or [{}])[0] if robot and robot["state"] else {}

    def events(self, **filters):
        query = "&".join(f"{key}={value}" for key, value in filters.items())
        return self.service.request(f"/api/v1/events?robot={ROBOT}&{query}")["events"]

    def verdicts(self, flow):
        return [each for each in self.events(kind="verdict") if each["flow"] == flow]

    def outcome(self):
        return self.service.request(f"/api/v1/robots/{ROBOT}/settings")

    def change(self, **flows):
        view = self.service.change(ROBOT, {"grcn_cmd_vel": {"flows": flows}})
        wait_for(lambda: self.outcome()["outcome"] != "pending", what="the guard's answer")
        assert self.outcome()["outcome"] == "applied", self.outcome()
        return view["revision"]
