"""What an app's inventory says of who can move the robot."""

from dataclasses import replace

import pytest
from finding_graphs import BASE, FIRMWARE, MUX, TWIST, TWO_DRIVERS, parameters, small_graph

from cpu_time import growth
from rtron.findings import app_facts, take_inventory
from rtron.findings.inventory.stopping import stopping
from rtron.findings.motion import command_timeout
from rtron.reports.app.inventory_rows import mover_rows
from rtron.vocabulary import (
    Action,
    ActionRole,
    Evidence,
    NodeParameter,
    Service,
    ServiceClient,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.enums import HiddenPart
from rtron.vocabulary.inventory import Command, Means, Stops, Thing

LIDAR = "/lidar lidar third_party\n    pub /scan sensor_msgs/msg/LaserScan\n"
NAV_AND_JOY = f"""
/nav nav own
    pub /nav_vel {TWIST}
/teleop teleop own
    sub /joy sensor_msgs/msg/Joy
    pub /joy_vel {TWIST}
"""
SERVO = """
/rover rover own
    pub /brush std_msgs/msg/Float64
/tools tools own
    sub /brush std_msgs/msg/Float64
    sub /imu sensor_msgs/msg/Imu
"""
PLACE = (Evidence(file="driver.py", line=7),)


def inventory(text, ros=2, **changes):
    graph = small_graph(text, ros=ros, **changes)
    endpoints = tuple(replace(each, evidence=PLACE) for each in graph.endpoints)
    return take_inventory(app_facts(replace(graph, endpoints=endpoints)))


def the_mover(text, ros=2, **changes):
    (mover,) = inventory(text, ros, **changes)
    return mover


def fact(kind, node, value):
    return WiringFact(kind=WiringFactKind(kind), subject=node, value=value, evidence=PLACE)


def last(fate, *seconds):
    """Return what becomes of the last messages of a node's topics."""
    return replace(fact("last_message", "/base", fate), others=seconds)


WRITTEN = fact("message_flow", "/base", "device")
DRIVER, KEPT = fact("device", "/base", "CAN"), last("unnoticed")
AGED = fact("command_age", "/base", "age")


def names(commands):
    return [each.name for each in commands]


def test_what_moves_nothing_has_no_line():
    assert inventory(LIDAR) == ()


def test_a_base_with_its_commanders():
    mover = the_mover(TWO_DRIVERS + BASE)
    assert (mover.thing, mover.drivers, mover.arbiters) == (Thing.BASE, ("/base",), ())
    (command,) = mover.commands
    assert (command.name, command.senders) == ("/cmd_vel", ("/move_base", "/teleop"))
    assert mover.open_commands == ()


GPS = "/gps gps third_party\n    pub /fix sensor_msgs/msg/NavSatFix\n    pub /vel {type}\n"


@pytest.mark.parametrize("type", [TWIST, "geometry_msgs/msg/TwistStamped"])
@pytest.mark.parametrize("name", ["wheel_vel", "vel_raw", "fix_velocity", "odom_twist"])
def test_a_velocity_that_was_measured_is_no_command(name, type):
    assert inventory(f"/board board own\n    pub /{name} {type}\n") == ()


@pytest.mark.parametrize("name", ["/wheel_vel", "/twist_raw", "/real_vel", "/cmd/velocity_raw"])
def test_a_velocity_that_a_driver_obeys_was_not_measured(name):
    mover = the_mover(TWO_DRIVERS.replace("/cmd_vel", name) + BASE.replace("/cmd_vel", name))
    assert (mover.thing, names(mover.commands)) == (Thing.BASE, [name])


@pytest.mark.parametrize("name", ["/imu/cmd_vel", "/gps/cmd_vel", "/cmd/velocity_raw"])
def test_what_is_called_a_command_was_not_measured(name):
    assert names(the_mover(f"/nav nav own\n    pub {name} {TWIST}\n").commands) == [name]


@pytest.mark.parametrize(
    ("package", "sent"), [("vio_nav", ["/robot/velocity"]), ("kobuki_node", [])]
)
def test_a_driver_that_tells_odometry_measures_and_a_navigator_commands(package, sent):
    pub = f"    pub /odom nav_msgs/Odometry\n    pub /robot/velocity {TWIST}\n"
    found = inventory(f"/node {package} own\n{pub}")
    assert [name for mover in found for name in names(mover.commands)] == sent


@pytest.mark.parametrize(
    ("node", "package"),
    [
        *(("/camera_gimbal_driver", "gimbal"), ("/camera/pan_tilt", "sdk_node")),
        *(("/gps_waypoint_driver", "own"), ("/lidar_base", "base_driver")),
    ],
)
def test_a_driver_with_a_sensor_in_its_name_is_listed(node, package):
    found = inventory(f"{node} {package} third_party\n", unread=(node,))
    assert [each.drivers for each in found] == [(node,)]


def test_what_a_node_that_measures_tells_of_its_velocity_is_no_command():
    assert inventory(GPS.format(type=TWIST)) == ()
    assert names(the_mover(GPS.format(type=TWIST).replace("/vel", "/cmd_vel")).commands)
    assert names(the_mover(GPS.format(type=TWIST) + BASE.replace("/cmd_vel", "/vel")).commands)
    wheels = "/board board own\n    pub /wheel_velocity_cmd std_msgs/msg/Float64\n"
    assert names(the_mover(wheels).commands) == ["/wheel_velocity_cmd"]


def test_a_base_that_nobody_here_drives_is_open():
    assert names(the_mover(BASE).open_commands) == ["/cmd_vel"]


def test_what_the_driver_of_another_launch_obeys():
    mover = the_mover(TWO_DRIVERS)
    assert (mover.drivers, names(mover.commands)) == ((), ["/cmd_vel"])
    assert (mover.stops, mover.stop) == (Stops.UNKNOWN, "what obeys is not in this launch")


def test_inputs_of_an_arbiter_stand_behind_what_it_sends():
    ranks = (
        *parameters("topics.nav.topic", twist_mux="nav_vel"),
        *parameters("topics.nav.priority", twist_mux=10),
    )
    mover = the_mover(NAV_AND_JOY + MUX + BASE, parameters=ranks)
    found = {each.name: (each.hops, each.priority, each.senders) for each in mover.commands}
    assert found == {
        "/cmd_vel": (0, "", ("/twist_mux",)),
        "/nav_vel": (1, "10", ("/nav",)),
        "/joy_vel": (1, "", ("/teleop",)),
        "/joy": (2, "", ()),
    }
    assert mover.arbiters == ("/twist_mux",)
    assert names(mover.open_commands) == ["/joy"]


def test_nodes_that_forward_to_each_other_end():
    ring = f"/a a own\n    sub /x_vel {TWIST}\n    pub /y_vel {TWIST}\n"
    ring += f"/b b own\n    sub /y_vel {TWIST}\n    pub /x_vel {TWIST}\n    pub /cmd_vel {TWIST}\n"
    mover = next(each for each in inventory(ring + BASE) if each.drivers == ("/base",))
    assert sorted(names(mover.commands)) == ["/cmd_vel", "/x_vel", "/y_vel"]


TELLS = "    pub /wheel_speeds x/WheelSpeeds\n    pub /odom_vel geometry_msgs/msg/TwistStamped\n"


def test_a_base_that_tells_how_it_moves_still_obeys():
    mover = the_mover(TWO_DRIVERS + BASE + TELLS)
    assert (mover.drivers, names(mover.last_commands)) == (("/base",), ["/cmd_vel"])


def test_a_filter_of_commands_hands_them_on():
    text = f"/cmd_vel_filter f own\n    sub /raw_vel {TWIST}\n    pub /cmd_vel {TWIST}\n"
    mover = the_mover(text + TWO_DRIVERS.replace("/cmd_vel", "/raw_vel") + BASE)
    assert names(mover.commands) == ["/cmd_vel", "/raw_vel"]


def test_a_lidar_may_take_goals():
    action = "    server /go nav2_msgs/action/NavigateToPose\n"
    assert names(the_mover(LIDAR + action).commands) == ["/go"]


def test_a_fact_without_a_place_is_one():
    placeless = WiringFact(kind=WiringFactKind.COMMAND_AGE, subject="/base")
    assert the_mover(BASE, wiring=(placeless,)).stop == "/base may look at the age of commands"


def test_it_takes_time_in_proportion_to_the_graph():
    """Of so many nodes each hears and sends all topics; one walk is done for each topic."""

    def inventoried(size):
        all_topics = ",".join(map(str, range(size)))
        ends = f"    sub /v{{{all_topics}}}_cmd {TWIST}\n    pub /v{{{all_topics}}}_cmd {TWIST}\n"
        graph = small_graph("".join(f"/n{number} n own\n{ends}" for number in range(size)))
        return take_inventory(app_facts(graph))

    assert growth(inventoried, 10, 30) < 20


EKF = f"/ekf robot_localization third_party\n    sub /cmd_vel {TWIST}\n"


def test_who_only_estimates_from_commands_does_not_obey_them():
    assert the_mover(TWO_DRIVERS + BASE + EKF).drivers == ("/base",)
    assert the_mover(TWO_DRIVERS + EKF).drivers == ()
    assert inventory(EKF) == ()


def test_what_a_vague_name_commands_counts_beside_a_device_alone():
    text = "/a a own\n    pub /flaps x/FlapCommand\n/b b own\n    sub /flaps x/FlapCommand\n"
    assert inventory(text) == ()
    mover = the_mover(text, wiring=(fact("device", "/b", "CAN"),))
    assert (mover.thing, mover.drivers) == (Thing.DEVICE, ("/b",))


def test_a_lock_of_an_arbiter_is_a_stop():
    locks = (
        *parameters("locks.stop.topic", twist_mux="/halted"),
        *parameters("locks.stop.priority", twist_mux=255),
    )
    text = NAV_AND_JOY + MUX + "    sub /halted std_msgs/msg/Bool\n" + BASE
    movers = {each.thing: each for each in inventory(text, parameters=locks)}
    assert names(movers[Thing.STOP].commands) == ["/halted"]
    assert movers[Thing.STOP].drivers == ("/twist_mux",)
    assert movers[Thing.STOP].effect == ""
    low = (
        *locks[:-1],
        *parameters("locks.stop.priority", twist_mux=100),
        *parameters("topics.joy.topic", twist_mux="/joy_vel"),
        *parameters("topics.joy.priority", twist_mux=100),
        *parameters("topics.nav.topic", twist_mux="/nav_vel"),
        *parameters("topics.nav.priority", twist_mux=10),
    )
    (stop,) = (each for each in inventory(text, parameters=low) if each.thing is Thing.STOP)
    assert stop.effect == "locks nothing that is ranked as high: /joy_vel"


def test_what_a_node_with_a_device_obeys_is_a_command_whatever_its_type():
    assert inventory(SERVO) == ()
    mover = the_mover(SERVO, wiring=(fact("device", "/tools", "I2C"),))
    assert (mover.thing, mover.hardware, mover.evidence) == (Thing.TOOL, ("I2C",), PLACE * 2)
    assert names(mover.commands) == ["/brush"]


@pytest.mark.parametrize(
    ("wiring", "values", "stops", "why"),
    [
        ((), (), Stops.UNKNOWN, "/base does not tell"),
        ((DRIVER, KEPT), (), Stops.NO, "nothing in the source of /base looks"),
        ((DRIVER,), (), Stops.UNKNOWN, "/base does not tell"),
        (
            (DRIVER, last("stopped", "0.5 s")),
            (),
            Stops.YES,
            "/base looks at the age of commands, after 0.5 s, driver.py:7",
        ),
        ((DRIVER, last("checked")), (), Stops.UNKNOWN, "/base may look at the age of commands, d"),
        (
            (last("repeated"),),
            (),
            Stops.NO,
            "/base sends its last command for ever when /cmd_vel ends",
        ),
        ((KEPT,), (), Stops.UNKNOWN, "/base does not tell"),
        ((DRIVER, KEPT, AGED), (), Stops.UNKNOWN, "/base is not seen to look at the age of these"),
        ((fact("command_age", "/base", "age"),), (), Stops.UNKNOWN, "/base may look at the age"),
        ((), parameters("cmd_vel_timeout", base=0.5), Stops.YES, "/base: cmd_vel_timeout is 0.5"),
        (
            (DRIVER, KEPT),
            parameters("cmd_vel_timeout", base=0.5),
            Stops.NO,
            "nothing in the source of /base looks",
        ),
        ((), parameters("cmd_vel_timeout", base=0.0), Stops.NO, "/base: cmd_vel_timeout is 0.0"),
        ((), parameters("x.cmd_vel_timeout", base=None), Stops.UNKNOWN, "/base does not tell"),
    ],
)
def test_whether_it_stops(wiring, values, stops, why):
    mover = the_mover(TWO_DRIVERS + BASE, wiring=wiring, parameters=values)
    assert (mover.stops, mover.stop[: len(why)]) == (stops, why)


@pytest.mark.parametrize(
    ("fate", "file", "read", "stops"),
    [
        ("stopped", "driver.py", ("/cmd_vel",), Stops.NO),
        ("stopped", "other.py", ("/cmd_vel",), Stops.UNKNOWN),
        ("checked", "driver.py", ("/cmd_vel",), Stops.UNKNOWN),
        ("stopped", "driver.py", ("/cmd_vel", "/raw_vel"), Stops.UNKNOWN),
    ],
)
def test_a_name_that_tells_of_the_age_of_other_commands_tells_nothing(fate, file, read, stops):
    graph = small_graph(BASE + f"    sub /other_cmd x/msg/OtherCmd\n    sub /raw_vel {TWIST}\n")
    places = {"/cmd_vel": PLACE, "/other_cmd": (Evidence(file=file, line=9),)}
    ends = tuple(replace(each, evidence=places.get(each.topic, ())) for each in graph.endpoints)
    other = replace(last(fate), evidence=places["/other_cmd"])
    facts = (fact("device", "/base", "CAN"), KEPT, AGED, other)
    commands = [Command(means=Means.TOPIC, name=name) for name in read]
    app = app_facts(replace(graph, endpoints=ends, wiring=facts))
    assert stopping(app, ("/base",), commands, ())[0].stops is stops


def with_two_topics(fates, *facts, **changes):
    """Return an app whose base hears `/cmd_vel`, then `/raw_vel`, with the fates of both."""
    graph = small_graph(BASE + f"    sub /raw_vel {TWIST}\n")
    places = {"/cmd_vel": PLACE, "/raw_vel": (Evidence(file="driver.py", line=9),)}
    ends = tuple(replace(each, evidence=places[each.topic]) for each in graph.endpoints)
    told = zip(fates, places.values(), strict=False)
    facts = (DRIVER, *facts, *(replace(last(fate), evidence=place) for fate, place in told))
    return app_facts(replace(graph, endpoints=ends, wiring=facts, **changes))


LOOKED = "/base looks at the age of"
NEVER = "nothing in the source of /base looks at the age of commands on"


@pytest.mark.parametrize(
    ("fates", "stops", "why"),
    [
        (("stopped", "stopped"), Stops.YES, f"{LOOKED} commands, driver.py:9"),
        (
            ("stopped",),
            Stops.UNKNOWN,
            f"{LOOKED} some commands, but is not seen to on /raw_vel, driver.py:7",
        ),
        (("unnoticed", "stopped"), Stops.NO, f"{NEVER} /cmd_vel"),
        (("unnoticed", "unnoticed"), Stops.NO, f"{NEVER} /cmd_vel and /raw_vel"),
        (("checked", "unnoticed"), Stops.NO, f"{NEVER} /raw_vel"),
        (("stopped", "repeated"), Stops.NO, f"{NEVER} /raw_vel"),
    ],
)
def test_each_topic_of_a_driver_is_judged_by_itself(fates, stops, why):
    (mover,) = take_inventory(with_two_topics(fates))
    assert (mover.stops, mover.stop) == (stops, why)


def test_a_parameter_helps_no_topic_whose_age_nobody_looks_at():
    timeout = parameters("cmd_vel_timeout", base=0.5)
    app = with_two_topics(("unnoticed", "stopped"), AGED, parameters=timeout)
    assert take_inventory(app)[0].stops is Stops.NO


def test_a_name_that_tells_of_an_age_may_have_no_place():
    app = with_two_topics(("unnoticed", "stopped"), replace(AGED, evidence=()))
    found, *_ = stopping(app, ("/base",), [Command(means=Means.TOPIC, name="/cmd_vel")], ())
    assert found.why.endswith("these commands; a name may tell of it")


def test_the_worst_of_two_drivers_counts():
    second = BASE.replace("/base", "/second")
    facts = (DRIVER, KEPT, fact("command_age", "/base", "age"))
    assert the_mover(BASE + second, wiring=facts).stops is Stops.UNKNOWN
    worse = (*facts, fact("device", "/second", "CAN"))
    assert the_mover(BASE + second, wiring=worse).stops is Stops.NO


@pytest.mark.parametrize(("fate", "stops"), [("checked", Stops.UNKNOWN), ("repeated", Stops.NO)])
def test_another_node_may_stop_a_driver_whose_commands_it_hears(fate, stops):
    dog = f"/dog dog own\n    sub /cmd_vel {TWIST}\n    pub /cmd_vel {TWIST}\n"
    graph = small_graph(dog + BASE)
    elsewhere = (Evidence(file="dog.py", line=3),)
    endpoints = tuple(
        replace(each, evidence=elsewhere if each.node == "/dog" else PLACE)
        for each in graph.endpoints
    )
    wiring = (DRIVER, KEPT, replace(last(fate), evidence=elsewhere))
    app = app_facts(replace(graph, endpoints=endpoints, wiring=wiring))
    assert take_inventory(app)[0].stops is stops
    drivers = [each for each in command_timeout.check(app) if "/base" in each.nodes]
    assert bool(drivers) is (stops is Stops.NO)


def test_who_forwards_the_last_command_for_ever_counts_for_the_driver():
    relay = f"/relay relay own\n    sub /nav_vel {TWIST}\n    pub /cmd_vel {TWIST}\n"
    wiring = (DRIVER, last("stopped", "0.5 s"))
    graph = small_graph(f"/nav nav own\n    pub /nav_vel {TWIST}\n" + relay + BASE)
    elsewhere = (Evidence(file="relay.py", line=3),)
    endpoints = tuple(
        replace(each, evidence=elsewhere if each.node == "/relay" else PLACE)
        for each in graph.endpoints
    )
    nodes = tuple(replace(each, unread=each.name == "/base") for each in graph.nodes)
    away = replace(graph, nodes=nodes, endpoints=[e for e in endpoints if e.node != "/base"])
    mover, _ = take_inventory(
        app_facts(replace(away, wiring=(replace(last("repeated"), evidence=elsewhere),)))
    )
    assert (mover.stops, mover.stop[:16]) == (Stops.NO, "/relay sends its")
    for fate, stops in (("repeated", Stops.NO), ("stopped", Stops.YES), ("unnoticed", Stops.YES)):
        facts = (*wiring, replace(last(fate), evidence=elsewhere))
        (mover,) = take_inventory(app_facts(replace(graph, endpoints=endpoints, wiring=facts)))
        assert mover.stops is stops
    assert (mover.stop).startswith("/base looks")


@pytest.mark.parametrize(("sent", "stops"), [("/cmd_vel", Stops.NO), ("/shown", Stops.YES)])
def test_who_shows_the_last_command_for_ever_does_not_count(sent, stops):
    relay = f"/relay relay own\n    sub /nav_vel {TWIST}\n    pub /cmd_vel {TWIST}\n"
    shown = "    pub /shown std_msgs/msg/Float64\n"
    graph = small_graph(f"/nav nav own\n    pub /nav_vel {TWIST}\n" + relay + shown + BASE)
    places = {each: (Evidence(file="relay.py", line=len(each)),) for each in ("/nav_vel", sent)}
    ends = tuple(
        replace(e, evidence=places.get(e.topic, ()) if e.node == "/relay" else PLACE)
        for e in graph.endpoints
    )
    kept = replace(last("repeated"), evidence=(*places["/nav_vel"], *places[sent]))
    facts = (DRIVER, last("stopped", "0.5 s"), kept)
    (mover,) = take_inventory(app_facts(replace(graph, endpoints=ends, wiring=facts)))
    assert mover.stops is stops


def test_what_is_documented_of_a_driver():
    gazebo = f"/plugin gazebo_ros third_party\n    sub /cmd_vel {TWIST}\n"
    assert the_mover(gazebo).stops is Stops.NO


LIBRARY = "github.com/x/y@1.0"
DIFF_DRIVE = f"{LIBRARY} diff_drive_controller/src/diff_drive_controller.cpp"
VELOCITY = f"{LIBRARY} velocity_controllers/src/joint.cpp"


@pytest.mark.parametrize(
    ("package", "files", "stops"),
    [
        ("gazebo_ros", (DIFF_DRIVE,), Stops.YES),
        ("gazebo_ros", (VELOCITY,), Stops.NO),
        ("gazebo_ros", (DIFF_DRIVE, VELOCITY), Stops.NO),
        ("gazebo_ros", (VELOCITY, DIFF_DRIVE), Stops.NO),
        ("host", (DIFF_DRIVE, VELOCITY), Stops.UNKNOWN),
        ("mydrv", ("kobuki_node/mydrv/drv.py",), Stops.UNKNOWN),
    ],
)
def test_a_controller_stops_as_is_documented_of_it_wherever_it_runs(package, files, stops):
    topics = [f"/cmd_vel{number}" for number in range(len(files))]
    subscribed = "".join(f"    sub {topic} {TWIST}\n" for topic in topics)
    graph = small_graph(f"/host {package} third_party\n{subscribed}")
    places = dict(zip(topics, files, strict=True))
    ends = tuple(
        replace(e, evidence=(Evidence(file=places[e.topic], line=1),)) for e in graph.endpoints
    )
    (mover,) = take_inventory(app_facts(replace(graph, endpoints=ends)))
    assert mover.stops is stops


@pytest.mark.parametrize("values", [(0.5, 0.0), (0.0, 0.5)])
def test_of_several_timeouts_the_worst_counts(values):
    given = dict(zip(("a.cmd_vel_timeout", "b.cmd_vel_timeout"), values, strict=True))
    timeouts = tuple(NodeParameter(node="/base", name=n, value=v) for n, v in given.items())
    assert the_mover(TWO_DRIVERS + BASE, parameters=timeouts).stops is Stops.NO


def test_doors():
    bridge = "/bridge rosbridge_server third_party\n"
    web = fact("socket", "/teleop", "web server")
    idle = fact("socket", "/other", "MQTT")
    mover = the_mover(TWO_DRIVERS + BASE + bridge, wiring=(web, idle))
    assert mover.doors == ("/bridge (any client)", "/teleop (web server)")


def test_what_says_that_it_commands_goes_before_what_else_a_driver_hears():
    heard = ("adsb own/Adsb", "debug own/Debug", "wheel own/Angle", "set/desired own/Goal")
    subs = "".join(f"    sub /pilot/{each}\n" for each in heard)
    mover = the_mover(f"/base driver own\n    sub /pilot/twist {TWIST}\n{subs}")
    assert names(mover.commands) == [
        *("/pilot/twist", "/pilot/set/desired", "/pilot/wheel", "/pilot/adsb", "/pilot/debug"),
    ]


def test_what_somebody_sends_goes_before_what_nobody_sends():
    heard = "".join(f"    sub /motor/{each} std_msgs/Float64\n" for each in ("brake", "cmd", "rpm"))
    text = f"/motor_driver p own\n{heard}/nav nav own\n    pub /motor/rpm std_msgs/Float64\n"
    assert names(the_mover(text).commands) == ["/motor/rpm", "/motor/cmd", "/motor/brake"]


def test_a_stop_is_asked_for_where_nobody_here_obeys_what_is_made_of_it():
    text = "/safety p own\n    sub /estop_request std_msgs/Bool\n    pub /estop std_msgs/Bool\n"
    mover = the_mover(text)
    assert (mover.thing, names(mover.last_commands)) == (Thing.STOP, ["/estop_request"])
    obeyed = text + "/base_driver p own\n    sub /estop std_msgs/Bool\n"
    assert names(the_mover(obeyed).last_commands) == ["/estop"]


def test_a_web_page_that_was_not_read_obeys_no_commands():
    nav = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
    found = {
        name: the_mover(f"{nav}/{name} own own\n", unread=(f"/{name}",)).unread
        for name in ("phone_gui", "board")
    }
    assert found == {"phone_gui": (), "board": ("/board",)}


@pytest.mark.parametrize(
    ("node", "device", "thing"),
    [
        ("/pilot own own\n", "vehicle link", Thing.VEHICLE),
        ("/wanderer own own\n", "motor controller", Thing.DEVICE),
        ("/wanderer own own\n", "serial port", None),
        ("/imu own own\n    pub /imu sensor_msgs/Imu\n", "vehicle link", None),
        (f"/base own own\n    sub /cmd_vel {TWIST}\n", "motor controller", Thing.BASE),
    ],
)
def test_a_node_whose_hardware_only_moves_has_a_line_without_a_command(node, device, thing):
    name = node.partition(" ")[0]
    facts = (fact("device", name, device), fact("self_motion", name, device))
    movers = inventory(node, wiring=facts)
    assert [(mover.thing, mover.drivers) for mover in movers] == (
        [(thing, (name,))] if thing else []
    )
    assert all((thing is Thing.BASE) == bool(mover.commands) for mover in movers)


def test_a_link_to_an_autopilot_is_no_way_to_what_its_node_sends():
    link = (fact("device", "/pilot", "vehicle link"), fact("socket", "/pilot", "MAVLink link"))
    text = "/pilot own own\n    pub /claw_control own/Claw\n"
    found = {mover.thing: mover.doors for mover in inventory(text, wiring=link)}
    assert found == {Thing.VEHICLE: ("/pilot (MAVLink link)",), Thing.GRIPPER: ()}


def test_services_of_one_switch_are_one_line():
    services = tuple(
        Service(node=node, name=f"{node}/arm", type="std_srvs/srv/Trigger")
        for node in ("/left", "/right")
    )
    clients = (ServiceClient(node="/mission", name="/left/arm"),)
    mover = the_mover(LIDAR, services=services, clients=clients)
    assert (mover.thing, mover.drivers) == (Thing.ARMING, ("/left", "/right"))
    assert {each.name: each.senders for each in mover.commands} == {
        "/left/arm": ("/mission",),
        "/right/arm": (),
    }


def test_a_service_that_nobody_here_offers_stands_for_what_is_called():
    clients = (ServiceClient(node="/mission", name="/e_stop", type="x/srv/EStop"),)
    (command,) = the_mover(LIDAR, clients=clients).commands
    assert (command.means, command.receivers, command.senders) == (Means.SERVICE, (), ("/mission",))


def test_the_motor_of_a_lidar_moves_no_robot():
    services = (Service(node="/lidar", name="/start_motor", type="std_srvs/srv/Empty"),)
    assert inventory(LIDAR, services=services) == ()


def test_goals_stand_with_what_they_move():
    action = "    server /navigate_to_pose nav2_msgs/action/NavigateToPose\n"
    mover = the_mover(f"/nav nav own\n    pub /cmd_vel {TWIST}\n{action}" + BASE)
    assert names(mover.last_commands) == ["/cmd_vel", "/navigate_to_pose"]
    assert names(mover.open_commands) == ["/navigate_to_pose"]


MISSION = """
/mission mission own
    client /pick_object x/action/Pick
    server /pick_up_all x/action/PickAll
/picker picker own
    server /pick_object x/action/Pick
/arm arm own
    server /arm/follow control_msgs/action/FollowJointTrajectory
    pub /arm/{left,right,third}_cmd trajectory_msgs/msg/JointTrajectory
"""


def test_the_goal_that_leads_to_other_goals_comes_before_what_leads_to_topics():
    goals = [each.name for each in the_mover(MISSION).commands if each.means is Means.ACTION]
    assert goals == ["/pick_up_all", "/arm/follow", "/pick_object"]


def test_signals_come_after_what_moves_and_those_that_stop_last():
    buttons = "    sub /cancel_drive std_msgs/msg/Bool\n    sub /go std_msgs/msg/Bool\n"
    action = "    client /drive nav2_msgs/action/DriveOnHeading\n"
    server = "    server /drive nav2_msgs/action/DriveOnHeading\n"
    text = f"/phone phone own\n{buttons}{action}/nav nav own\n    pub /cmd_vel {TWIST}\n{server}"
    mover = the_mover(text + f"    sub /nav_vel {TWIST}\n" + BASE)
    found = names(mover.commands)
    assert found == ["/cmd_vel", "/drive", "/nav_vel", "/go", "/cancel_drive"]


def test_actions_that_compute_move_nothing():
    assert inventory("/p p own\n    server /plan nav2_msgs/action/ComputePathToPose\n") == ()


def test_an_autopilot_is_one_vehicle():
    topics = f"    sub /mavros/cmd_vel {TWIST}\n    pub /mavros/vel {TWIST}\n"
    mover = the_mover(f"/mavros mavros third_party\n{topics}")
    assert (mover.thing, names(mover.commands)) == (Thing.VEHICLE, ["/mavros/cmd_vel"])


def test_what_was_not_read_is_told():
    mover = the_mover(FIRMWARE, unread=("/firmware",))
    assert (mover.thing, mover.drivers, mover.commands) == (Thing.DEVICE, ("/firmware",), ())


LIMITS = (
    NodeParameter(node="/base", name="max_velocity", value=1.0),
    NodeParameter(node="/base", name="wheel_radius", value=0.1),
    NodeParameter(node="/lidar", name="max_speed", value=1.0),
)


def test_parameters_that_bound_motion_can_be_set_in_ros2():
    movers = {each.thing: each for each in inventory(LIDAR + BASE, parameters=LIMITS)}
    (command,) = movers[Thing.LIMITS].commands
    assert (command.means, command.name) == (Means.PARAMETER, "/base.max_velocity")


@pytest.mark.parametrize("is_tunable", [False, True])
def test_in_ros1_dynamic_reconfigure_sets_them(is_tunable):
    type = "dynamic_reconfigure/Reconfigure" if is_tunable else "x/Y"
    services = (Service(node="/base", name="/base/set_parameters", type=type),)
    found = inventory(BASE, ros=1, parameters=LIMITS, services=services)
    assert (Thing.LIMITS in {each.thing for each in found}) == is_tunable


def test_many_are_merged_by_thing():
    text = "".join(f"/base{n} driver own\n    sub /cmd_vel{n} {TWIST}\n" for n in range(20))
    mover = the_mover(text)
    assert len(mover.drivers) == 20


def test_the_order_of_the_graph_changes_nothing():
    graph = small_graph(NAV_AND_JOY + MUX + BASE + FIRMWARE, unread=("/firmware",))
    turned = replace(graph, endpoints=graph.endpoints[::-1])
    assert take_inventory(app_facts(graph)) == take_inventory(app_facts(turned))


RELAY = f"/relay relay own\n    sub /cmd_vel {TWIST}\n    pub /base/cmd_vel {TWIST}\n"
MONITOR = f"/monitor monitor own\n    sub /cmd_vel {TWIST}\n    pub /speed std_msgs/msg/Float64\n"
ODOMETRY = "    pub /odom nav_msgs/msg/Odometry\n"


def test_who_listens_beside_one_that_hands_a_command_on_does_not_obey_it():
    mover = the_mover(TWO_DRIVERS + RELAY + MONITOR)
    assert names(mover.last_commands) == ["/base/cmd_vel"]
    driving = MONITOR + ODOMETRY
    assert {
        name
        for each in inventory(TWO_DRIVERS + RELAY + driving)
        for name in names(each.last_commands)
    } == {"/base/cmd_vel", "/cmd_vel"}


def test_what_a_driver_hears_beside_velocities_stands_with_them():
    trim = "    sub /trim_event std_msgs/msg/Float32\n    sub /light_mode std_msgs/msg/Int8\n"
    mover = the_mover(BASE + trim, wiring=(fact("device", "/base", "CAN"),))
    assert names(mover.last_commands) == ["/cmd_vel", "/trim_event"]


def test_topics_that_end_the_robot_are_a_line():
    text = "/system system own\n    sub /system/shutdown std_msgs/msg/Empty\n"
    assert the_mover(text).thing is Thing.POWER
    assert inventory(text.replace("Empty", "Float32")) == ()


@pytest.mark.parametrize(
    ("link", "stops", "why"),
    [
        ("vehicle link", Stops.UNKNOWN, "/base looks at no age of commands; its device may"),
        ("VESC", Stops.UNKNOWN, "its device may, by default after 1 s"),
        ("CAN", Stops.NO, f"{NEVER} /cmd_vel"),
    ],
)
def test_an_autopilot_may_stop_by_itself(link, stops, why):
    mover = the_mover(BASE, wiring=(fact("device", "/base", link), KEPT))
    assert (mover.stops, mover.stop.endswith(why)) == (stops, True)
    assert (mover.thing is Thing.VEHICLE) == (link == "vehicle link")


def test_a_node_in_which_controllers_run_drives():
    host = Service(node="/hw", name="/switch", type="controller_manager_msgs/SwitchController")
    text = f"/hw hw own\n    sub /c/cmd_vel {TWIST}\n    pub /left/cmd std_msgs/Float64\n"
    values = (NodeParameter(node="/c", name="cmd_vel_timeout", value=0.5),)
    movers = {each.thing: each for each in inventory(text, 1, services=(host,), parameters=values)}
    assert names(movers[Thing.BASE].commands) == ["/c/cmd_vel"]
    assert movers[Thing.BASE].stop == "/c: cmd_vel_timeout is 0.5"
    assert movers.keys() == {Thing.BASE, Thing.CONTROLLERS}


def test_where_nobody_that_was_read_obeys_the_others_may():
    unread = "/one one third_party\n"
    assert the_mover(TWO_DRIVERS + unread, unread=("/one",)).unread == ("/one",)
    assert the_mover(unread, unread=("/one",)).drivers == ("/one",)
    assert the_mover(TWO_DRIVERS + BASE + unread, unread=("/one",)).unread == ()
    assert the_mover(BASE).is_whole
    assert not the_mover(BASE + unread, unread=("/one",)).is_whole


def test_a_bridge_that_was_not_read_obeys_nothing():
    bridge = "/bridge rosbridge_server third_party\n"
    mover = the_mover(TWO_DRIVERS + bridge, unread=("/bridge",))
    assert (mover.unread, mover.doors) == ((), ("/bridge (any client)",))


PLANNERS = tuple(
    NodeParameter(node="/base", name=name, value=value)
    for name, value in [
        ("base_local_planner", "dwa_local_planner/DWAPlannerROS"),
        ("DWAPlannerROS.max_vel_x", 1.0),
        ("TrajectoryPlannerROS.max_vel_x", 2.0),
    ]
)


def test_limits_of_a_planner_that_is_not_loaded_bound_nothing():
    services = (Service(node="/base", name="/s", type="dynamic_reconfigure/Reconfigure"),)
    movers = inventory(BASE, ros=1, parameters=PLANNERS, services=services)
    (command,) = next(each.commands for each in movers if each.thing is Thing.LIMITS)
    assert command.name == "/base.DWAPlannerROS.max_vel_x"


def with_program(graph, node, package, executable):
    nodes = (
        replace(each, package=package, executable=executable) if each.name == node else each
        for each in graph.nodes
    )
    return replace(graph, nodes=tuple(nodes))


JOINTS = ("joint_trajectory_controller", "joint_trajectory_controller/Controller")
DIFF_DRIVE = ("diff_drive_controller", "diff_drive_controller/DiffDriveController")


def test_controllers_read_their_limits_once():
    graph = with_program(small_graph(BASE, parameters=LIMITS), "/base", *DIFF_DRIVE)
    (mover,) = take_inventory(app_facts(graph))
    assert mover.thing is Thing.BASE


@pytest.mark.parametrize("package", ["nav2_controller", "nav2_velocity_smoother"])
def test_the_limits_of_nav2_can_be_set_whatever_the_app_gives(package):
    graph = small_graph(f"/server server third_party\n    pub /cmd_vel {TWIST}\n" + BASE)
    assert Thing.LIMITS not in {each.thing for each in take_inventory(app_facts(graph))}
    movers = take_inventory(app_facts(with_program(graph, "/server", package, "server")))
    (bounds,) = (each for each in movers if each.thing is Thing.LIMITS)
    assert names(bounds.commands) == ["/server/set_parameters"]


def test_topics_and_parameters_that_bound_motion_are_one_line():
    max_vel, max_speed = (
        f"    sub {name} std_msgs/msg/Float32\n" for name in ("/max_vel", "/x/max_speed")
    )
    text = BASE + max_vel + max_speed + "/other other own\n" + max_vel
    movers = inventory(text, parameters=LIMITS, wiring=(fact("device", "/other", "CAN"),))
    (bounds,) = (each for each in movers if each.thing is Thing.LIMITS)
    assert {"/max_vel", "/x/max_speed", "/base.max_velocity"} <= set(names(bounds.commands))
    assert {"/base", "/other"} <= set(bounds.drivers)


FLIP = "    sub /flip std_msgs/msg/UInt8\n    sub /record std_msgs/msg/Bool\n"


def test_what_a_driver_hears_and_offers_whatever_its_name_stands_with_its_velocities():
    services = tuple(
        Service(node="/base", name=name, type="std_srvs/Trigger")
        for name in ("/go_home", "/roll", "/get_x", "/set_light")
    )
    mover = the_mover(BASE + FLIP, services=services)
    assert names(mover.last_commands) == ["/cmd_vel", "/flip", "/go_home", "/roll"]


def all_last(text):
    return {name for mover in inventory(text) for name in names(mover.last_commands)}


def test_what_a_driver_tells_is_no_command_behind_another():
    wrench = "    pub /wrench geometry_msgs/msg/Wrench\n"
    text = f"/watch watch own\n    sub /base/drive_events x/Drive\n{wrench}"
    base = BASE + "    pub /base/drive_events x/Drive\n    sub /commands/drive x/Drive\n"
    movers = inventory(text + base, wiring=(fact("device", "/base", "CAN"),))
    other = next(each for each in movers if "/wrench" in names(each.commands))
    assert names(other.commands) == ["/wrench"]


def test_a_launch_file_that_was_not_read_may_start_who_obeys():
    note = UnresolvedItem(
        what="include $(find smoother)/smoother.launch", why="not here", hides=HiddenPart.NODES
    )
    assert the_mover(TWO_DRIVERS, unresolved=(note,)).unread == (note.what,)
    shape = UnresolvedItem(
        what="include $(find arm)/urdf/arm.urdf.xacro", why="not here", hides=HiddenPart.NODES
    )
    eye = UnresolvedItem(
        what="include $(find my_camera)/launch/nodes.launch.xml",
        why="not here",
        hides=HiddenPart.NODES,
    )
    assert the_mover(TWO_DRIVERS, unresolved=(shape, eye)).unread == ()


def test_all_parameters_of_what_can_be_tuned_count_where_no_name_tells():
    services = (Service(node="/base", name="/s", type="dynamic_reconfigure/Reconfigure"),)
    movers = {each.thing: each for each in inventory(BASE, ros=1, services=services)}
    assert names(movers[Thing.LIMITS].commands) == ["/base/set_parameters"]


def test_a_name_that_tells_little_is_of_what_its_nodes_are_called_after():
    text = "/pan_tilt own own\n    pub /a_controller/command std_msgs/Float64\n"
    (mover,) = inventory(text, wiring=(fact("device", "/units", "CAN"),))
    assert (mover.thing, names(mover.commands)) == (Thing.HEAD, ["/a_controller/command"])


def test_a_command_may_have_the_type_of_a_joystick():
    sent = "/fly own own\n    sub /joy sensor_msgs/Joy\n    pub /dji_sdk/setpoint sensor_msgs/Joy\n"
    mover = the_mover(sent)
    assert [(each.name, each.hops) for each in mover.commands] == [
        ("/dji_sdk/setpoint", 0),
        ("/joy", 1),
    ]


def test_a_stop_that_nobody_here_obeys_is_no_line():
    sent = "/base_driver own own\n    pub /e_stop std_msgs/msg/Bool\n"
    assert inventory(sent) == ()


def test_a_node_that_is_called_a_driver_obeys_what_is_called_a_command():
    text = "/motor_controller own own\n    sub /motors own/Pair\n"
    assert names(the_mover(text).commands) == ["/motors"]
    assert inventory(text.replace("motor_controller", "listener")) == ()


def test_what_a_controller_tells_is_no_command():
    text = "/state own control/Plugin own\n    pub /robot_mode own/Mode\n"
    text += "/helper driver own\n    sub /robot_mode own/Mode\n"
    graph = small_graph(text.replace(" control/Plugin", ""))
    assert names(take_inventory(app_facts(graph))[0].commands) == ["/robot_mode"]
    nodes = tuple(
        replace(each, executable="control/Plugin") if each.name == "/state" else each
        for each in graph.nodes
    )
    assert take_inventory(app_facts(replace(graph, nodes=nodes))) == ()


def test_a_viewers_button_for_what_is_not_there_is_no_line():
    goal = "    client /navigate_to_pose nav2_msgs/action/NavigateToPose\n"
    assert inventory("/rviz rviz2 third_party\n" + goal) == ()
    assert inventory("/mission own own\n" + goal) != ()


def test_what_no_autopilot_here_obeys_is_a_line_all_the_same():
    sent = "/fly own own\n    pub /fmu/in/offboard_control_mode px4_msgs/msg/OffboardControlMode\n"
    assert the_mover(sent).thing is Thing.MODE


def test_what_a_receiver_with_a_device_sends_is_a_command():
    remote = f"/remote own own\n    pub /cmd_vel {TWIST}\n"
    mover = the_mover(remote + BASE, wiring=(fact("device", "/remote", "serial port"),))
    assert (names(mover.commands), mover.commands[0].senders) == (["/cmd_vel"], ("/remote",))


def test_a_word_within_a_word_makes_no_listener():
    flight = BASE.replace("/base", "/flight_controller")
    assert the_mover(flight).drivers == ("/flight_controller",)
    assert inventory(BASE.replace("/base", "/status_light").replace("driver", "own")) == ()


def test_a_server_of_the_driver_is_a_door():
    web = fact("socket", "/base", "web server")
    assert the_mover(BASE, wiring=(web,)).doors == ("/base (web server)",)


def test_of_what_is_told_once_nobody_asks_whether_it_stops():
    land = "/base driver own\n    sub /land std_msgs/msg/Empty\n"
    assert the_mover(land).stop == ""


BOX = tuple(
    Service(node=node, name=f"{node}/{name}", type="std_srvs/srv/Trigger")
    for node, name in (
        ("/box", "play"),
        ("/box", "get_mode"),
        ("/box", "power_on"),
        ("/ui", "play"),
    )
)
BESIDE = "/box driver own\n/ui driver own\n"


def test_what_a_node_with_a_device_offers_beside_a_service_that_moves_something_may_move_it():
    sdk = (fact("device", "/box", "vendor SDK"),)
    listed = inventory(BESIDE, services=BOX, wiring=sdk)
    assert [names(mover.commands) for mover in listed] == [["/box/play"], ["/box/power_on"]]
    assert [names(mover.commands) for mover in inventory(BESIDE, services=BOX)] == [
        ["/box/power_on"]
    ]
    silent = tuple(each for each in BOX if each.name != "/box/power_on")
    assert inventory(BESIDE, services=silent, wiring=sdk) == ()


def test_what_hardware_of_ros2_control_offers_may_move_it_too():
    host = Service(node="/hw", name="/switch", type="controller_manager_msgs/srv/SwitchController")
    offered = tuple(
        Service(node="/server", name=f"/server/{name}", type="arm_msgs/srv/Set")
        for name in ("set_joint_stiffness", "set_load", "get_load")
    )
    graph = small_graph("/hw hw own\n/server hw own\n", services=(host, *offered))
    inside = tuple(
        replace(node, process="/hw" if node.name == "/server" else "") for node in graph.nodes
    )
    for nodes, listed in (
        (graph.nodes, ["set_joint_stiffness"]),
        (inside, ["set_joint_stiffness", "set_load"]),
    ):
        movers = take_inventory(app_facts(replace(graph, nodes=nodes)))
        found = [name for mover in movers for name in names(mover.commands)]
        assert found == [*(f"/server/{name}" for name in listed), "/switch"]


@pytest.mark.parametrize(("link", "listed"), [("vehicle link", 2), ("serial port", 1)])
def test_an_autopilot_with_a_camera_is_no_sensor(link, listed):
    text = "/drone driver own\n    pub /front sensor_msgs/msg/Image\n"
    offered = tuple(
        Service(node="/drone", name=name, type="dji/srv/Task") for name in ("/takeoff", "/joystick")
    )
    movers = inventory(text, services=offered, wiring=(fact("device", "/drone", link),))
    assert sum(len(mover.commands) for mover in movers) == listed


RVIZ = "/rviz rviz2 third_party\n"


def test_what_a_viewer_alone_offers_or_calls_moves_nothing():
    services = (Service(node="/rviz", name="/rviz/move", type="std_srvs/srv/Empty"),)
    clients = (ServiceClient(node="/rviz", name="/rviz/go", type="std_srvs/srv/Empty"),)
    assert inventory(RVIZ, services=services, clients=clients) == ()
    own = (replace(services[0], node="/base"), *services)
    assert names(the_mover(RVIZ + BASE, services=own).commands) == ["/cmd_vel", "/rviz/move"]


def test_a_request_whose_last_name_alone_is_known_counts():
    def service(name):
        return (Service(node="/base", name=name, type="std_srvs/srv/Trigger"),)

    assert names(the_mover(BASE, services=service("/{ns}/brake")).commands) == [
        "/cmd_vel",
        "/{ns}/brake",
    ]
    assert names(the_mover(BASE, services=service("/base/{what}")).commands) == ["/cmd_vel"]


def test_a_driver_takes_goals_whatever_their_name():
    action = "    server /wiggle own_msgs/action/Wiggle\n"
    assert names(the_mover(BASE + action).commands) == ["/cmd_vel", "/wiggle"]
    assert inventory("/other other own\n" + action) == ()


def test_whatever_a_controller_offers_may_move_something():
    services = (Service(node="/fault", name="/fault/reset_fault", type="std_srvs/srv/Trigger"),)
    graph = small_graph("/fault fault third_party\n", services=services)
    assert take_inventory(app_facts(graph)) == ()
    graph = with_program(graph, "/fault", "faults", "faults/FaultController")
    (mover,) = take_inventory(app_facts(graph))
    assert (mover.thing, mover.drivers) == (Thing.DEVICE, ("/fault",))


def test_what_a_controller_sends_to_another_is_a_command():
    topic = "/leader/joint_trajectory trajectory_msgs/msg/JointTrajectory\n"
    graph = small_graph(f"/leader l own\n    pub {topic}/arm a own\n    sub {topic}")
    for node in ("/leader", "/arm"):
        graph = with_program(graph, node, "controllers", "controllers/Controller")
    (mover,) = take_inventory(app_facts(graph))
    assert (mover.drivers, names(mover.commands)) == (("/arm",), ["/leader/joint_trajectory"])


def test_a_person_moves_a_marker():
    text = f"""
/marker m third_party
    sub /marker/feedback visualization_msgs/msg/InteractiveMarkerFeedback
    pub /cmd_vel {TWIST}
"""
    mover = the_mover(text + BASE)
    assert names(mover.commands) == ["/cmd_vel", "/marker/feedback"]


def test_hardware_stands_in_the_process_of_its_manager_whatever_that_calls_itself():
    switch = "controller_manager_msgs/srv/SwitchController"
    services = (
        Service(node="/manager", name="/manager/switch_controller", type=switch),
        Service(node="/units", name="/units/reboot", type="x/srv/Reboot"),
        Service(node="/units", name="/units/wiggle", type="std_srvs/srv/SetBool"),
    )
    graph = small_graph("/manager m third_party\n/units s third_party\n", services=services)
    assert "/units/wiggle" not in all_names(graph)
    nodes = tuple(replace(node, process="/ros2_control_node") for node in graph.nodes)
    assert "/units/wiggle" in all_names(replace(graph, nodes=nodes))


def all_names(graph):
    movers = take_inventory(app_facts(graph))
    return [name for mover in movers for name in names(mover.commands)]


@pytest.mark.parametrize(
    ("package", "thing"), [("twist_controller", Thing.ARM), ("diff_drive_controller", Thing.BASE)]
)
def test_a_controller_of_no_base_moves_the_arm_beside_it(package, thing):
    text = f"/twist t own\n    sub /twist/commands {TWIST}\n"
    graph = with_program(small_graph(text), "/twist", package, f"{package}/Controller")
    (mover,) = take_inventory(app_facts(graph))
    assert mover.thing is Thing.BASE
    arm = "/arm a own\n    sub /arm/joint_trajectory trajectory_msgs/msg/JointTrajectory\n"
    graph = with_program(small_graph(text + arm), "/twist", package, f"{package}/Controller")
    graph = with_program(graph, "/arm", *JOINTS)
    movers = [(each.drivers, each.thing) for each in take_inventory(app_facts(graph))]
    assert {(("/twist",), thing), (("/arm",), Thing.ARM)} <= {*movers}
    graph = with_program(small_graph(TWO_DRIVERS + arm), "/arm", *JOINTS)
    things = [each.thing for each in take_inventory(app_facts(graph))]
    assert things == [Thing.BASE, Thing.ARM, Thing.LIMITS]


@pytest.mark.parametrize(
    ("node", "package"),
    [
        ("/navsat/nmea_serial_node", "nmea_comms"),
        ("/rosserial_message_info", "rosserial_python"),
        ("/espeak_node", "espeak"),
        ("/e_stop", "rover_drive_system"),
    ],
)
def test_a_sensor_that_was_not_read_moves_nothing(node, package):
    text = f"{node} {package} third_party\n"
    assert inventory(text + FIRMWARE, unread=(node,)) == ()
    found = inventory(text + FIRMWARE, unread=(node, "/firmware"))
    assert [each.drivers for each in found] == [("/firmware",)]
    found = inventory(TWO_DRIVERS + text + FIRMWARE, unread=(node, "/firmware"))
    assert found[0].unread == ("/firmware",)


def test_a_server_of_goals_takes_them_from_a_topic_too():
    text = """
/navigator n third_party
    server /navigate_to_pose nav2_msgs/action/NavigateToPose
    sub /goal_pose geometry_msgs/msg/PoseStamped
    sub /scan sensor_msgs/msg/LaserScan
"""
    mover = the_mover(text)
    assert names(mover.commands) == ["/navigate_to_pose", "/goal_pose"]
    assert names(mover.last_commands) == ["/navigate_to_pose"]
    assert mover.arbiters == ()


def test_a_mode_that_a_node_sets_by_a_service_is_a_switch():
    text = "/pilot p own\n    sub /set_boat_mode std_msgs/msg/String\n    sub /joy_mode p/msg/Joy\n"
    client = ServiceClient(node="/pilot", name="/mavros/set_mode", type="mavros_msgs/srv/SetMode")
    assert inventory(text) == ()
    mover = the_mover(text, clients=(client,))
    assert mover.thing is Thing.MODE
    assert names(mover.commands) == ["/mavros/set_mode"]


@pytest.mark.parametrize(
    ("topic", "type", "listed"),
    [
        ("/actuators/gripper1/set_angle", "std_msgs/msg/UInt16", True),
        ("/gripper/angle", "std_msgs/msg/UInt16", True),
        ("/gripper/set_angle", "std_msgs/msg/String", False),
        ("/camera/set_exposure", "std_msgs/msg/UInt16", False),
    ],
)
def test_a_number_that_sets_a_part_of_the_robot_leaves_the_app(topic, type, listed):
    found = inventory(f"/mission p own\n    pub {topic} {type}\n")
    assert [mover.thing for mover in found] == [Thing.GRIPPER] * listed


def test_a_light_with_a_device_obeys_no_mode():
    text = "/battery p own\n    pub /low_voltage_mode std_msgs/msg/Bool\n"
    text += "/led_node p own\n    sub /low_voltage_mode std_msgs/msg/Bool\n"
    assert inventory(text, wiring=(fact("device", "/led_node", "serial port"),)) == ()


SERVED_BY_OTHERS = {
    "/torpedo_detector": "/torpedo/enable",
    "/publisher": "/toggle_bin_trajectory",
    "/status": "/advertise_shutdown",
    "/frames": "/set_transform_torpedo_frame",
    "/tools": "/purge_commands",
}


def set_bool(node, name):
    return Service(node=node, name=name, type="std_srvs/srv/SetBool")


@pytest.mark.parametrize("node", SERVED_BY_OTHERS)
def test_services_of_what_only_sees_or_shows_move_nothing(node):
    services = (set_bool(node, SERVED_BY_OTHERS[node]),)
    assert inventory(f"{node} own own\n", services=services) == ()


def test_who_calls_a_service_of_his_own_leaves_it_open():
    sides = {"node": "/base", "name": "/set_motor_power", "type": "std_srvs/srv/SetBool"}
    (mover,) = inventory(BASE, services=(Service(**sides),), clients=(ServiceClient(**sides),))[1:]
    assert names(mover.open_commands) == ["/set_motor_power"]


def test_a_vague_service_of_who_commands_or_was_not_read_moves_something():
    services = (set_bool("/teleop", "/toggle_trajectory"),)
    found = inventory(TWO_DRIVERS + BASE, services=services)
    assert "/toggle_trajectory" in [name for m in found for name in names(m.commands)]
    services = (set_bool("/firmware", "/toggle_trajectory"),)
    assert inventory(FIRMWARE, services=services, unread=("/firmware",))


def test_who_commands_takes_goals_whatever_their_name():
    action = "    server /wiggle own_msgs/action/Wiggle\n"
    found = inventory(TWO_DRIVERS + action + BASE)
    assert "/wiggle" in [name for mover in found for name in names(mover.commands)]


def test_an_action_that_executes_something_moves_something():
    action = "    server /programs/execute_program own_msgs/action/ExecuteProgram\n"
    assert names(the_mover("/programs programs own\n" + action).commands) == [
        "/programs/execute_program"
    ]


@pytest.mark.parametrize("name", ["calibrate_motors", "factory_calibrate_joints"])
def test_what_calibrates_motors_moves_them(name):
    services = (Service(node="/hw", name=f"/hw/{name}", type="std_srvs/srv/Trigger"),)
    facts = (fact("device", "/hw", "serial port"),)
    assert inventory("/hw hw own\n", services=services, wiring=facts)


JOYSTICK = f"/joystick own own\n    sub /joy sensor_msgs/Joy\n    pub /cmd_vel {TWIST}\n"


@pytest.mark.parametrize(
    ("topic", "type"),
    [
        ("/ServoPose", "std_msgs/Int16MultiArray"),
        ("/picker/gripper", "std_msgs/Bool"),
        ("/picker/gripper_tilt", "std_msgs/Float32"),
    ],
)
def test_what_a_commander_sends_to_nobody_here_leaves_the_app(topic, type):
    found = inventory(JOYSTICK + f"    pub {topic} {type}\n" + BASE)
    assert topic in [name for mover in found for name in names(mover.commands)]


@pytest.mark.parametrize("topic", ["/wheel_speed_error", "/gripper_closed", "/debug_servo"])
def test_what_a_commander_only_tells_stays(topic):
    type = "std_msgs/Bool" if "closed" in topic else "std_msgs/Float32"
    found = inventory(JOYSTICK + f"    pub {topic} {type}\n" + BASE)
    assert [name for mover in found for name in names(mover.commands)] == ["/cmd_vel", "/joy"]


def test_a_debugged_twist_is_no_command():
    assert inventory(f"/nav nav own\n    pub /debug_target_twist {TWIST}\n") == ()


def test_a_driver_obeys_no_alarms_and_no_battery():
    hears = "    sub /alarms/report own_msgs/Report\n    sub /battery own_msgs/Battery\n"
    found = inventory(TWO_DRIVERS + BASE + hears, wiring=(fact("device", "/base", "CAN"),))
    assert [name for mover in found for name in names(mover.commands)] == ["/cmd_vel"]


def test_a_service_of_an_own_node_that_commands_may_move_something():
    services = tuple(
        Service(node="/teleop", name=f"/{name}", type="own_msgs/srv/Do")
        for name in ("do_barrel_roll", "set_depth", "get_depth", "compute_depth", "log")
    )
    found = inventory(TWO_DRIVERS + BASE, services=services)
    served = [c.name for m in found for c in m.commands if c.means is Means.SERVICE]
    assert served == ["/do_barrel_roll", "/set_depth"]
    others = inventory((TWO_DRIVERS + BASE).replace(" own", " third_party"), services=services)
    assert not [c for m in others for c in m.commands if c.means is Means.SERVICE]


def test_what_a_driver_of_services_tells_is_no_command_behind_others():
    tells = "/arm arm own\n    pub /tools/motor own_msgs/Motor\n"
    pilot = f"/pilot own own\n    sub /tools/motor own_msgs/Motor\n    pub /cmd_vel {TWIST}\n"
    services = (Service(node="/arm", name="/arm/open_gripper", type="own_msgs/srv/Open"),)
    facts = (fact("device", "/arm", "servo bus"),)
    found = inventory(tells + pilot + BASE, services=services, wiring=facts)
    assert "/tools/motor" not in [name for mover in found for name in names(mover.commands)]


@pytest.mark.parametrize("name", ["set_color", "set_effect", "purge_logs_on_startup"])
def test_a_service_of_lights_or_logs_moves_nothing(name):
    services = (Service(node="/base", name=f"/{name}", type="own_msgs/srv/Set"),)
    assert names(the_mover(TWO_DRIVERS + BASE, services=services).commands) == ["/cmd_vel"]


def test_a_goal_by_gps_was_not_measured():
    action = "    server /gps_goal own_msgs/action/GpsGoal\n"
    found = inventory(TWO_DRIVERS + action + BASE)
    assert "/gps_goal" in [name for mover in found for name in names(mover.commands)]


TWO_PARTS = BASE + "    sub /arm/goal own/msg/Arm\n    sub /flaps own/msg/Flaps\n"


def test_what_a_driver_of_several_things_hears_has_a_line_of_its_own_where_no_word_tells():
    movers = inventory(TWO_PARTS, wiring=(fact("device", "/base", "CAN"),))
    assert {mover.thing: names(mover.commands) for mover in movers} == {
        Thing.BASE: ["/cmd_vel"],
        Thing.ARM: ["/arm/goal"],
        Thing.DEVICE: ["/flaps"],
    }


def test_a_joystick_moves_nothing_where_what_is_made_of_it_reaches_nobody():
    text = "/demux own own\n    pub /arm/joy own/Joy\n/teleop own own\n    sub /arm/joy own/Joy\n"
    assert inventory(text) == ()
    facts = (fact("device", "/teleop", "CAN"),)
    assert names(the_mover(text, wiring=facts).commands) == ["/arm/joy"]


def test_a_goal_to_wait_moves_nothing():
    assert inventory("/nav nav own\n    server /wait nav2_msgs/action/Wait\n") == ()


@pytest.mark.parametrize(
    ("topic", "type", "thing"),
    [
        ("/arduino/pwm", "own/PWM", Thing.BASE),
        ("/lift", "std_msgs/Float32", Thing.TOOL),
        ("/plan", "own/Plan", None),
        ("/distance", "std_msgs/Float32", None),
        ("/goal_pose", "geometry_msgs/Pose", None),
        ("/motor_status", "own/Status", None),
        ("/wheel_speed_debug", "std_msgs/Float32", None),
    ],
)
@pytest.mark.parametrize("package", ["rosserial_arduino", "micro_ros_agent"])
def test_what_nobody_that_was_read_hears_goes_to_firmware(topic, type, thing, package):
    text = f"{JOYSTICK}    pub {topic} {type}\n/board {package} third_party\n"
    movers = {
        tuple(names(each.last_commands)): each for each in inventory(text, unread=("/board",))
    }
    others = {topic: mover for topics, mover in movers.items() for topic in topics}
    assert (others[topic].thing if topic in others else None) is thing
    assert thing is None or others[topic].unread == ("/board",)
    plain = inventory(text.replace(package, "own"), unread=("/board",))
    told = {name for mover in plain for name in names(mover.last_commands)}
    assert topic not in told or topic == "/lift"


def test_a_joystick_of_an_own_type_stands_behind_what_is_made_of_it():
    text = "/format own own\n    sub /joy sensor_msgs/Joy\n    pub /formatted own/Joy\n"
    teleop = f"/teleop own own\n    sub /formatted own/Joy\n    pub /cmd_vel {TWIST}\n"
    hops = {each.name: each.hops for each in the_mover(text + teleop + BASE).commands}
    assert hops == {"/cmd_vel": 0, "/formatted": 1, "/joy": 2}


@pytest.mark.parametrize(
    ("topic", "type", "is_button"),
    [
        ("/go_home_button", "std_msgs/Bool", True),
        ("/goal_name", "std_msgs/String", False),
        ("/mission/command_json", "std_msgs/String", True),
        ("/cloud/action", "std_msgs/String", True),
    ],
)
def test_signals_by_which_callers_are_told_stand_behind_what_they_call(topic, type, is_button):
    text = f"/phone own own\n    sub {topic} {type}\n    client /pick own/action/Pick\n"
    mover = the_mover(text + "/arm own own\n    server /pick own/action/Pick\n")
    assert {each.name: each.hops for each in mover.commands} == {"/pick": 0} | (
        {topic: 1} if is_button else {}
    )


def test_services_beside_one_that_moves_something_move_what_their_node_connects_to():
    offered = tuple(
        Service(node="/robot", name=f"/robot/{name}", type="std_srvs/srv/Trigger")
        for name in ("home", "move_arm", "get_pose")
    )
    told = ["/robot/move_arm"]
    assert names(the_mover("/robot own own\n", services=offered).commands) == told
    link = (fact("device", "/robot", "TCP link"),)
    movers = inventory("/robot own own\n", services=offered, wiring=link)
    assert {name for mover in movers for name in names(mover.commands)} == {*told, "/robot/home"}
    hears = f"/cloud own own\n    sub /cmd_vel {TWIST}\n    sub /legs std_msgs/String\n"
    cloud = (fact("device", "/cloud", "TCP link"),)
    movers = inventory(TWO_DRIVERS + BASE + hears, wiring=cloud)
    assert {name for mover in movers for name in names(mover.commands)} == {"/cmd_vel"}


def test_what_was_not_read_may_stop():
    unread = "/one one third_party\n"
    assert the_mover(TWO_DRIVERS + unread, unread=("/one",)).stop == "what obeys was not read"


def test_a_pose_on_a_path_is_what_its_follower_is_told():
    poses = "    sub /path_pose geometry_msgs/Pose\n    sub /robot_pose geometry_msgs/Pose\n"
    mover = the_mover(f"/go own own\n{poses}    pub /cmd_vel {TWIST}\n" + BASE)
    assert names(mover.commands) == ["/cmd_vel", "/path_pose"]


KEYED = f"""
/gate gate own
    sub /nav_vel {TWIST}
    sub /state_json std_msgs/msg/String
    pub /cmd_vel {TWIST}
/mission mission own
    pub /state_json std_msgs/msg/String
"""


def flowing(text, *flows):
    """Return the only thing that moves, where each topic leads to others by its node's source."""
    graph = small_graph(text)
    places = {each: Evidence(file="n.py", line=n) for n, each in enumerate(graph.endpoints)}
    at = {(e.topic, e.direction.value): place for e, place in places.items()}
    facts = tuple(
        replace(
            fact("message_flow", "/n", ""),
            evidence=(at[topic, "subscribe"], *(at[each, "publish"] for each in led)),
        )
        for topic, *led in flows
    )
    ends = tuple(replace(each, evidence=(place,)) for each, place in places.items())
    return take_inventory(app_facts(replace(graph, endpoints=ends, wiring=facts)))


def test_what_makes_a_node_send_commands_is_behind_them():
    (mover,) = flowing(KEYED + BASE, ("/state_json", "/cmd_vel"))
    assert names(mover.commands) == ["/cmd_vel", "/nav_vel", "/state_json"]
    assert mover.commands[2].senders == ("/mission",)
    (mover,) = flowing(KEYED + BASE)
    assert names(mover.commands) == ["/cmd_vel", "/nav_vel"]


def test_what_a_driver_answers_is_behind_no_command():
    answer = KEYED.replace("/mission mission", "/base base").replace(
        "    pub /state_json", f"    sub /cmd_vel {TWIST}\n    pub /state_json"
    )
    (mover,) = flowing(answer, ("/state_json", "/cmd_vel"))
    assert names(mover.commands) == ["/cmd_vel", "/nav_vel"]


def test_what_is_not_used_is_no_way_in():
    (mover,) = flowing(KEYED + BASE, ("/nav_vel",))
    assert names(mover.commands) == ["/cmd_vel"]
    second = BASE.replace("/base base", "/idle idle")
    (mover,) = flowing(KEYED + second, ("/cmd_vel",))
    assert mover.drivers == ()


def test_what_makes_a_node_call_a_service_is_behind_it():
    text = "/gate gate own\n    sub /order_json std_msgs/msg/String\n"
    sides = {"name": "/set_blade", "type": "x/srv/SetBlade"}
    graph = small_graph(
        text,
        services=(Service(node="/base", **sides),),
        clients=(ServiceClient(node="/gate", **sides),),
    )
    ends = tuple(replace(each, evidence=PLACE) for each in graph.endpoints)
    flow = replace(fact("message_flow", "/gate", ""), others=("/set_blade",))
    (mover,) = take_inventory(app_facts(replace(graph, endpoints=ends, wiring=(flow,))))
    assert names(mover.commands) == ["/set_blade", "/order_json"]
    (mover,) = take_inventory(app_facts(replace(graph, endpoints=ends)))
    assert names(mover.commands) == ["/set_blade"]


@pytest.mark.parametrize(("value", "count"), [("device", 1), ("", 0)])
def test_what_is_seen_to_go_to_a_device_is_no_report_of_another_with_an_open_port(value, count):
    graph = small_graph(
        "/arm arm own\n    sub /sprayer std_msgs/msg/Float32\n"
        "/pad pad own\n    sub /joy sensor_msgs/msg/Joy\n    pub /sprayer std_msgs/msg/Float32\n"
    )
    ends = tuple(replace(each, evidence=PLACE) for each in graph.endpoints if each.topic != "/joy")
    joy = tuple(each for each in graph.endpoints if each.topic == "/joy")
    facts = (
        fact("device", "/arm", "serial port"),
        fact("device", "/pad", "serial port"),
        fact("message_flow", "/arm", value),
    )
    movers = take_inventory(app_facts(replace(graph, endpoints=(*ends, *joy), wiring=facts)))
    listed = [mover for mover in movers if "/arm" in mover.drivers]
    assert [names(mover.last_commands) for mover in listed] == [["/sprayer"]] * count


@pytest.mark.parametrize(("type", "stops"), [("x/msg/Frame", Stops.NO), ("String", Stops.UNKNOWN)])
def test_a_text_to_a_device_may_be_told_once(type, stops):
    type = type if "/" in type else "std_msgs/msg/String"
    text = f"/base driver own\n    sub /json_cmd {type}\n"
    assert the_mover(text, wiring=(DRIVER, KEPT, WRITTEN)).stops is stops


def test_who_commands_others_is_no_hardware_that_moves_by_itself():
    text = f"/chase chase own\n    pub /cmd_vel {TWIST}\n" + BASE
    board = (fact("device", "/chase", "servo driver"),)
    (mover,) = inventory(text, wiring=board)
    assert mover.drivers == ("/base",)


@pytest.mark.parametrize(
    ("value", "sent", "count"),
    [
        ("library pantilthat", "", 1),
        ("library pantilthat", "    pub /joint_states sensor_msgs/msg/JointState\n", 1),
        ("", "", 0),
    ],
)
def test_what_an_unknown_library_gets_moves_what_its_name_says(value, sent, count):
    text = "/mount mount own\n    sub /pan_tilt/values geometry_msgs/msg/Point\n"
    graph = small_graph(text + sent)
    ends = tuple(replace(each, evidence=PLACE) for each in graph.endpoints)
    flow = fact("message_flow", "/mount", value)
    movers = take_inventory(app_facts(replace(graph, endpoints=ends, wiring=(flow,))))
    assert [mover.thing for mover in movers if mover.drivers] == [Thing.HEAD] * count


DEAD_END = f"""
/behaviors behaviors third_party
    pub /cmd_vel_blocked {TWIST}
/nav nav own
    pub /cmd_vel {TWIST}
"""


def test_a_velocity_that_nobody_obeys_beside_a_driver_is_a_dead_end():
    spin = Action(
        node="/behaviors", name="/spin", type="nav2_msgs/action/Spin", role=ActionRole.SERVER
    )
    mover = the_mover(DEAD_END + BASE, actions=(spin,), wiring=(DRIVER,))
    assert names(mover.commands) == ["/cmd_vel"]
    both = inventory(DEAD_END + BASE, actions=(spin,))  # the base may be elsewhere
    assert {"/cmd_vel_blocked", "/spin"} <= {c.name for each in both for c in each.commands}


def test_one_order_for_the_parts_of_a_robot_is_a_line_for_each():
    text = "/mission own own\n    pub /units/command own/Command\n"
    lift = "/lift_unit own own\n    sub /units/command own/Command\n"
    facts = tuple(fact("device", node, "CAN") for node in ("/lift_unit", "/wheel_unit"))
    assert the_mover(text + lift, wiring=facts[:1]).thing is Thing.TOOL
    both = text + lift + lift.replace("lift", "wheel")
    found = {each.thing: each.drivers for each in inventory(both, wiring=facts)}
    assert found == {Thing.DEVICE: ("/wheel_unit",), Thing.TOOL: ("/lift_unit",)}


@pytest.mark.parametrize(
    ("topics", "thing"),
    [
        ("", Thing.SERVOS),
        ("    sub /arm_control x/msg/Arm\n", Thing.ARM),
        ("    sub /drive_train x/msg/DriveTrain\n", Thing.SERVOS),
    ],
)
def test_what_servos_move_is_what_stands_behind_them(topics, thing):
    text = f"/mixer mixer own\n    pub /servo_commands x/msg/ServoCommand\n{topics}"
    text += "/servos servos own\n    sub /servo_commands x/msg/ServoCommand\n"
    assert the_mover(text, wiring=(fact("device", "/servos", "I2C"),)).thing is thing


def test_who_is_commanded_by_a_person_is_said():
    facts = (fact("operator", "/teleop", "joystick"), fact("operator", "/other", "window"))
    mover = the_mover(TWO_DRIVERS + BASE + "/other other own\n", wiring=facts)
    assert mover.operators == ("/teleop (joystick)",)
    pilot = (fact("device", "/pilot", "vehicle link"), fact("operator", "/pilot", "keyboard"))
    assert the_mover("/pilot pilot own\n", wiring=pilot).operators == ("/pilot (keyboard)",)


@pytest.mark.parametrize(
    ("signal", "found"),
    [("/flip", True), ("/led", False), ("/record", False)],
)
def test_a_signal_to_a_driver_from_who_commands_it_is_a_command(signal, found):
    text = f"/pad pad own\n    pub /cmd_vel {TWIST}\n    pub {signal} std_msgs/msg/Bool\n"
    sub = f"    sub {signal} std_msgs/msg/Bool\n"
    mover = the_mover(text + BASE + sub, wiring=(DRIVER,))
    assert (signal in names(mover.last_commands)) is found


def test_a_controller_of_trajectories_takes_its_gains_while_it_runs():
    topic = "/arm/joint_trajectory trajectory_msgs/msg/JointTrajectory"
    text = f"/arm joint_trajectory_controller third_party\n    sub {topic}\n"
    limits = inventory(text)[-1]
    assert (limits.thing, names(limits.commands)) == (Thing.LIMITS, ["/arm/set_parameters"])


def test_a_stop_that_no_driver_obeys_is_told_so():
    text = "/monitor own own\n    sub /estop std_msgs/msg/Bool\n"
    assert the_mover(text).effect == "no driver obeys it: /monitor decides what stops"
    board = (fact("device", "/monitor", "GPIO"),)
    assert the_mover(text, wiring=board).effect == ""
    assert the_mover(text, unread=("/monitor",)).effect == ""
    assert the_mover(TWO_DRIVERS + BASE).effect == ""


@pytest.mark.parametrize(
    ("topic", "type", "stops"),
    [
        ("/arm/commands", "std_msgs/msg/Float64MultiArray", Stops.UNKNOWN),
        ("/arm/velocity_commands", "std_msgs/msg/Float64MultiArray", Stops.NO),
        ("/forward_position_controller/commands", "std_msgs/msg/Float64", Stops.UNKNOWN),
        ("/steering/command", "std_msgs/msg/Int16", Stops.UNKNOWN),
        ("/lift/height", "std_msgs/msg/Float32", Stops.UNKNOWN),
        ("/lift/level", "std_msgs/msg/Float32", Stops.UNKNOWN),
        ("/shovel_position", "std_msgs/msg/Float32", Stops.UNKNOWN),
        ("/blade_rotation", "std_msgs/msg/Float32", Stops.NO),
        ("/four_wheel_steer/command", "x/msg/DriveCommand", Stops.NO),
        ("/scaled_vel_joint_traj_controller/command", "std_msgs/msg/Float64", Stops.UNKNOWN),
        ("/motor_command", "std_msgs/msg/Float32", Stops.NO),
        ("/arm/joint_trajectory", "trajectory_msgs/msg/JointTrajectory", Stops.UNKNOWN),
        ("/arm/servo_position", "std_msgs/msg/Float64", Stops.UNKNOWN),
        ("/position/cmd_vel", TWIST, Stops.NO),
        ("/arm/joint_speed", "trajectory_msgs/msg/JointTrajectory", Stops.NO),
        ("/radio/send", "x/msg/Frame", Stops.UNKNOWN),
        ("/radio/command", "x/msg/Frame", Stops.NO),
    ],
)
def test_what_is_told_where_to_go_ends_there(topic, type, stops):
    mover = the_mover(f"/base driver own\n    sub {topic} {type}\n", wiring=(DRIVER, KEPT, WRITTEN))
    assert mover.stops is stops
    assert bool(mover.stop) is (stops is Stops.NO)


def flow(node, topic, *others):
    """Return that a node's source hands on what it gets on a topic, or asks others for it."""
    places = (Evidence(file=node, line=len(topic)),)
    return replace(fact("message_flow", node, ""), evidence=places, others=others)


@pytest.mark.parametrize(
    ("topic", "type", "wiring", "is_listed"),
    [
        ("/joy", "sensor_msgs/msg/Joy", (DRIVER, WRITTEN), True),
        ("/cable", "x/msg/Cable", (DRIVER, WRITTEN), True),
        ("/cable", "std_msgs/msg/Int32", (DRIVER, WRITTEN), True),
        ("/cable", "x/msg/Cable", (DRIVER,), False),
        ("/cable", "x/msg/Cable", (WRITTEN,), True),
        ("/cable", "x/msg/Cable", (DRIVER, fact("message_flow", "/base", "")), False),
        ("/cable", "x/msg/Cable", (DRIVER, fact("message_flow", "/base", "library lcd")), False),
        ("/rtcm", "rtcm_msgs/msg/Message", (DRIVER, WRITTEN), False),
    ],
)
def test_what_goes_from_a_topic_to_hardware_alone_is_a_command(topic, type, wiring, is_listed):
    listed = inventory(f"/base driver own\n    sub {topic} {type}\n", wiring=wiring)
    assert [names(mover.commands) for mover in listed] == [[topic]] * is_listed


@pytest.mark.parametrize("called", ["/bus", "/other"])
def test_hardware_that_is_called_because_of_a_command_is_listed_with_its_service(called):
    text = f"/wheels driver own\n    sub /cmd_vel {TWIST}\n/board board own\n"
    services = (Service(node="/board", name="/bus", type="x/srv/Frame"),)
    wiring = (fact("device", "/board", "I2C"), replace(flow("/wheels", "", called), evidence=PLACE))
    listed = inventory(text, services=services, wiring=wiring)
    assert [names(m.commands) for m in listed] == [["/cmd_vel"], ["/bus"]][: 1 + (called == "/bus")]


@pytest.mark.parametrize(
    ("beside", "is_listed"),
    [
        ((), False),
        ((fact("operator", "/base", "keyboard"),), True),
        ((fact("socket", "/base", "web server"),), True),
        ((fact("device", "/base", "PWM output"),), True),
    ],
)
def test_hardware_without_commands_that_a_person_or_a_network_reaches_or_that_only_moves(
    beside, is_listed
):
    moves = fact("self_motion", "/base", "CAN")
    assert bool(inventory("/base driver own\n", wiring=(DRIVER, moves, *beside))) is is_listed
    assert inventory("/base driver own\n", wiring=(DRIVER, *beside)) == ()


@pytest.mark.parametrize(
    ("more", "changes", "unprompted"),
    [
        ("", {}, ("/walk",)),
        ("    sub /bumper sensor_msgs/msg/Range\n", {}, ("/walk",)),
        (f"    sub /goal_vel {TWIST}\n", {}, ()),
        ("", {"wiring": (fact("operator", "/walk", "keyboard"),)}, ()),
        ("", {"wiring": (fact("device", "/walk", "serial port"),)}, ()),
        ("", {"services": (Service(node="/walk", name="/start", type="x/srv/Go"),)}, ()),
        ("", {"unread": ("/walk",)}, ()),
    ],
)
def test_who_commands_though_nobody_tells_it_to(more, changes, unprompted):
    text = f"/walk walk own\n    pub /cmd_vel {TWIST}\n{more}{BASE}"
    (mover, *_) = (each for each in inventory(text, **changes) if each.thing is Thing.BASE)
    assert mover.unprompted == unprompted
    rows = [row.text for row in mover_rows(mover)]
    told = "nothing in the source tells /walk to send: it may begin when the app starts"
    assert (told in rows) is bool(unprompted)


@pytest.mark.parametrize(
    ("topic", "wiring", "is_listed"),
    [
        ("/distances", (fact("device", "/base", "GPIO"),), False),
        ("/distances", (), True),
        ("/drive_vel", (fact("device", "/base", "GPIO"),), True),
    ],
)
def test_a_velocity_of_hardware_that_nobody_hears_needs_a_name_to_be_a_command(
    topic, wiring, is_listed
):
    assert bool(inventory(f"/base base own\n    pub {topic} {TWIST}\n", wiring=wiring)) is is_listed


@pytest.mark.parametrize(("unread", "is_told"), [((), True), (("/serial_node",), False)])
def test_another_sketch_than_the_one_that_was_read_may_be_flashed(unread, is_told):
    text = f"/serial_node rosserial_python third_party\n    sub /cmd_vel {TWIST}\n"
    mover = next(m for m in inventory(text, 1, unread=unread) if m.thing is Thing.BASE)
    assert any("another may be flashed" in row.text for row in mover_rows(mover)) is is_told
