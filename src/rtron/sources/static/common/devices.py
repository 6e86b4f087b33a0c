"""What the text of a node's source shows of devices, sockets and the age of its commands.

Its text is searched: what stands in a comment does not count, what a function would do at run time
is not followed.
"""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from rtron.sources.declaration import FlowInput
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.node_sources import CPP, file_content, node_sources
from rtron.sources.static.common.task import TaskKind
from rtron.sources.workspace import Workspace
from rtron.vocabulary import (
    DESCRIPTORS,
    LIBRARY,
    UNKNOWN_OUTPUT,
    Evidence,
    InteractionGraph,
    Node,
    WiringFact,
    WiringFactKind,
)

_LIBRARIES = {
    "serial port": r"\bserial\b|cfset[io]?speed|LibSerial|SerialPort|serial_port|serial_driver",
    "I2C": r"\bsmbus|linux/i2c|wiringPiI2C|\bbusio\b|\bqwiic"
    r"|\b[aA]dafruit_(?!(?i:servo|motor|pca9685))",
    "SPI": r"\bspidev|linux/spi",
    "PWM output": r"\.PWM\(|set_servo_pulsewidth|set_PWM_dutycycle|hardware_PWM|[pP]wmWrite\("
    r"|softServoWrite|tx_(?:pwm|servo)\("
    r"|gpiozero import[^\n]{0,200}\b(?:Motor|Robot|Servo|AngularServo)\b",
    "servo driver": r"(?i:pca9685|servokit|adafruit_motor\b|motorkit)",
    "GPIO": r"RPi\.GPIO|Jetson\.GPIO|gpiozero|pigpio|wiringPi\.h|\blgpio|\bgpiod",
    "CAN": r"(?<=import )can\b|(?<=from )can\b|linux/can|socketcan|canlib|PCANBasic|can_msgs",
    "EtherCAT": r"ethercat\.h|\becrt\.h|\bsoem",
    "servo bus": r"dynamixel_sdk|lx16a|scservo|SCServo|feetech|herkulex",
    "moteus": r"\bmoteus",
    "VESC": r"vesc_(?:interface|packet)|pyvesc|VescUart",
    "Roboteq": r"[Rr]oboteq",
    "motor controller": r"roboclaw|odrive|phidget22"
    r"|sabertooth|tmc\d{4}|Rosmaster_Lib|[Mm]otor_?(?:HAT|hat)\b"
    r"|\b(?:(?:easygo|go)pigo3?|brickpi3|picarx|robot_hat|ev3dev2?|pyfirmata2?)\b",
    "Modbus": r"\bpymodbus|minimalmodbus|\bmodbus(?:/modbus)?\.h",
    "TCP link": r"\bcreate_connection\(|\.connect\(\s*\(|\bconnect\([^;\n]{0,60}sockaddr",
    "Bluetooth": r"\bbleak\b|bluetooth/(?:rfcomm|bluetooth)\.h|\bbluepy\b|\bpygatt\b",
    "LCM": r"\blcm/lcm|^[ \t]*(?:import|from) lcm\b",
    "vehicle link": r"pymavlink|mavsdk|dronekit|mavlink/v2\.0|djitellopy|olympe|dji_vehicle\.hpp",
    "vendor SDK": r"unitree_(?:legged_)?sdk|bosdyn|xarm\.wrapper|ugv_sdk|franka/robot|ur_rtde"
    r"|ur_client_library|kortex|\bpyniryo|pymycobot|aubo_sdk",
}
"""What stands on a line that imports or includes the library of a device, its messages apart, or
that connects to one.

A terminal has termios too, and no speed that a program sets.
"""
_SOCKETS = {
    "MQTT": r"paho\.mqtt|\bmosquitto_new\b|mosqpp::|mqtt::(?:async_)?client\b|MQTTClient|aio_?mqtt"
    r"|asyncio_mqtt",
    "WebSocket server": r"websockets\.serve|WebSocketServer|websocketpp/server|import tornado"
    r"|from autobahn|socketio\.(?:Async)?Server|uWS::",
    "web server": r"from flask|import flask|http\.server|from aiohttp import web|FastAPI\("
    r"|from bottle|crow\.h|httplib\.h|cherrypy|SimpleHTTPServer|web\.Application\(",
    "TCP or UDP socket": r"socketserver\.|\.bind\(\s*\(|INADDR_ANY|in6addr_any|tcp::acceptor"
    r"|udp::endpoint\(\s*udp|QTcpServer",
    "MAVLink link": r"[\"'](?:udpin|tcpin):/{0,2}(?!127\.|localhost)|[\"']udp://:14\d{3}\b",
    "gRPC server": r"grpc\.(?:aio\.)?server\(|grpc::ServerBuilder",
    "WebSocket client": r"websockets\.(?:sync\.client\.)?connect\(|\bWebSocketApp\("
    r"|websocket\.create_connection\(|socketio\.(?:Async)?Client\(|\.ws_connect\("
    r"|websocketpp/client|\bix::WebSocket\b|\bQWebSocket\b",
    "ZeroMQ": r"(?:import|from) zmq\b|\bzmq(?:_addon)?\.h",
    "Redis": r"(?:import|from) redis\b|\bhiredis/|\bsw/redis",
    "cloud service": r"\bfirebase_admin|\bpyrebase|\bAWSIoTPythonSDK|\bawsiot|\bazure\.iot"
    r"|(?:import|from) (?:boto3|pubnub|ably)\b",
    "chat": r"\btelebot\b|(?:import|from) (?:telegram|discord|aiogram|slack_(?:bolt|sdk))\b",
}
"""What others than nodes may command a program through, also where it calls them itself."""
_OPERATORS = {
    "joystick": r"pygame\.joystick|from pygame import joystick|\binputs import get_gamepad"
    r"|\bevdev\b|/dev/input/|linux/joystick\.h|SDL_Joystick|SDL_GameController|\bhidapi\b",
    "keyboard": r"\bpynput\b|\btty\.set(?:raw|cbreak)|\bcurses\.|ncurses\.h"
    r"|tcsetattr\(\s*(?:0\b|STDIN|kfd|sys\.stdin)|pygame\.K_\w|^import keyboard\b"
    r"|[=(]\s{0,9}(?:raw_)?input\(|\bcin\s*>>|getline\(\s*(?:std::)?cin\b",
    "window": r"\bQ(?:Gui)?Application\b(?!\s*[,;])|\b(?:tk(?:inter)?\.|Tkinter\.)Tk\(|=\s*Tk\(\)"
    r"|\bCTk\(|\bwx\.App\(|\bGtk\.(?:main|Application)\(|\brqt_gui_(?:py|cpp)\b",
}
"""Where a person commands a node beside ROS."""
_COMMAND = r"(?<![a-z])(?:cmd_?vel|cmd|command|vel|velocity|twist|joy|setpoint|teleop|drive)"
_AGE = (
    r"watch_?dog|dead_?man|fail_?safe"
    rf"|{_COMMAND}(?:_\w{{0,30}})?_?time_?out|time_?out_?(?:\w{{0,30}}_)?{_COMMAND}(?![a-z])"
    r"|(?-i:\.SetTimeout\(|\bSET[ _](?:\w{1,20}[ _])?TIMEOUT)"
    rf"|(?:last|prev|previous)_(?:\w{{0,30}}_)?{_COMMAND}_(?:\w{{0,30}}_)?(?:time|stamp|received|at|t)_?\b"
    r"|(?:control|ctrl)_(?:loop_)?time_?out"
    rf"|\b{_COMMAND}_ts\b|t_last_(?:\w{{0,30}}_)?{_COMMAND}|time_?since_?(?:\w{{0,30}}_)?{_COMMAND}"
    r"|(?:cmd|command|twist)_?(?:time|stamp)_?\b[^\n]{0,40}>|lastCommand|lastCmd"
)
"""Names that tell of a command's age, or of what ends one.

Boards get a limit by them that have none by default: `enable_watchdog` of ODrive (its
documentation), `BUS_WATCHDOG` of Dynamixel (its e-manual), `enableFailsafe` of Phidgets (its API)
and `SetTimeout` of RoboClaw (its user manual, command 14).
"""
_TIMERS = re.compile(
    rb"\belapsed(?:Millis|Micros)\b|\b(?:Timeout|Ticker|Timer)\s+\w+\s*[;({]|xQueueReceive|xTimer\w+"
    rb"|esp_timer_\w+|\buxr_millis|\bwdt_\w+|esp_task_wdt|\bIWDG|\bTimer1\.|\bMsTimer2"
)
"""What ends commands in firmware by its hardware or its system: mbed, Teensy, FreeRTOS, ESP-IDF."""
_COMMENTS = {
    True: re.compile(
        rb"\"\"\".*?(?:\"\"\"|\Z)|'{3}.*?(?:'{3}|\Z)"
        rb"|\"(?:\\.|[^\"\\\n])*(?:\"|(?=\n)|\\?\Z)|'(?:\\.|[^'\\\n])*(?:'|(?=\n)|\\?\Z)|#[^\n]*",
        re.DOTALL,
    ),
    False: re.compile(
        rb"//[^\n]*|/\*.*?(?:\*/|\Z)|\"(?:\\.|[^\"\\\n])*(?:\"|(?=\n)|\\?\Z)|'(?:\\.|[^'\\\n])'",
        re.DOTALL,
    ),
}
"""Comments and strings of Python, or of C++; of a string in three quotes the text is one, too."""
_KINDS = {
    WiringFactKind.DEVICE: {
        word: rf"(?:{names})(?!\w{{0,40}}_msgs)" for word, names in _LIBRARIES.items()
    },
    WiringFactKind.SOCKET: _SOCKETS,
    WiringFactKind.OPERATOR: _OPERATORS,
    WiringFactKind.COMMAND_AGE: {"age of a command": f"(?i:{_AGE})"},
}
_IMPORTS = re.compile(
    rb"[ \t]*(?:(?:#[ \t]*include|import|from)\b|cfset[io]?speed)|[^\n]{0,80}(?:connect(?:ion)?|PWM"
    rb"|servo_pulsewidth|PWM_dutycycle|[pP]wmWrite|ServoWrite|tx_pwm|tx_servo)\("
)
_FLOWS = {
    FlowInput.MESSAGE: WiringFactKind.MESSAGE_FLOW,
    FlowInput.REQUEST: WiringFactKind.REQUEST_FLOW,
    FlowInput.START: WiringFactKind.SELF_MOTION,
}
_Places: TypeAlias = dict[tuple[WiringFactKind, str], Evidence]
"""Where each word of each kind stands first."""
_PATTERNS = {
    kind: {word: re.compile(pattern.encode(), re.MULTILINE) for word, pattern in words.items()}
    for kind, words in _KINDS.items()
}


