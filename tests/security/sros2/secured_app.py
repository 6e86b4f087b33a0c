"""An app of ROS 2 under Enforce: a navigation, a driver, and the guard between them."""

import json
import re
from collections import Counter
from datetime import datetime, timezone

from file_tree import write
from harness import wait_for
from ros2_plans import driving, written

from rtron.planning.instrument.ros2.enclaves import ENCLAVE_SCRIPT
from rtron.planning.plan_file.loader import read_plan
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, flow_topic, output_topic
from rtron.workflows.secure import SecureRequest, find_enclaves, secure

NAV, OUT = flow_topic("/cmd_vel", "nav"), output_topic("/cmd_vel")
SPEED, EVIL = "0.5", "9.0"
TWIST = "geometry_msgs/msg/Twist"
GRAPH = InteractionGraph(
    app="robot",
    ros=2,
    endpoints=(
        Endpoint(node="/nav", topic="/cmd_vel", direction=Direction.PUBLISH, type=TWIST),
        Endpoint(node="/driver", topic="/cmd_vel", direction=Direction.SUBSCRIBE, type=TWIST),
    ),
)


class SecuredApp:
    """Files and processes of the app; `environ` is that of whoever has the keystore."""

    def __init__(self, ros2):
        self.ros2 = ros2
        self.plan, self.graph = ros2.folder / "rtron.yaml", ros2.folder / "graph.json"
        self.keystore = ros2.folder / "keystore"
        self.plan.write_text(written(driving("nav")))
        self.graph.write_text(json.dumps(graph_to_json(GRAPH)))
        self.write()
        self.environ = {
            "ROS_SECURITY_ENABLE": "true",
            "ROS_SECURITY_STRATEGY": "Enforce",
            "ROS_SECURITY_KEYSTORE": str(self.keystore),
        }

    def write(self, **more):
        request = SecureRequest(
            plan=self.plan,
            graph=self.graph,
            keystore=self.keystore,
            domain=self.ros2.domain,
            now=datetime.now(timezone.utc),
            **more,
        )
        return secure(request, write=True)

    def node(self, script, *arguments, name, enclave="", environ=None):
        given = environ or self.environ
        override = {"ROS_SECURITY_ENCLAVE_OVERRIDE": enclave or name}
        return self.ros2.node(script, *arguments, name=name, **given, **override)

    def start_script(self):
        """Return the script through which a guarded launch starts each process."""
        enclaves = find_enclaves(self.keystore, self.graph, read_plan(self.plan))
        write(self.ros2.folder, enclaves.texts())
        script = self.ros2.folder / ENCLAVE_SCRIPT
        script.chmod(0o755)
        return script

    def guard(self):
        self.ros2.environ |= self.environ
        guard = self.ros2.rtron("guard", "--plan", self.plan)
        for name in self.environ:
            del self.ros2.environ[name]
        wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, 30, what="the guard")
        assert not guard.ended, guard.log
        return guard

    def driver(self):
        return self.node("twist_subscriber.py", OUT, name="/driver")

    def nav(self, **more):
        return self.node("twist_publisher.py", NAV, SPEED, "50", name="/nav", **more)


def speeds(driver):
    return Counter(re.findall(r"speed (\S+)", driver.log))


def wait_for_commands(driver, number=50):
    """Wait until the driver has heard some more commands of the navigation."""
    before = speeds(driver)[SPEED]
    wait_for(lambda: speeds(driver)[SPEED] > before + number, 30, what="the navigation")
