"""The abstract interaction graph as JSON, DOT, SVG and HTML."""

import json
import re
from xml.etree import ElementTree as ET

import pytest

from rtron.functions.graph import AbstractGraph, PackageUse, abstract_graph
from rtron.reports.functions.dot import functions_to_dot
from rtron.reports.functions.graph_json import functions_to_json
from rtron.reports.functions.ground import NODE_WIDTH
from rtron.reports.functions.html import functions_to_html
from rtron.reports.functions.layout import LEGEND_WIDTH, lay_out
from rtron.reports.functions.svg import functions_to_svg
from rtron.vocabulary import Evidence, Unresolved
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
BUSY = abstract_graph(
    [use(f"p{n}", f, sends=[f"{f.lower()}_msgs/VeryLongName{n}"]) for n, f in enumerate(F)]
    + [
        use(f"h{n}", f, hears=[f"{g.lower()}_msgs/VeryLongName{m}" for m, g in enumerate(F)][n::4])
        for n, f in enumerate(F)
    ]
)
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
        "from_depends": 0,
        "to_depends": 0,
        "basis": "source",
    }
    typical = sum(len(messages) for messages in edges.values()) - 1
    assert document["known"] == {"source": 1, "manifest": 0, "typical": typical}
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
    assert f"{TWIST}: read in source, 1 -> 1 package" in told["Path Tracking", "Mobile"]
    assert "nav_msgs/Odometry: assumed" in told["Mobile", "Localization"]
    assert "motion: Path Tracking -> Localization" in told["Path Tracking", "Localization"]


def look_of(document, source, target):
    root = ET.fromstring(document)
    (edge,) = (p for p in root.iter(f"{SVG}path") if joins(p, source, target))
    (label,) = (t for t in root.iter(f"{SVG}text") if joins(t, source, target))
    words = {"".join(row.itertext()): row.get("font-style") for row in label.iter(f"{SVG}tspan")}
    return float(edge.get("stroke-width")), words


def joins(item, source, target):
    return (item.get("data-from"), item.get("data-to")) == (source, target)


def test_what_is_assumed_is_lighter_than_what_was_read():
    senders = [use("a", F.PATH_TRACKING, sends=[TWIST]), use("b", F.TELEOPERATION)]
    text = functions_to_svg(abstract_graph([*senders, use("c", F.MOBILE, hears=[TWIST])]))
    read, words = look_of(text, "Path Tracking", "Mobile")
    assert words == {
        TWIST: None,
        "ackermann_msgs/": "italic",
        "AckermannDriveStamped": "italic",
    }
    assumed, words = look_of(text, "Teleoperation", "Mobile")
    assert words == {TWIST: "italic"}
    assert assumed < read


@pytest.mark.parametrize("write", [functions_to_svg, functions_to_html, functions_to_dot])
def test_it_is_told_how_much_was_read(write):
    assert "read in source 1, from manifests 0, assumed 4." in write(SMALL)
    assert "read in source 0, from manifests 0, assumed" in write(WHOLE)


def test_the_legend_explains_the_looks_that_are_there():
    assert "assumed: typical of both functions" in functions_to_svg(WHOLE)
    assert "read in source: programs" not in functions_to_svg(WHOLE)
    assert "read in source: programs" in functions_to_svg(SMALL)


@pytest.mark.parametrize("graph", [AbstractGraph(), SMALL, WHOLE])
def test_svg_is_described_and_hides_nothing_in_it(graph):
    root = ET.fromstring(functions_to_svg(graph))
    title, description = root.find(f"{SVG}title"), root.find(f"{SVG}desc")
    assert root.get("aria-labelledby") == f"{title.get('id')} {description.get('id')}"
    assert all(node.name in description.text for node in graph.functions)
    assert root.get("role") != "img"


NOTED = AbstractGraph(
    repeated=2,
    unresolved=(
        Unresolved(what="the program of /a", why="<b>", evidence=(Evidence(file="a.py", line=3),)),
    ),
)


def test_what_could_not_be_read_and_what_is_left_out_is_told():
    document = functions_to_json(NOTED)
    assert document["repeated"] == 2
    assert [note["what"] for note in document["unresolved"]] == ["the program of /a"]
    page = functions_to_html(NOTED)
    assert "1 thing in programs could not be read." in page
    assert "2 packages left out" in page
    assert "<li>the program of /a: &lt;b&gt; (a.py:3)</li>" in page
    assert "could not be read" not in functions_to_html(SMALL)


def test_each_change_of_the_environment_has_a_lane_and_shares_no_way():
    layout = lay_out(WHOLE, 3)
    assert len({lane.y for lane in layout.lanes}) == len(layout.lanes) == 3
    ways = {}
    for line in layout.indirect:
        for x in re.findall(r"M(\d+),[\d.]+ V", line.path):
            assert ways.setdefault(x, line.through) == line.through
    assert set(ways.values()) == {"motion", "sound", "switched devices"}


def test_the_lanes_tell_who_reaches_whom():
    lanes = lay_out(WHOLE, 3).lanes
    told = {
        (source, target, lane.line.through)
        for lane in lanes
        for source in lane.line.sources
        for target in lane.line.targets
    }
    assert told == {(e.source, e.target, e.through) for e in WHOLE.indirect}


