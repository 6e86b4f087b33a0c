"""The abstract interaction graph as JSON, DOT, SVG and HTML."""

import json
import re
from xml.etree import ElementTree as ET

import pytest

from rtron.functions.graph import AbstractGraph, PackageUse, abstract_graph
from rtron.reports.functions_graph_dot import functions_to_dot
from rtron.reports.functions_graph_ground import NODE_WIDTH
from rtron.reports.functions_graph_html import functions_to_html
from rtron.reports.functions_graph_json import functions_to_json
from rtron.reports.functions_graph_layout import lay_out
from rtron.reports.functions_graph_svg import functions_to_svg
from rtron.vocabulary import FunctionType as F

TWIST = "geometry_msgs/Twist"
EVIL = 'x_msgs/A"<script>alert(1)</script>&\n\x1b[31m'
SVG = "{http://www.w3.org/2000/svg}"
ALL = [PackageUse(name=f"p{number}", functions=(f,)) for number, f in enumerate(F)]


def use(name, function, sends=(), hears=()):
    return PackageUse(
        name=name, functions=(function,), publishes=frozenset(sends), subscribes=frozenset(hears)
    )


SMALL = abstract_graph(
    [
        use("follows", F.PATH_TRACKING, sends=[TWIST]),
        use("base", F.MOBILE, hears=[TWIST]),
        use("amcl", F.LOCALIZATION),
    ]
)
WHOLE = abstract_graph(ALL)
HOSTILE = abstract_graph([use("a", F.MAPPING, sends=[EVIL]), use("b", F.SPEAKER, hears=[EVIL])])


def test_json():
    document = functions_to_json(SMALL)
    assert document["schema"] == "rtron.functions/1"
    assert (document["packages"], document["outside"]) == (3, 0)
    assert document["functions"][0] == {
        "name": "Localization",
        "function": "Localization",
        "domain": "Perception",
        "packages": 1,
    }
    edges = {(edge["from"], edge["to"]): edge["messages"] for edge in document["direct"]}
    assert edges["Path Tracking", "Mobile"][0] == {
        "type": TWIST,
        "publishers": 1,
        "subscribers": 1,
        "basis": "source",
    }
    assert document["indirect"] == [
        {"from": "Path Tracking", "to": "Localization", "through": "motion"}
    ]
    assert json.loads(json.dumps(document)) == document


@pytest.mark.parametrize("graph", [AbstractGraph(), SMALL, WHOLE, HOSTILE])
def test_svg_is_xml_and_has_every_function_once(graph):
    root = ET.fromstring(functions_to_svg(graph))
    names = [g.get("data-name") for g in root.iter(f"{SVG}g") if g.get("class") == "function"]
    assert names == [node.name for node in graph.functions]
    assert not list(root.iter(f"{SVG}script"))


def test_svg_tells_what_flows_and_how_it_is_known():
    root = ET.fromstring(functions_to_svg(SMALL))
    told = {
        (path.get("data-from"), path.get("data-to")): "".join(path.itertext())
        for path in root.iter(f"{SVG}path")
        if path.get("class") == "edge"
    }
    assert f"{TWIST}: in source, 1 -> 1 package" in told["Path Tracking", "Mobile"]
    assert "nav_msgs/Odometry: typical" in told["Mobile", "Localization"]
    assert {("Path Tracking", "Environment"), ("Environment", "Localization")} <= told.keys()


def test_a_graph_without_control_has_no_environment():
    assert "Environment" not in functions_to_svg(abstract_graph([use("amcl", F.LOCALIZATION)]))
    assert "Environment" in functions_to_svg(SMALL)


def test_stages_stand_from_left_to_right_as_in_the_papers_figure():
    stages = lay_out(WHOLE).stages
    assert list(stages) == ["Sensors", "Perception", "Planning", "Control", "Drivers"]
    lefts = [box.x for box in stages.values()]
    assert lefts == sorted(lefts)
    ends = [box.x + box.width for box in stages.values()]
    assert all(end <= left for end, left in zip(ends[:-1], lefts[1:], strict=True))


