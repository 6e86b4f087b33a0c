"""Topics on Gazebo's own side: what a bridge carries, against what the robots have.

Names and defaults: gz-sim (src/systems/*/*.cc, `Configure`) and gz-sensors; the clock:
src/SimulationRunner.cc, which does not publish it where another does.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

from rtron.sources.declaration import GazeboTopic
from rtron.sources.gazebo import GazeboPlugin, Sensor
from rtron.vocabulary import WiringFact, WiringFactKind

_SYSTEM = re.compile(r"(?:gz-sim|ignition-gazebo)\d*-(.+)-system")
_COMMAND = ("topic", "Twist", "/model/{}/cmd_vel")
_ODOMETRY = ("odom_topic", "Odometry", "/model/{}/odometry")
_INPUTS = dict.fromkeys(
    ("diff-drive", "mecanum-drive", "ackermann-steering", "velocity-control"), _COMMAND
)
_OUTPUTS = {
    **dict.fromkeys(("diff-drive", "mecanum-drive", "ackermann-steering"), _ODOMETRY),
    "odometry-publisher": _ODOMETRY,
    "joint-state-publisher": ("topic", "Model", ""),
}
"""The element with a topic's name, its type, and its name without the element, if it is known."""
_LIDAR = (("LaserScan", "scan", ""), ("PointCloudPacked", "scan/points", "/points"))
_SENSORS: Mapping[str, tuple[tuple[str, str, str], ...]] = {
    **dict.fromkeys(("gpu_lidar", "gpu_ray"), _LIDAR),
    **dict.fromkeys(("navsat", "gps"), (("NavSat", "navsat", ""),)),
    "imu": (("IMU", "imu", ""),),
    "magnetometer": (("Magnetometer", "magnetometer", ""),),
    "air_pressure": (("FluidPressure", "air_pressure", ""),),
    "altimeter": (("Altimeter", "altimeter", ""),),
    **dict.fromkeys(("contact", "force_torque", "air_speed"), ()),
    "camera": (("Image", "image", ""),),
    "depth_camera": (
        ("Image", "depth_image", ""),
        ("PointCloudPacked", "depth_image/points", "/points"),
    ),
    "rgbd_camera": tuple(
        (type, name, f"/{name}")
        for type, name in (
            ("Image", "image"),
            ("Image", "depth_image"),
            ("PointCloudPacked", "points"),
        )
    ),
}
"""What sensors send: the type, the name below the sensor's, and what stands behind a `<topic>`."""
_OTHER_SENSORS = tuple((type, "", "") for type in ("Image", "PointCloudPacked"))
"""What those of other types may send, under names that are not known."""
_SCOPE = "world/*/model/{}/link/*/sensor/{}/{}"
"""What a sensor's topic is called without one; fixed joints move it to another link."""
_CLOCK, _UNKNOWN = "Clock", "/"
_MOST_COMPARED = 200
"""Of more names it does not matter which fit."""
_WITHOUT = re.compile(
    r"(?:lib)?(?:gz_|ign_|gazebo_ros|(?:gz-sim|ignition-gazebo)"
    r"(?!.*(?:tracked-vehicle|multicopter-control|drive-to-pose)))"
)
"""Plugins that have no topics of these types: those of ROS and of Gazebo itself, but for a few."""


def plugin_topics(
    plugins: Iterable[GazeboPlugin], given: str, called: str
) -> Iterator[GazeboTopic]:
    """Yield the topics of a model's systems; `/` if a name is not known, without a type if none is.

    `given` is the name that the spawner gives the model, `called` that in its file.
    """
    model, models = given or called, frozenset({given, called} - {""})
    for plugin in plugins:
        if not _WITHOUT.match(plugin.filename):
            yield GazeboTopic(name=_UNKNOWN, type="", to_ros=True, to_gazebo=True)
        system = _SYSTEM.fullmatch(plugin.filename)
        for systems in (_INPUTS, _OUTPUTS) if system else ():
            element, type, default = systems.get(system[1], ("", "", ""))  # type: ignore[index]
            name = plugin.values.get(element, default.format(model) if model else "")
            if type:
                yield GazeboTopic(
                    name=gazebo_name(name if isinstance(name, str) else ""),
                    type=type,
                    to_ros=systems is _OUTPUTS,
                    to_gazebo=systems is _INPUTS,
                    models=models,
                    evidence=(plugin.evidence,),
                )


