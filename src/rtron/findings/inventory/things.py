"""Which thing a topic, service or action moves, by its type and by the words of its name."""

import re

from rtron.findings.measurement_names import is_measured
from rtron.vocabulary import normalise_type
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Means, Thing
from rtron.vocabulary.names import EMERGENCY_STOP, snake_case

_TYPES: tuple[tuple[str, Thing], ...] = (
    (r"mavros_msgs/CommandBool", Thing.ARMING),
    (r"mavros_msgs/SetMode|px4_msgs/OffboardControlMode", Thing.MODE),
    (r"mavros_msgs/ParamSet", Thing.LIMITS),
    (r"moveit_msgs/", Thing.ARM),
    (r"mavros_msgs/|px4_msgs/|geographic_msgs/GeoPose", Thing.VEHICLE),
    (
        r"controller_manager_msgs/(?:Switch|Load|Unload|Reload|Configure|Cleanup|SetHardware)",
        Thing.CONTROLLERS,
    ),
    (r"control_msgs/(?:Parallel)?GripperCommand", Thing.GRIPPER),
    (r"nav2_msgs/SpeedLimit|\w+/SpeedLimit", Thing.LIMITS),
    (r"kobuki_msgs/MotorPower", Thing.POWER),
    (r"dynamixel_controllers/(?:Start|Stop|Restart)", Thing.CONTROLLERS),
    (r"nav2_msgs/(?:Toggle|ManageLifecycleNodes)", Thing.CONTROLLERS),
)
"""What a type can only mean."""
_USUAL_TYPES: tuple[tuple[str, Thing], ...] = (
    (r"trajectory_msgs/MultiDOF", Thing.VEHICLE),
    (r"trajectory_msgs/|control_msgs/", Thing.ARM),
    (r"geometry_msgs/Wrench", Thing.THRUSTERS),
    (r"\w+/Twist\w*|ackermann_msgs/|move_base_msgs/|mbf_msgs/|autoware", Thing.BASE),
    (r"dbw_\w+/|tier4_|nav2_msgs/|nav_2d_msgs/|kobuki_msgs/|create_msgs/", Thing.BASE),
    (r"\w+/\w*(?:Motor|Wheel|Drive|Ackermann|Steer)\w*", Thing.BASE),
)
"""What a type mostly means, where the name says nothing."""
_WORDS: tuple[tuple[Thing, str], ...] = (
    (Thing.ARMING, "arming disarm unarm motors_on enable_motors"),
    (Thing.POWER, "power breaker charger poweroff shutdown reboot relay relays battery_switch"),
    (Thing.ARM, "shoulder elbow wrist forearm pick pickup"),
    (Thing.TOOL, "blade mow mower cutter torpedo torpedoes dropper launcher shooter valve pump"),
    (Thing.TOOL, "vacuum spray sprayer brush conveyor winch intake feeder lift magnet vibration"),
    (Thing.HORN, "horn buzzer siren beep"),
    (Thing.GRIPPER, "gripper grippers claw finger fingers hands grasp"),
    (Thing.HEAD, "head pan pano tilt ptz gimbal neck mast camera_control camera_cmd mount_control"),
    (Thing.THRUSTERS, "thruster thrusters thrust propeller propellers rudder sail fin fins"),
    (Thing.VEHICLE, "takeoff land landing rotor rotors drone uav quad rc"),
    (Thing.CONTROLLERS, "switch_controller"),
    (Thing.ARM, "arm moveit cartesian manipulator"),
    (
        Thing.BASE,
        "vel velocity drive chassis wheel wheels motor motors steer steering throttle brake",
    ),
    (Thing.BASE, "speed twist rpm pwm duty curvature ackermann esc gear navigate"),
    (
        Thing.BASE,
        "dock undock goal follow_path spin backup waypoint waypoints walk gait move path go goto",
    ),
    (Thing.SERVOS, "joint joints servo servos leg legs"),
    (Thing.MODE, "mode modes autonomous autonomy manual teleop mission authority"),
    (Thing.DEVICE, "cmd cmds command commands control setpoint setpoints trajectory desired"),
    (Thing.DEVICE, "actuator actuators execute exec"),
)
"""Words in names, the first that is there; the last parts of a name count before the others."""
PARTS = (Thing.HEAD, Thing.GRIPPER, Thing.ARM, Thing.TOOL, Thing.THRUSTERS, Thing.SERVOS)
_GENERIC = frozenset(
    [
        *(
            "goal",
            "go",
            "goto",
            "move",
            "path",
            "speed",
            "motor",
            "motors",
            "pwm",
            "servo",
            "servos",
        ),
        *("servos", "joint", "joints", "leg", "legs"),
    ]
)
"""What any part of a robot may have: in `/arm/goal` the part before it is what moves."""
_ANY_PART = re.compile(r"servos?(?![a-z])|pwm")
_VAGUE = (None, Thing.DEVICE, Thing.MODE)
"""What a name may say that a type says better."""
_CONTROLS = re.compile(r"_(?:control|cmd|command)$")
"""How the names of commands end: what stands before it tells who commands, as in `manual_cmd`."""
COMMAND_NAMES = re.compile(r"cmd|command|setpoint|desired|_out$|^out")
"""What in a name says that it is a command."""
ORDERS = SIGNALS | {"std_msgs/String"}
"""Types that may order anything."""
_COMMAND_TYPE = re.compile(r"/\w*(?:Command|Cmd|Setpoint)")
_NEAR_ACTUATORS = re.compile(
    r"actuator|motor|(?:^|/)rc(?:[/_]|$)|manual_control|thrust|attitude|rates?(?:[/_]|$)"
    r"|(?:^|[/_])raw(?:[/_]|$)|vel(?:[/_]|ocity|$)|effort|torque|pwm|rpm|throttle"
)
"""Words of what is set nearer to the actuators than a position or a goal is."""
_LIMIT_WORDS = re.compile(r"max_?(?:vel|speed|acc)|(?:vel|velocity|speed)_limit")
_ARMING = re.compile(r"^(?:dis)?arm$|(?:dis|en)able_?motors?|motors?_(?:en|dis)able")
_ASKING = "get|list|query|is|has|check|read"
_PREPARING = (
    "save|describe|download|generate|connect|reconnect|compute|create|delete|advertise|plan"
    "|register"
)
"""Verbs that move nothing, whatever their object is; nobody prepares a command."""
_INSPECTING, _PLACES = re.compile(r"^scan_|calibrat"), re.compile(r"_(?:area|field|room)")
"""Verbs that move what they inspect, if it can move, or the robot about a place."""
_READINGS = (
    "map|costmap|odom|odometry|imu|gps|image|scan|parameters?|detections?|diagnostics|tf|status"
    "|states?|timers?|running|saved|log|feedback|info|markers?|initialpose|clicked_point|measured"
    "|estimated?"
)
"""Last words of what is read, shown or estimated."""
_READS = re.compile(
    rf"^(?:{_ASKING})(?:_|$)|^(?:{_PREPARING})(?:_|$)(?!cmd)"
    rf"|(?:^|_)(?:{_READINGS})$|_get_"
    r"|^clear_\w*maps?$|^set_\w*(?:transform|frame)s?$"
)
_STATES = re.compile(r"_?states?$")
_SETS = re.compile(r"(?:set|switch)_(?!\w*(?:odom|map|imu|gps|transform|frame|timer))")
_ASKING_TYPES = re.compile(r"\w+/(?:Get|Query|List|Check|Compute|Describe)[A-Z]")
_EXECUTES = re.compile(r"(?:^|_)(?:exec|execute|go|goto|move|drive)(?:_|$)")
_MANNER = re.compile(r"_(?:in|from|to|at|by|with|for)_\w+$")
"""What follows a preposition: in `set_velocity_in_frame` no frame is set."""
_ON_REQUEST = re.compile(
    r"(?:^|_)(?:request|leds?\d*|light\w*|config\w*|name|mode_request|info|text|sound|gps|alarms?"
    r"|reports?|battery|encoders?|ticks|colou?rs?|effects?|logs?"
    r"|record\w*|snapshot|photo|video|camera(?!_(?:pan|tilt|angle|servo))|stream\w*|reset_(?:odom\w*|pose|encoders?|imu|map))(?:_|$)"
)
"""Words in the names of what a driver hears that is no command."""
_SHOWS = re.compile(
    r"(?:^|[/_])(?:led|leds|light|lights|lcd|oled|display|screen|sound|audio|map)(?:[/_]|$)"
)
"""Words, anywhere in a name, of what only shows or sounds."""
_HARMLESS_PACKAGES = (
    "audio_common|bond|cartographer_ros|composition|composition_interfaces|diagnostic"
    "|dynamic_reconfigure|gazebo|lifecycle|map|nav|nodelet|octomap|rcl_interfaces"
    "|robot_localization|rosapi|rosbag2_interfaces|roscpp|rosgraph|rtabmap|rtcm|slam_toolbox"
    "|sound_play|tf|tf2|topic_tools|tts|type_description_interfaces|visualization"
)
_HARMLESS_TYPES = re.compile(
    rf"(?:{_HARMLESS_PACKAGES})(?:_msgs)?/|sensor_msgs/(?!(?:JointState|Joy)$)"
    r"|geometry_msgs/\w+WithCovariance"
    r"|mavros_msgs/(?:RCIn$|\w*State$|Param(?!Set)|File|RTCM|StreamRate$|MessageInterval$"
    r"|VehicleInfo|Waypoint(?:Pull|Clear)|Log|ADSBVehicle|CommandAck|CommandTrigger|DebugValue"
    r"|PlayTune|SetMavFrame|StatusText|Tunnel)"
    r"|moveit_msgs/(?:Apply|Change|Set|Save|Load|Rename|Delete|Display"
    r"|\w*(?:PlanningScene|CollisionObj))|nav2_msgs/(?:Clear|Get|Is|Load|Save|Dump|Reload)"
)