def test_every_function_stands_in_its_stage_and_on_no_other():
    layout = lay_out(WHOLE)
    boxes = list(layout.nodes.values())
    for node in WHOLE.functions:
        stage = layout.stages["Sensors" if node.name == "Sensors" else str(node.domain)]
        box = layout.nodes[node.name]
        assert box.overlap(stage) == box.width * box.height
    pairs = [(a, b) for i, a in enumerate(boxes) for b in boxes[i + 1 :]]
    assert all(a.overlap(b) == 0 for a, b in pairs)


def test_the_environment_stands_below_and_all_is_inside_the_picture():
    layout = lay_out(WHOLE)
    assert all(box.y + box.height < layout.environment.y for box in layout.nodes.values())
    assert layout.environment.y + layout.environment.height < layout.height
    assert max(box.x + NODE_WIDTH for box in layout.nodes.values()) < layout.width
    for line in (*layout.direct, *layout.indirect):
        numbers = [float(n) for n in re.findall(r"[\d.]+", line.path)]
        assert min(numbers) >= 0
        assert max(numbers) <= layout.width


def test_labels_stand_on_no_function_and_apart_from_one_another():
    layout = lay_out(WHOLE)
    labels = [line.label for line in layout.direct if line.label]
    assert all(label.overlap(box) == 0 for label in labels for box in layout.nodes.values())
    clear = [a for i, a in enumerate(labels) if not any(a.overlap(b) for b in labels[:i])]
    assert len(clear) >= 0.9 * len(labels)


def test_the_same_graph_gives_the_same_picture():
    assert functions_to_svg(WHOLE) == functions_to_svg(abstract_graph(ALL))


def test_dot_has_clusters_and_both_kinds_of_arrows():
    text = functions_to_dot(SMALL)
    assert [line for line in text.splitlines() if "label=" in line and "->" not in line][:2] == [
        '    label="Perception"',
        '    f0 [label="Localization\\n1 package"]',
    ]
    assert f'[label="{TWIST}' in text
    assert 'color="black"' in text
    assert text.count("style=dotted") == 2
    assert text.count("{") == text.count("}")


@pytest.mark.parametrize("write", [functions_to_svg, functions_to_html])
def test_names_that_strangers_chose_are_harmless(write):
    text = write(HOSTILE)
    assert "<script>alert" not in text
    assert "\x1b" not in text
    assert 'A"<' not in text


def test_dot_names_that_strangers_chose_end_no_text():
    (edge,) = [line for line in functions_to_dot(HOSTILE).splitlines() if "script" in line]
    assert 'A\\"<script>' in edge
    assert "\x1b" not in edge


def test_html_has_a_row_for_each_type_and_no_network():
    page = functions_to_html(SMALL)
    assert f"<td>{TWIST}</td><td>in source, 1 -&gt; 1 package</td>" in page
    assert '<tr data-from="Path Tracking" data-to="Localization">' in page
    assert "default-src 'none'" in page
    assert "$" not in re.sub(r"<script>.*</script>", "", page, flags=re.DOTALL)


def test_html_says_what_is_not_drawn_and_lists_it():
    rare = [use(f"m{i}", F.MAPPING, sends=["x_msgs/A"]) for i in range(9)]
    graph = abstract_graph(
        [
            *rare,
            use("t", F.TELEOPERATION, sends=["x_msgs/A"]),
            use("s", F.SPEAKER, hears=["x_msgs/A"]),
        ]
    )
    page = functions_to_html(graph)
    assert "1 rarer interaction not drawn" in page
    assert '<tr data-from="Teleoperation" data-to="Speaker">' in page
    assert 'class="edge" data-from="Teleoperation" data-to="Speaker"' not in page
    assert "not drawn" not in functions_to_html(SMALL)
