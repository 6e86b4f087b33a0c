"""The abstract interaction graph as JSON, DOT, SVG and HTML."""

import json
import re
from itertools import combinations, pairwise
from xml.etree import ElementTree as ET

import pytest

from rtron.errors import InputError
from rtron.functions.interactions.abstract_graph import (
    AbstractGraph,
    PackageMessages,
    abstract_graph,
)
from rtron.reports.functions.dot import functions_to_dot
from rtron.reports.functions.html import functions_to_html
from rtron.reports.functions.json_documents import functions_to_json
from rtron.reports.functions.svg import functions_to_svg
from rtron.vocabulary import Evidence, UnresolvedItem
from rtron.vocabulary import FunctionType as F

TWIST = "geometry_msgs/Twist"
EVIL = 'x_msgs/A"<script>alert(1)</script>&\n\x1b[31m'
SVG = "{http://www.w3.org/2000/svg}"
ALL = [PackageMessages(name=f"p{number}", functions=(f,)) for number, f in enumerate(F)]


def use(name, function, sends=(), hears=()):
    return PackageMessages(
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
    assert sorted(names) == sorted(node.name for node in graph.functions)
    assert not list(root.iter(f"{SVG}script"))


def test_svg_tells_what_flows_and_how_it_is_known():
    root = ET.fromstring(functions_to_svg(SMALL))
    told = {
        (group.get("data-from"), group.get("data-to")): "".join(group.itertext())
        for group in root.iter(f"{SVG}g")
        if group.get("class") == "edge"
    }
    assert f"{TWIST}: read in source, 1 -> 1 package" in told["Path Tracking", "Mobile"]
    assert "nav_msgs/Odometry: assumed" in told["Mobile", "Localization"]
    assert "motion: Path Tracking -> Localization" in told["Path Tracking", "Localization"]


def look_of(document, source, target):
    root = ET.fromstring(document)
    (edge,) = (g for g in root.iter(f"{SVG}g") if joins(g, source, target))
    words = {text.text.strip(): text.get("font-style") for text in edge.iter(f"{SVG}text")}
    return float(edge.find(f"{SVG}path").get("stroke-width", 1)), words


def joins(item, source, target):
    return (item.get("data-from"), item.get("data-to")) == (source, target)


def test_what_is_assumed_is_lighter_than_what_was_read():
    senders = [use("a", F.PATH_TRACKING, sends=[TWIST]), use("b", F.TELEOPERATION)]
    text = functions_to_svg(abstract_graph([*senders, use("c", F.MOBILE, hears=[TWIST])]))
    read, words = look_of(text, "Path Tracking", "Mobile")
    assert words == {TWIST: None, "ackermann_msgs/": "italic", "AckermannDriveStamped": "italic"}
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
        UnresolvedItem(
            what="the program of /a", why="<b>", evidence=(Evidence(file="a.py", line=3),)
        ),
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


def boxes(document):
    """Return the rectangle of each function, stage, and label of a picture, by kind and name."""
    root = ET.fromstring(document)
    found = {"function": {}, "cluster": {}, "label": []}
    for group in root.iter(f"{SVG}g"):
        kind = group.get("class")
        if kind == "function":
            found[kind][group.get("data-name")] = ellipse_box(group.find(f"{SVG}ellipse"))
        elif kind == "cluster":
            found[kind][group.find(f"{SVG}text").text.strip()] = path_box(group.find(f"{SVG}path"))
        elif kind in ("edge", "label"):
            rows = [text_box(text) for text in group.iter(f"{SVG}text")]
            found["label"] += [union(rows)] if rows else []
    return found


def ellipse_box(ellipse):
    x, y, rx, ry = (float(ellipse.get(key)) for key in ("cx", "cy", "rx", "ry"))
    return x - rx, y - ry, x + rx, y + ry


def path_box(path):
    numbers = [float(n) for n in re.findall(r"-?[\d.]+", path.get("d"))]
    xs, ys = numbers[::2], numbers[1::2]
    return min(xs), min(ys), max(xs), max(ys)


def text_box(text):
    x, y, width = float(text.get("x")), float(text.get("y")), len(text.text.strip()) * 4.4
    left = x - (width / 2 if text.get("text-anchor") == "middle" else 0)
    return left, y - 7, left + width, y


def union(rows):
    lefts, tops, rights, bottoms = zip(*rows, strict=True)
    return min(lefts), min(tops), max(rights), max(bottoms)


def meet(a, b):
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def test_the_arrows_tell_who_reaches_whom_through_the_environment():
    root = ET.fromstring(functions_to_svg(WHOLE))
    changes = {edge.through for edge in WHOLE.indirect}
    found = set()
    for group in root.iter(f"{SVG}g"):
        through = (group.findtext(f"{SVG}title") or "").partition(":")[0]
        if group.get("class") == "label" and through in changes:
            sources, targets = (group.get(key).split("|") for key in ("data-from", "data-to"))
            found |= {(source, target, through) for source in sources for target in targets}
    assert found == {(edge.source, edge.target, edge.through) for edge in WHOLE.indirect}


def test_every_function_that_acts_or_is_reached_has_an_arrow_of_its_own():
    root = ET.fromstring(functions_to_svg(WHOLE))
    edges = [g for g in root.iter(f"{SVG}g") if g.get("class") == "edge"]
    for edge in WHOLE.indirect:
        its = [g for g in edges if (g.findtext(f"{SVG}title") or "").startswith(f"{edge.through}:")]
        assert any(g.get("data-from") == edge.source for g in its)
        assert any(g.get("data-to") == edge.target for g in its)


@pytest.mark.parametrize("graph", [SMALL, WHOLE, BUSY])
def test_stages_stand_from_left_to_right_as_in_the_papers_figure(graph):
    stages = boxes(functions_to_svg(graph))["cluster"]
    order = ["Sensors", "Perception", "Planning", "Control", "Drivers"]
    spans = [stages[name] for name in order if name in stages]
    assert len(spans) >= 3
    assert all(left[2] <= right[0] for left, right in pairwise(spans))
    assert not any(meet(a, b) for a, b in combinations(stages.values(), 2))


@pytest.mark.parametrize("graph", [SMALL, WHOLE, BUSY])
def test_every_function_stands_in_its_stage_and_on_no_other(graph):
    found = boxes(functions_to_svg(graph))
    for node in graph.functions:
        left, top, right, bottom = found["function"][node.name]
        stage = found["cluster"]["Sensors" if node.name == "Sensors" else str(node.domain)]
        assert stage[0] <= left < right <= stage[2]
        assert stage[1] <= top < bottom <= stage[3]
    assert not any(meet(a, b) for a, b in combinations(found["function"].values(), 2))


@pytest.mark.parametrize("graph", [SMALL, WHOLE, BUSY])
def test_labels_stand_on_no_function_and_apart_from_one_another(graph):
    found = boxes(functions_to_svg(graph))
    functions, labels = found["function"].values(), found["label"]
    assert not any(meet(label, box) for label in labels for box in functions)
    assert not any(meet(a, b) for a, b in combinations(labels, 2))


def test_a_graph_without_control_has_no_environment():
    assert "Environment" not in functions_to_svg(abstract_graph([use("amcl", F.LOCALIZATION)]))
    assert "Environment" in functions_to_svg(SMALL)


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
    document = functions_to_svg(graph)
    functions = boxes(document)["function"]
    for group in ET.fromstring(document).iter(f"{SVG}g"):
        if group.get("class") == "edge":
            ends = f"{group.get('data-from')}|{group.get('data-to')}".split("|")
            others = [box for name, box in functions.items() if name not in ends]
            for x, y in points(group.find(f"{SVG}path").get("d")):
                assert not any(inside(x, y, box) for box in others), group.findtext(f"{SVG}title")


def inside(x, y, box):
    across, down = (box[2] - box[0]) / 2, (box[3] - box[1]) / 2
    return ((x - box[0]) / across - 1) ** 2 + ((y - box[1]) / down - 1) ** 2 < 0.95


def test_a_picture_needs_graphviz(monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InputError, match="Graphviz") as error:
        functions_to_svg(SMALL)
    assert "apt-get install graphviz" in error.value.help


def test_the_same_graph_gives_the_same_picture():
    assert functions_to_svg(WHOLE) == functions_to_svg(abstract_graph(ALL))


def test_dot_has_clusters_and_both_kinds_of_arrows():
    text = functions_to_dot(SMALL)
    (perception,) = (line for line in text.splitlines() if "Perception" in line)
    assert "label=<<b>Perception</b>>" in perception
    (read,) = (line for line in text.splitlines() if f"<b>{TWIST}</b>" in line)
    assert "<i>AckermannDriveStamped</i>" in read
    assert 'env0 [id="env0", label=<motion>' in text
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
    assert "A&quot;&lt;script&gt;alert(1)" in edge
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
    assert not re.search('class="edge"[^>]* data-from="Teleoperation" data-to="Speaker"', page)
    assert "not drawn" not in functions_to_html(SMALL)