def thing_of(name: str, type: str, means: Means) -> Thing | None:
    """Return what a command moves; None where neither type nor name says that it does."""
    type, last = _plain_type(type), _last_part(name)
    if is_harmless(name, type) or (means is Means.SERVICE and _is_of_nav2(type)):
        return None
    if _SHOWS.search(name.lower()) and not _by_type(type, _USUAL_TYPES):
        return None
    if found := _by_type(type, _TYPES):
        return found
    if _LIMIT_WORDS.search(last):
        return Thing.LIMITS
    if (means is Means.SERVICE or type in SIGNALS) and _ARMING.search(last):
        return Thing.ARMING
    named = _by_words(name)
    usual = _by_type(type, _USUAL_TYPES) if named in {*_VAGUE, Thing.SERVOS} else None
    if named is Thing.MODE and (means is Means.ACTION or _is_control(last, type, means)):
        named = Thing.DEVICE
    is_command = _COMMAND_TYPE.search(type) or is_order(name, type)
    return usual or named or (Thing.DEVICE if is_command else None)


def part_of_name(name: str, type: str) -> Thing | None:
    """Return which part of a robot a topic says to move; a servo may be of any."""
    found = thing_of(_ANY_PART.sub("", name), type, Means.TOPIC)
    is_vague = found in _VAGUE or found in NO_MOTION
    return part_of_states(name, type) if is_vague else found