def sensor_topics(sensors: Iterable[Sensor], given: str, called: str) -> Iterator[GazeboTopic]:
    """Yield the topics of a model's sensors, as above; a name has a `*` for what is not known."""
    for sensor in sensors:
        for type, name, behind in _SENSORS.get(sensor.type, _OTHER_SENSORS):
            scoped = _SCOPE.format(given or called or "*", sensor.name, name)
            topic = f"{sensor.topic}{behind}" if sensor.topic else scoped
            yield GazeboTopic(
                name=gazebo_name(topic) if name else _UNKNOWN,
                type=type,
                to_ros=True,
                to_gazebo=False,
                models=frozenset({given, called} - {""}),
                evidence=(sensor.evidence,),
            )


def gazebo_name(name: str) -> str:
    """Return the full name of a topic of Gazebo, where a name without a slash is the same."""
    return f"/{name.strip().strip('/')}"


def mismatched_bridges(topics: Sequence[GazeboTopic]) -> Iterator[WiringFact]:
    """Yield what bridges carry past the plugin, in the wrong direction, or for another model."""
    bridged, of_plugins = [t for t in topics if t.bridge], [t for t in topics if not t.bridge]
    are_driven = any(each.to_gazebo for each in of_plugins)
    for carried in bridged:
        if carried.type == _CLOCK and carried.to_gazebo:
            yield _fact(carried, replace(carried, to_gazebo=False))
        for other in of_plugins:
            is_same = (carried.name, carried.type) == (other.name, other.type)
            if is_same and not _is_its_way(other, carried):
                yield _fact(carried, other)
        if are_driven and _is_of_another(carried.name, of_plugins):
            kind, others = WiringFactKind.OTHER_MODEL, (carried.bridge,)
            fact = WiringFact(kind=kind, subject=carried.name, others=others)
            yield replace(fact, evidence=carried.evidence)
    if not all(each.type for each in of_plugins):
        return
    for type, to_ros in sorted({(each.type, each.to_ros) for each in of_plugins}):
        plugins = [each for each in of_plugins if (each.type, each.to_ros) == (type, to_ros)]
        of_type = (each for each in bridged if each.type == type)
        yield from _unmatched(plugins, [each for each in of_type if _is_its_way(plugins[0], each)])


def _is_its_way(other: GazeboTopic, carried: GazeboTopic) -> bool:
    """Return whether a bridge carries in the direction that a plugin's topic has."""
    return carried.to_ros if other.to_ros else carried.to_gazebo


def _unmatched(plugins: list[GazeboTopic], bridged: list[GazeboTopic]) -> Iterator[WiringFact]:
    """Yield a fact where one name of a bridge and one of a plugin are left over."""
    known, used = {each.name for each in plugins}, {each.name for each in bridged}
    if max(len(known), len(used)) > _MOST_COMPARED:
        return
    lost = [name for name in used if not any(fnmatchcase(name, each) for each in known)]
    unbridged = [each for each in known if not any(fnmatchcase(name, each) for name in used)]
    is_only = len(lost) == len(unbridged) == 1 and _UNKNOWN not in known
    if is_only and not _is_of_another(lost[0], plugins):
        (other,) = [each for each in plugins if each.name == unbridged[0]][:1]
        for carried in (each for each in bridged if each.name == lost[0]):
            yield _fact(carried, other)


def _is_of_another(name: str, plugins: list[GazeboTopic]) -> bool:
    """Return whether a name's namespace tells of none of the models that are spawned."""
    namespace, *others = (each.split("/")[1:-1] for each in (name, *(e.name for e in plugins)))
    own = frozenset().union(*others, *(each.models for each in plugins)) - {"model"}
    return bool(namespace) and own.isdisjoint(namespace)


def _fact(carried: GazeboTopic, other: GazeboTopic) -> WiringFact:
    return WiringFact(
        kind=WiringFactKind.BRIDGE_MISMATCH,
        subject=carried.name,
        value=other.name,
        others=(carried.bridge,),
        evidence=tuple(dict.fromkeys((*carried.evidence, *other.evidence))),
    )
