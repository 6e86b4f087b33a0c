"""For each rule a graph that has its finding, and a similar one that has not."""

from dataclasses import replace

from finding_graphs import BASE, MUX, STAMPED, TWIST, TWO_DRIVERS, parameters, small_graph, with_qos

from rtron.vocabulary import (
    Durability,
    QoS,
    Reliability,
    Resolution,
    Service,
    ServiceClient,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)

RELIABLE = QoS()
BEST_EFFORT = QoS(reliability=Reliability.BEST_EFFORT)
SCAN = """
/laser driver third_party
    pub /scan sensor_msgs/msg/LaserScan
/slam slam own
    sub /scan sensor_msgs/msg/LaserScan
"""

MANAGER = "/manager nav2_lifecycle_manager third_party\n"
MANAGED = ServiceClient(node="/manager", name="/amcl/change_state")
SAVE = (ServiceClient(node="/slam", name="/save_map"),)

ODOMETRY = """
/ekf ekf own
    pub /odometry/filtered nav_msgs/msg/Odometry
/nav nav own
    sub /odometry/{} nav_msgs/msg/Odometry
"""

FILTERED = (
    SCAN.partition("/slam")[0]
    + """
/filter filter own
    sub /scan sensor_msgs/msg/LaserScan
    pub /scan_filtered sensor_msgs/msg/LaserScan
/slam slam own
    sub {} sensor_msgs/msg/LaserScan
"""
)

STOP = """
/board board own
    pub /hardware/stop_state std_msgs/msg/Bool
/pad pad own
    sub /hardware/stop_state std_msgs/msg/Bool
"""
LATCHED = QoS(durability=Durability.TRANSIENT_LOCAL)


def latched_state(requested: QoS, text: str = STOP, topic: str = "/hardware/stop_state"):
    """Return a graph in which /board latches a state, sends it seldom, and others read it."""
    kind = WiringFactKind.STATE_PUBLISHER
    fact = WiringFact(kind=kind, subject=topic, value="/board")
    return with_qos(small_graph(text, wiring=(fact,)), LATCHED, requested)


LOOP = f"""
/wheels wheels own
    pub /odom nav_msgs/msg/Odometry
/ekf robot_localization third_party
    sub /odom nav_msgs/msg/Odometry
    pub /odom/fused nav_msgs/msg/Odometry
/controller nav2_controller own
    sub {{}} nav_msgs/msg/Odometry
    pub /cmd_vel_raw {TWIST}
/smoother nav2_velocity_smoother own
    sub /cmd_vel_raw {TWIST}
    sub {{}} nav_msgs/msg/Odometry
    pub /cmd_vel {TWIST}
"""

GOALS = """
/mission mission own
    client /navigate_to_pose nav2_msgs/action/NavigateToPose
/goals goals own
    client {} nav2_msgs/action/NavigateToPose
"""


def with_resolution(graph, resolution):
    ends = tuple(replace(end, resolution=resolution) for end in graph.endpoints)
    return replace(graph, endpoints=ends)


def _with_missing(program: str):
    note = UnresolvedItem(what="node /slam (slam/slam)", why="no source of it", missing=program)
    return small_graph(SCAN, unresolved=(note,))


def with_fact(kind: str, subject: str, value: str = "", *others: str):
    """Return a graph with a fact about its wiring."""
    fact = WiringFact(kind=WiringFactKind(kind), subject=subject, value=value, others=others)
    return small_graph(SCAN, wiring=(fact,))