def test_every_function_that_acts_or_is_reached_is_joined_to_its_lane():
    layout = lay_out(WHOLE, 3)
    for edge in WHOLE.indirect:
        its = [line for line in layout.indirect if line.through == edge.through]
        joined = [line for line in its if edge.source in line.sources]
        assert len({line.path for line in joined if line.sources == (edge.source,)}) >= 1
        assert any(line.targets == (edge.target,) for line in joined)


def test_a_picture_is_no_wider_than_its_columns_need():
    one = lay_out(abstract_graph([use("amcl", F.LOCALIZATION)]), 3)
    assert one.width < LEGEND_WIDTH + 2 * NODE_WIDTH
    two = lay_out(SMALL, 3)
    lefts = sorted({box.x for box in two.nodes.values()})
    assert lefts[2] - lefts[1] == lefts[1] - lefts[0]


@pytest.mark.parametrize("graph", [SMALL, WHOLE, BUSY])
def test_the_legend_stands_below_all_else(graph):
    layout = lay_out(graph, 5)
    assert layout.legend.y > layout.environment.bottom
    assert layout.legend.bottom < layout.height
    assert layout.legend.right < layout.width


def points(path):
    """Yield points of a curve, from its SVG path."""
    numbers = [float(n) for n in re.findall(r"-?[\d.]+", path)]
    knots = list(zip(numbers[::2], numbers[1::2], strict=True))
    for start in range(0, len(knots) - 1, 3):
        a, b, c, d = knots[start : start + 4]
        for t in (n / 50 for n in range(51)):
            w = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3)
            yield tuple(sum(u * p[i] for u, p in zip(w, (a, b, c, d), strict=True)) for i in (0, 1))


@pytest.mark.parametrize("graph", [SMALL, WHOLE, BUSY])
def test_no_curve_leads_over_a_function_that_it_does_not_join(graph):
    layout = lay_out(graph, 3)
    for line in layout.direct:
        others = [
            box for name, box in layout.nodes.items() if name not in line.sources + line.targets
        ]
        for x, y in points(line.path) if "C" in line.path else ():
            assert not any(b.x < x < b.right and b.y < y < b.bottom for b in others), line


def test_a_graph_without_control_has_no_environment():
    assert "Environment" not in functions_to_svg(abstract_graph([use("amcl", F.LOCALIZATION)]))
    assert "Environment" in functions_to_svg(SMALL)


def test_stages_stand_from_left_to_right_as_in_the_papers_figure():
    stages = lay_out(WHOLE, 3).stages
    assert list(stages) == ["Sensors", "Perception", "Planning", "Control", "Drivers"]
    lefts = [box.x for box in stages.values()]
    assert lefts == sorted(lefts)
    ends = [box.x + box.width for box in stages.values()]
    assert all(end <= left for end, left in zip(ends[:-1], lefts[1:], strict=True))


def test_every_function_stands_in_its_stage_and_on_no_other():
    layout = lay_out(WHOLE, 3)
    boxes = list(layout.nodes.values())
    for node in WHOLE.functions:
        stage = layout.stages["Sensors" if node.name == "Sensors" else str(node.domain)]
        box = layout.nodes[node.name]
        assert box.overlap(stage) == box.width * box.height
    pairs = [(a, b) for i, a in enumerate(boxes) for b in boxes[i + 1 :]]
    assert all(a.overlap(b) == 0 for a, b in pairs)


def test_the_environment_stands_below_and_all_is_inside_the_picture():
    layout = lay_out(WHOLE, 3)
    assert all(box.y + box.height < layout.environment.y for box in layout.nodes.values())
    assert layout.environment.y + layout.environment.height < layout.height
    assert max(box.x + NODE_WIDTH for box in layout.nodes.values()) < layout.width
    for line in (*layout.direct, *layout.indirect):
        numbers = [float(n) for n in re.findall(r"[\d.]+", line.path)]
        assert min(numbers) >= 0
        assert max(numbers) <= layout.width


@pytest.mark.parametrize("graph", [SMALL, WHOLE, BUSY])
def test_labels_stand_on_no_function_and_apart_from_one_another(graph):
    layout = lay_out(graph, 3)
    labels = [line.label for line in layout.direct if line.label]
    assert all(label.overlap(box) == 0 for label in labels for box in layout.nodes.values())
    assert not any(a.overlap(b) for i, a in enumerate(labels) for b in labels[:i])


def test_the_same_graph_gives_the_same_picture():
    assert functions_to_svg(WHOLE) == functions_to_svg(abstract_graph(ALL))


def test_dot_has_clusters_and_both_kinds_of_arrows():
    text = functions_to_dot(SMALL)
    assert [line for line in text.splitlines() if "label=" in line and "->" not in line][:2] == [
        '    label="Perception"',
        '    f0 [label="Localization\\n1 package"]',
    ]
    (read,) = (line for line in text.splitlines() if f'[label="{TWIST}' in line)
    assert "\\n(AckermannDriveStamped)" in read
    assert 'env0 [label="Environment\\nmotion"' in text
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
    assert f"<td>{TWIST}</td><td>read in source, 1 -&gt; 1 package</td>" in page
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
