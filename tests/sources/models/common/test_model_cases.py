"""What the models of both libraries declare, as `cases/ros1.yaml` and `cases/ros2.yaml` say.

A case is about something; with `each` it is several, which add to it or say otherwise. It names a
model by its kind (`node`, `nodelet`, `component`, `controller`, `gazebo_plugin` with its `element`;
`spawner` is the node that loads ROS 1's controllers) and where it runs: `name`, `named` by a
launch, `args`, `remaps`, `distro`, `values` of ROS 1 (`~` is the node's own name) or `settings` of
ROS 2 (by nodes, or for all), `files`, which lie in `{here}`. `{of}` is what each has of its own.

What it expects of the interface are names and types as `kind name type`:

- `has`, `lacks`: these among others, or none of these; `is`, `explicit`: these alone, all that is
  declared or what no library does; a kind of declaration: the names of all that are of it.
- `below`: prefixes of names that something has, or nothing.
- `frames`, `broadcasts`: all transforms or some, `child parent`; `fixed`; `certain`, by the child;
  `looks_up`: frames.
- `nodes`: their names; `owners`: names by the node that has them.
- `notes`, `whys`: of what is not known, and why; `told`: a part of the first reason.
- `qos`: depth and reliability, `resolution`: both by name; `unread`: whether the model says so.
"""

from pathlib import Path

import pytest
import yaml
from file_tree import write
from model_cases import URDF, frames, names, ros2_node_site, site, told

from rtron.sources.declaration import DeclarationKind
from rtron.sources.models import (
    ROS2_LIBRARY,
    PluginElement,
    controller_interface,
    load_models,
    node_interface,
    plugin_interface,
)
from rtron.vocabulary import UnknownValue

CASES = Path(__file__).parents[1] / "cases"
LIBRARIES = {1: load_models(), 2: load_models(ROS2_LIBRARY)}
MODEL_KINDS = ("node", "nodelet", "component", "controller", "gazebo_plugin")


class CaseLoader(yaml.SafeLoader):
    """Reads values that YAML has no words for."""


CaseLoader.add_constructor("!unknown", lambda _, node: UnknownValue(node.value))
CaseLoader.add_constructor("!many", lambda _, node: ["x"] * int(node.value))
CaseLoader.add_constructor("!urdf", lambda _, node: URDF.replace("base", node.value))


def read_cases():
    for ros in LIBRARIES:
        text = (CASES / f"ros{ros}.yaml").read_text()
        for case in yaml.load(text, CaseLoader):
            for number, row in enumerate(case.pop("each", [{}])):
                yield pytest.param(ros, {**case, **row}, id=f"ros{ros} {case['about']} {number}")


def filled(value, words):
    """Return a value in whose texts words in braces are replaced."""
    if isinstance(value, dict):
        return {key: filled(each, words) for key, each in value.items()}
    if isinstance(value, str):
        for word, meaning in words.items():
            value = value.replace(f"{{{word}}}", meaning)
    return value


def site_of(ros, case):
    environ = [("ROS_DISTRO", case["distro"])] if "distro" in case else []
    name, args = case.get("spawner") or case.get("name", "/robot/driver"), case.get("args", "")
    if ros == 1:
        values = {k.replace("~", f"{name}/"): v for k, v in case.get("values", {}).items()}
        return site(name, values, args, case.get("remaps", ()), environ)
    settings = case.get("settings", {})
    by_node = all(key.startswith("/") for key in settings)
    settings = settings if by_node else {"/**": settings}
    return ros2_node_site(name, settings, args, environ, named=case.get("named", True))


def declared(ros, case):
    """Return the model of a case, if it names one, and what it declares."""
    models, at = LIBRARIES[ros], site_of(ros, case)
    if "spawner" in case:
        return None, controller_interface(at, at.parameters)
    kind = next(kind for kind in MODEL_KINDS if kind in case)
    if kind == "gazebo_plugin":
        model = models.gazebo_plugin(case[kind])
        element = PluginElement(filename=case[kind], **case.get("element", {}))
        return model, plugin_interface(model, site("/gazebo"), element)
    model = models.by_name[kind, case[kind]]
    return model, node_interface(model, at, models=models)


def spelled(found):
    return {" ".join(each).strip() for each in told(found)}


def is_declared(found, words):
    return any(f"{each} ".startswith(f"{words} ") for each in spelled(found))


def has_below(found, prefix):
    return any(declared.name.startswith(prefix) for declared in found.declarations)


def by_name(found, look):
    return {declared.name: look(declared) for declared in found.declarations}


def qos(found, expected):
    quality = by_name(found, lambda d: d.qos and [d.qos.depth, d.qos.reliability])
    return {name: quality[name] for name in expected}


def resolution(found, expected):
    known = by_name(found, lambda d: d.resolution.value)
    return {name: known.get(name) for name in expected}


def owners(found, expected):
    pairs = {(d.node, d.name) for d in found.declarations}
    return {node: [e for e in some if (node, e) in pairs] for node, some in expected.items()}


def below(found, expected):
    return {
        side: [prefix for prefix in some if has_below(found, prefix) is (side == "has")]
        for side, some in expected.items()
    }


def names_of(kind):
    return lambda found, _: sorted(names(found, kind))


ALONE = {
    "is": lambda found, _: sorted(spelled(found)),
    "explicit": lambda found, _: sorted(
        {f"{d.kind} {d.name}" for d in found.declarations if not d.implicit}
    ),
    **{kind.value: names_of(kind.value) for kind in DeclarationKind},
}
"""What there is in no order."""
LOOKS = {
    **ALONE,
    "has": lambda found, expected: [e for e in expected if is_declared(found, e)],
    "lacks": lambda found, expected: [e for e in expected if not is_declared(found, e)],
    "below": below,
    "frames": lambda found, _: [" ".join(each) for each in frames(found)],
    "broadcasts": lambda found, e: [each for each in e if tuple(each.split()) in frames(found)],
    "certain": lambda found, _: {frame.child: frame.is_certain for frame in found.frames},
    "fixed": lambda found, _: all(frame.is_fixed for frame in found.frames),
    "looks_up": lambda found, _: [use.frame for use in found.frame_uses if use.is_look_up],
    "nodes": lambda found, _: [node.name for node in found.nodes],
    "owners": owners,
    "notes": lambda found, _: [note.what for note in found.unresolved],
    "whys": lambda found, _: [note.why for note in found.unresolved],
    "qos": qos,
    "resolution": resolution,
}
"""What there is of an interface where a case expects something."""
EXPECTED = {*LOOKS, "told", "unread"}
GIVEN = {
    *MODEL_KINDS,
    *("about", "of", "element", "spawner", "name", "named", "args", "remaps", "distro", "values"),
    *("settings", "files"),
}
"""What a case is about, and where it runs."""


@pytest.mark.parametrize(("ros", "case"), [*read_cases()])
def test_a_model_declares_what_its_case_says(ros, case, tmp_path):
    assert case.keys() <= EXPECTED | GIVEN
    assert not EXPECTED.isdisjoint(case)
    case = filled(case, {"of": case.get("of", ""), "here": str(tmp_path)})
    write(tmp_path, case.get("files", {}))
    model, found = declared(ros, case)
    expected = {key: value for key, value in case.items() if key in LOOKS}
    expected |= {key: sorted(expected[key]) for key in ALONE.keys() & expected.keys()}
    assert {key: LOOKS[key](found, value) for key, value in expected.items()} == expected
    if "told" in case:
        assert case["told"] in found.unresolved[0].why
    if "unread" in case:
        assert bool(model.unread) is case["unread"]
