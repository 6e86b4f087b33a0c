"""Navigation2's servers: what their models declare beside what their source does.

Every modelled node is started once with its source at hand and once without, with no parameters
but those that it refuses to start without.
"""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from xml.sax.saxutils import quoteattr

from evaluation.common.datasets import Reporter
from figures.figure import Figure
from rtron.sources.models import ROS2_LIBRARY, load_models
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import InteractionGraph

_PERCENT = 100
_DISTRIBUTION = "rolling"
_PREFIXES = ("nav2_", "opennav_")
_NEEDED = """
<set_parameter name="observation_sources" value="['scan', 'cloud']"/>
<set_parameter name="cloud.type" value="pointcloud"/>
<set_parameter name="cloud.topic" value="/cloud"/>
<set_parameter name="polygons" value="['stop']"/>
<set_parameter name="stop.type" value="polygon"/>
<set_parameter name="stop.action_type" value="stop"/>
<set_parameter name="stop.points" value="[[0.1, 0.1], [0.1, -0.1], [-0.1, 0.0]]"/>
"""
"""What the collision monitor and detector do not start without."""


def model_figures(folder: Path, options: ScanOptions, reporter: Reporter) -> Iterator[Figure]:
    """Compare the two, and tell each name that only one of them has."""
    with tempfile.TemporaryDirectory(prefix="rtron-eval-") as name:
        launch = Path(name) / "all.launch.xml"
        launch.write_text(_launch(_modelled()), encoding="utf-8")
        read, modelled = (
            _known_names(
                scan_ros2_app([at], [(launch, {})], {"ROS_DISTRO": _DISTRIBUTION}, options)
            )
            for at, options in ((folder, options), (launch.parent, replace(options, cache=None)))
        )
    reporter.detail([f"  ONLY IN THE SOURCE {' '.join(one)}" for one in sorted(read - modelled)])
    reporter.detail([f"  ONLY IN THE MODEL {' '.join(one)}" for one in sorted(modelled - read)])
    both = len(read & modelled)
    reporter.lines([f"  models: {len(modelled)} names, {both} of the {len(read)} in the source"])
    unit = "% of what the source declares"
    yield Figure("nav2.models", _PERCENT * both / max(1, len(read)), None, unit, at_least=90)
    unit = "% of what the models declare"
    yield Figure("nav2.models_exact", _PERCENT * both / max(1, len(modelled)), None, unit)


def _modelled() -> Sequence[str]:
    nodes = [name for kind, name in load_models(ROS2_LIBRARY).by_name if kind == "node"]
    return sorted(name for name in nodes if name.startswith(_PREFIXES))


def _launch(nodes: Sequence[str]) -> str:
    pairs = (name.split("/") for name in nodes)
    lines = (f"<node pkg={quoteattr(pkg)} exec={quoteattr(exe)}/>" for pkg, exe in pairs)
    return f"<launch>{_NEEDED}{''.join(lines)}</launch>"


def _known_names(graph: InteractionGraph) -> set[tuple[str, ...]]:
    """Return what nodes have whose names are known."""
    endpoints = ((e.node, e.direction.value, e.topic, e.type, str(e.qos)) for e in graph.endpoints)
    services = ((s.node, "service", s.name, s.type) for s in graph.services)
    actions = ((a.node, a.role.value, a.name, a.type) for a in graph.actions)
    return {one for one in (*endpoints, *services, *actions) if "{" not in one[2]}