def is_order(name: str, type: str) -> bool:
    """Return whether a topic carries orders in words, which its name says."""
    last = _last_part(name)
    return _plain_type(type) == "std_msgs/String" and bool(
        COMMAND_NAMES.search(last) or last == "action"
    )


def _is_control(last: str, type: str, means: Means) -> bool:
    """Return whether a topic carries more than a signal, and is called a command of somebody."""
    is_stream = means is Means.TOPIC and type not in SIGNALS
    return is_stream and _CONTROLS.search(last) is not None


def vagueness(name: str, type: str, means: Means) -> int:
    """Return how little a name and a type say that something moves: 0 for what sets actuators.

    A head that turns is less than what it sits on.
    """
    named, type = _by_words(name), _plain_type(type)
    if named is Thing.HEAD:
        return 5
    if means is Means.TOPIC and (COMMAND_NAMES.search(name) or _by_type(type, _USUAL_TYPES)):
        return int(not _NEAR_ACTUATORS.search(snake_case(name)))
    return 3 + (named in _VAGUE and _by_words(_last_part(type)) in _VAGUE)


def thing_of_node(name: str) -> Thing | None:
    """Return what a node moves, as far as its name tells more than that it moves something."""
    found = _by_words(name.rpartition("/")[2])
    return found if found in PARTS else None