def with_devices(graph: InteractionGraph, workspace: Workspace) -> InteractionGraph:
    """Return a graph with a fact for what each node's source opens, with the first place of it."""
    files: dict[Path, _Places] = {}
    programs: dict[tuple[str, str], _Places] = {}
    facts: list[WiringFact] = []
    for node in graph.nodes:
        program = (node.package, node.executable)
        if node.package in workspace.packages and node.executable:
            if program not in programs:
                programs[program] = _places_of(node, workspace, files)
            facts += _facts(node.name, programs[program])
    return replace(graph, wiring=(*graph.wiring, *facts))


def firmware(part: NodePart) -> Iterator[WiringFact]:
    """Yield what the sketch behind a bridge shows; what runs on a board reaches its pins."""
    if part.task is None or part.task.kind is not TaskKind.SKETCH:
        return
    places: _Places = {}
    for path in part.task.sources:
        places = _places(path, file_content(path)) | places
    if timed := next(filter(None, map(_first_timer, part.task.sources)), None):
        places = {(WiringFactKind.COMMAND_AGE, "age of a command"): timed} | places
    start = Evidence(file=str(part.task.sources[0]))
    yield from _facts(part.owner, places | {(WiringFactKind.DEVICE, "firmware"): start})


def _first_timer(path: Path) -> Evidence | None:
    """Return the first place in a file of firmware of a timer that may end commands."""
    text = _COMMENTS[False].sub(_without_comment, file_content(path))
    found = _TIMERS.search(text)
    line = text.count(b"\n", 0, found.start()) + 1 if found else 0
    return Evidence(file=str(path), line=line) if found else None


