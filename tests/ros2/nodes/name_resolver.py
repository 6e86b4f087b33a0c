"""Prints what some names of a node resolve to, in the node's process with its ROS arguments.

`--component RULE…` are the rules of a load request, which a component gets as its own arguments.
"""

import json
import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


def main():
    cut = sys.argv.index("--component") if "--component" in sys.argv else len(sys.argv)
    flags = [word for rule in sys.argv[cut + 1 :] for word in ("-r", rule)]
    rclpy.init(args=sys.argv[:cut])
    own = {"cli_args": ["--ros-args", *flags], "use_global_arguments": False} if flags else {}
    node = Node("teleop", **own)
    found = {}
    for name in ("out", "/cmd_vel", "~/out"):
        found[name] = node.create_publisher(String, name, 1).topic_name
    clients = [node.create_client(Trigger, "/go/_action/send_goal")]
    names = node.get_client_names_and_types_by_node(node.get_name(), node.get_namespace())
    found["client"] = [name for name, _ in names if "_action" in name]
    print(json.dumps(found), flush=True)
    del clients


main()