def part_of_states(name: str, type: str) -> Thing | None:
    """Return what is moved whose state a name or its type tells; None of types that only tell."""
    names = [_last_part(name), _last_part(type)]
    if _HARMLESS_TYPES.match(_plain_type(type)) or not any(map(_STATES.search, names)):
        return None
    named = filter(None, map(_by_words, names))
    return next((each for each in named if each not in {Thing.DEVICE, *NO_MOTION}), None)


def is_harmless(name: str, type: str) -> bool:
    """Return whether a name or a type says that something is read, shown or estimated."""
    last, type = _last_part(name), _plain_type(type)
    only_reads = all(map(_reads, last.split("_and_")))
    is_query = _ASKING_TYPES.match(type) and not _EXECUTES.search(last)
    return bool(only_reads or is_query or is_measured(name) or _HARMLESS_TYPES.match(type))


def _reads(clause: str) -> bool:
    """Return whether a name, or the part of it before or behind an `and`, moves nothing."""
    if _INSPECTING.search(clause):
        return _by_words(clause) is None and not _PLACES.search(clause)
    return bool(_READS.search(_MANNER.sub("", clause))) and not _SETS.match(clause)


def may_be_command(name: str, type: str) -> bool:
    """Return whether what a driver hears may be a command, whatever neither name nor type says."""
    is_other = _ON_REQUEST.search(_last_part(name)) or _SHOWS.search(name.lower())
    return not (is_other or is_harmless(name, type) or _is_of_nav2(_plain_type(type)))


def _is_of_nav2(type: str) -> bool:
    """Return whether a type is one of Nav2's that moves nothing: its goals do."""
    return type.startswith("nav2_msgs/") and not _by_type(type, _TYPES)


def _last_part(name: str) -> str:
    return snake_case(name.rstrip("/").rpartition("/")[2])


def _plain_type(type: str) -> str:
    """Return a type as `package/Name`, whatever it is of."""
    return normalise_type(type.replace("/srv/", "/").replace("/action/", "/"))


def _by_type(type: str, table: tuple[tuple[str, Thing], ...]) -> Thing | None:
    return next((thing for pattern, thing in table if re.match(pattern, type)), None)


def _by_words(name: str) -> Thing | None:
    parts = [part for part in snake_case(name).split("/") if part]
    if "servo_node" in parts:  # MoveIt Servo
        return Thing.ARM
    if parts[-1:] == ["stop"]:
        return Thing.STOP
    found: Thing | None = None
    for part in reversed(parts):
        words = {part, *re.split(r"[_\d-]+", part)}
        if EMERGENCY_STOP.search(part):
            return Thing.STOP
        thing = next((t for t, known in _WORDS if not words.isdisjoint(known.split())), None)
        if thing not in {None, Thing.DEVICE} and (found is not Thing.BASE or thing in PARTS):
            found = thing
            if words.isdisjoint(_GENERIC):
                break
        found = found or thing
    return found