def last_messages(part: NodePart) -> Iterator[WiringFact]:
    """Yield a fact for what becomes of the last message of each subscription of a part."""
    for last in part.interface.last_messages:
        yield WiringFact(
            kind=WiringFactKind.LAST_MESSAGE,
            subject=part.owner,
            value=last.fate.value,
            others=() if last.seconds is None else (f"{last.seconds:g} s",),
            evidence=last.evidence,
        )


def message_flows(part: NodePart) -> Iterator[WiringFact]:
    """Yield a fact for what each input of a part leads to, and for what it does by itself."""
    for flow in part.interface.message_flows:
        devices = [_device(each) for each in flow.outputs]
        yield WiringFact(
            kind=_FLOWS[flow.input],
            subject=part.owner,
            value=min(devices, key=lambda each: each.startswith(LIBRARY), default=""),
            others=flow.requests,
            evidence=flow.evidence,
        )


def _device(library: str) -> str:
    """Return the device that what a program calls or writes to is of, else which library."""
    patterns = _PATTERNS[WiringFactKind.DEVICE]
    line = f"import {library}".encode()
    is_known = library in {*DESCRIPTORS, UNKNOWN_OUTPUT}
    words = (word for word, pattern in patterns.items() if pattern.search(line))
    return library if is_known else next(words, f"{LIBRARY}{library}")