PAIRS = {
    "several_publishers": (
        small_graph(TWO_DRIVERS + BASE),
        small_graph(TWO_DRIVERS.replace("/cmd_vel", "/chatter").replace(TWIST, "a_msgs/msg/B")),
    ),
    "network_bridge": (
        small_graph("/bridge rosbridge_server third_party"),
        small_graph("/bridge my_server own"),
    ),
    "command_timeout": (
        small_graph(BASE, parameters=parameters("cmd_vel_timeout", base=0.0)),
        small_graph(BASE, parameters=parameters("cmd_vel_timeout", base=0.5)),
    ),
    "open_command": (small_graph(BASE), small_graph(BASE + f"/nav nav own\n pub /cmd_vel {TWIST}")),
    "lost_command": (
        small_graph(BASE.replace("/cmd_vel", "/base/cmd_vel") + TWO_DRIVERS),
        small_graph(BASE + TWO_DRIVERS),
    ),
    "power_command": (
        small_graph("/power pkg own\n    sub /system/shutdown std_msgs/msg/Empty"),
        small_graph("/power pkg own\n    sub /system/status std_msgs/msg/Empty"),
    ),
    "type_mismatch": (
        small_graph(BASE + f"/nav nav own\n pub /cmd_vel {STAMPED}"),
        small_graph(BASE + "/nav nav own\n pub /cmd_vel geometry_msgs/Twist"),
    ),
    "qos_mismatch": (
        with_qos(small_graph(SCAN), BEST_EFFORT, RELIABLE),
        with_qos(small_graph(SCAN), RELIABLE, BEST_EFFORT),
    ),
    "missed_state": (latched_state(RELIABLE), latched_state(LATCHED)),
    "unmatched_topic": (
        small_graph(ODOMETRY.format("filterd")),
        small_graph(ODOMETRY.format("filtered")),
    ),
    "no_server": (
        small_graph(SCAN, clients=SAVE, services=(Service(node="/laser", name="/save_maps"),)),
        small_graph(SCAN, clients=SAVE, services=(Service(node="/laser", name="/save_map"),)),
    ),
    "incomplete_launch": (small_graph(SCAN, clients=SAVE), small_graph(SCAN)),
    "missing_managed_node": (
        small_graph(MANAGER, clients=(MANAGED,)),
        small_graph(MANAGER + "/amcl nav2_amcl third_party\n", clients=(MANAGED,)),
    ),
    "missing_program": (_with_missing("slam/slam"), _with_missing("")),
    "duplicate_node": (with_fact("duplicate_node", "/base"), small_graph(SCAN)),
    "idle_remap": (with_fact("idle_remap", "/a", "/b", "/base"), small_graph(SCAN)),
    "unreached_listener": (
        with_fact("unreached_listener", "/left/tool", "/left/tf", "/tf"),
        small_graph(SCAN),
    ),
    "unread_parameter": (
        with_fact("misspelt_parameter", "/base", "max_v", "max_vel"),
        small_graph(SCAN),
    ),
    "mistyped_parameter": (
        with_fact("mistyped_parameter", "/base", "max_vel", "double", "integer"),
        small_graph(SCAN),
    ),
    "topic_parameter": (
        with_fact("topic_parameter", "/a/path_topic", "/c/path", "/b/path"),
        small_graph(SCAN),
    ),
    "bypassed_node": (
        small_graph(FILTERED.format("/scan")),
        small_graph(FILTERED.format("/scan_filtered")),
    ),
    "mixed_odometry": (
        small_graph(LOOP.format("/odom/fused", "/odom")),
        small_graph(LOOP.format("/odom/fused", "/odom/fused")),
    ),
    "shared_output": (
        with_fact("shared_output", "/image", "", "/left", "/right"),
        with_fact("shared_output", "/cmd_vel", "", "/left", "/right"),
    ),
    "double_frame": (
        with_fact("double_frame", "base_link", "odom", "/ekf", "/base"),
        small_graph(SCAN),
    ),
    "missing_plugin": (
        with_fact("missing_plugin", "/planner_id/Grid", "/planner_server", "Straight"),
        small_graph(SCAN),
    ),
    "leaked_argument": (
        with_fact("leaked_argument", "topic", "front/scan", "rear.xml", "front.xml", "rear/scan"),
        small_graph(SCAN),
    ),
    "undeclared_argument": (
        with_fact("undeclared_argument", "file", "map_file", "/l/map.xml"),
        small_graph(SCAN),
    ),
    "bridge_mismatch": (
        with_fact("bridge_mismatch", "/model/bot/cmd_vel", "/cmd_vel", "/bridge"),
        small_graph(SCAN),
    ),
    "frame_loop": (with_fact("frame_loop", "base", "odom", "/ekf"), small_graph(SCAN)),
    "stray_frame": (with_fact("stray_frame", "laser_1", "laser", "/laser"), small_graph(SCAN)),
    "sim_time": (
        small_graph(SCAN, parameters=parameters("use_sim_time", laser=True, slam=False)),
        small_graph(SCAN, parameters=parameters("use_sim_time", laser=True, slam=True)),
    ),
    "several_clients": (
        small_graph(GOALS.format("/navigate_to_pose")),
        small_graph(GOALS.format("/other")),
    ),
    "settable_topic": (
        with_resolution(small_graph(BASE), Resolution.PARAMETER),
        with_resolution(small_graph(BASE), Resolution.LITERAL),
    ),
    "arbiter": (small_graph(MUX), small_graph(MUX.replace(" twist_mux ", " my_mux "))),
}