def _places_of(node: Node, workspace: Workspace, files: dict[Path, _Places]) -> _Places:
    """Return the first place in the source of a node's program of what is looked for."""
    places: _Places = {}
    for path, data in node_sources(node, workspace).items():
        if path not in files:
            files[path] = _places(path, data)
        places = files[path] | places
    return places


def _facts(node: str, places: _Places) -> Iterator[WiringFact]:
    for kind, word in sorted(places):
        evidence = (places[kind, word],)
        yield WiringFact(kind=kind, subject=node, value=word, evidence=evidence)


def _places(path: Path, data: bytes) -> _Places:
    """Return the first place in a file of what is looked for."""
    text = _COMMENTS[path.suffix not in CPP].sub(_without_comment, data)
    lines = dict.fromkeys(_PATTERNS, text) | {WiringFactKind.DEVICE: _imports(text)}
    places: _Places = {}
    for kind, words in _PATTERNS.items():
        for word, pattern in words.items():
            if match := pattern.search(lines[kind]):
                line = lines[kind].count(b"\n", 0, match.start()) + 1
                places[kind, word] = Evidence(file=str(path), line=line)
    return places


def _imports(text: bytes) -> bytes:
    """Return a text with the lines alone that import or include; the others are empty."""
    return b"\n".join(line if _IMPORTS.match(line) else b"" for line in text.split(b"\n"))


def _without_comment(found: re.Match[bytes]) -> bytes:
    """Return a short string as it stands, and the lines alone of a comment."""
    text = found[0]
    is_string = text[:1] in {b'"', b"'"} and text[:3] not in {b'"""', b"'''"}
    return text if is_string else b"\n" * text.count(b"\n")
