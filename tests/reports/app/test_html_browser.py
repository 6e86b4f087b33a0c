"""The page in a real browser: Debian's chromium and chromium-driver."""

from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree as ET

import pytest
from app_graphs import AUTORACE
from finding_cases import HIGH, LOW
from report_cases import GRAPH, report_of, speaks

from chromium import open_chromium
from rtron.planning import propose_plan
from rtron.reports.app.html import graph_to_html
from rtron.risks import discover_risks
from rtron.vocabulary import Direction, Endpoint, Evidence, InteractionGraph, Node
from rtron.vocabulary.inventory import Command, Means, Mover, Thing

pytest.importorskip("selenium.webdriver", reason="needs Selenium")
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait


@pytest.fixture(scope="module")
def chromium():
    with open_chromium() as browser:
        yield browser


@pytest.fixture
def opened(chromium, tmp_path):
    """Open a page; after the test its console must be silent."""

    def open_page(graph, report, plan=None, findings=(), **parts):
        path = tmp_path / "graph.html"
        path.write_text(graph_to_html(graph, report, plan, findings, **parts), encoding="utf-8")
        chromium.get(path.as_uri())
        return chromium

    yield open_page
    assert chromium.get_log("browser") == []


@pytest.fixture(scope="module")
def autorace_file(tmp_path_factory):
    """Write the page of an app with a plan and a finding, which most tests open."""
    report = discover_risks(AUTORACE)
    path = tmp_path_factory.mktemp("autorace") / "graph.html"
    path.write_text(
        graph_to_html(AUTORACE, report, propose_plan(AUTORACE, report), [HIGH]), "utf-8"
    )
    return path


@pytest.fixture
def autorace(chromium, autorace_file):
    chromium.get(autorace_file.as_uri())
    yield chromium
    assert chromium.get_log("browser") == []


OF_ALL = "return [...document.querySelectorAll(arguments[0])].map((each) => {});"


def texts(page, selector):
    return page.execute_script(OF_ALL.format("each.textContent"), selector)


def labels(page, selector=".press"):
    return set(page.execute_script(OF_ALL.format("each.getAttribute('aria-label')"), selector))


def click(page, selector):
    page.find_element(By.CSS_SELECTOR, selector).click()


def press(page, selector):
    """Press a part of the picture by its key, since others may lie over it."""
    page.find_element(By.CSS_SELECTOR, selector).send_keys(Keys.ENTER)


def show_all(page):
    """Fit the whole graph into the stage, and wait until it is."""
    scale = "return document.getElementById('world').getScreenCTM().a"
    opened = page.execute_script(scale)
    click(page, "#zoom-fit")
    until(page, lambda: page.execute_script(scale) < opened)


def lit(page):
    return labels(page, ".box.lit > .press") | labels(page, "[data-topic].lit > .row")


RECTS = (
    "(({left, right, top, bottom}) => ({left, right, top, bottom}))(each.getBoundingClientRect())"
)


def rects(page, selector):
    return page.execute_script(OF_ALL.format(RECTS), selector)


def test_all_nodes_are_drawn_apart_where_they_can_be_seen_and_zoomed(autorace):
    nodes = {label for label in labels(autorace) if label.startswith("node ")}
    assert len(nodes) == 25
    boxes = rects(autorace, ".box")
    assert not [
        (a, b)
        for a, b in combinations(boxes, 2)
        if a["left"] < b["right"]
        and b["left"] < a["right"]
        and a["top"] < b["bottom"]
        and b["top"] < a["bottom"]
    ]
    (stage,) = rects(autorace, "#stage")
    show_all(autorace)
    for box in rects(autorace, ".box"):
        assert box["left"] >= stage["left"] - 1
        assert box["right"] <= stage["right"] + 1
        assert box["top"] >= stage["top"] - 1
    box = autorace.find_element(By.CSS_SELECTOR, "[aria-label='node /gazebo']")
    before = box.rect["width"]
    click(autorace, "#zoom-in")
    until(autorace, lambda: box.rect["width"] > 1.2 * before)
    click(autorace, "#zoom-fit")
    until(autorace, lambda: abs(box.rect["width"] - before) < 1)


def test_a_risk_lights_its_part_and_explains_itself(autorace):
    autorace.find_element(By.CSS_SELECTOR, "#paper-risks > summary").click()
    item = next(
        e
        for e in autorace.find_elements(By.CSS_SELECTOR, "#risks .item")
        if e.text.split() == ["high", "/cmd_vel"]
    )
    item.click()
    assert lit(autorace) == {
        "topic /cmd_vel",
        *(f"node /{name}" for name in ("control_lane", "control_parking", "detect_tunnel")),
        "node /move_base",
        "node /gazebo",
    }
    detail = autorace.find_element(By.ID, "detail").text
    assert "all publish /cmd_vel" in detail
    assert len(autorace.find_elements(By.CSS_SELECTOR, ".edge.lit")) == 5


def test_at_risk_only_leaves_out_the_rest(autorace):
    assert "topic /move_base/result" in labels(autorace)
    click(autorace, "#only-risks")
    after = labels(autorace)
    assert "topic /move_base/result" not in after
    assert {"topic /cmd_vel", "node /gazebo"} <= after


def test_filters_hide_a_package_all_but_one_value_and_everything(autorace):
    click(autorace, "#filters summary")
    click(autorace, "[data-facet=package] input[value=rviz]")
    assert "node /rviz" not in labels(autorace)
    click(autorace, "[data-facet=package] input[value=rviz]")
    assert "node /rviz" in labels(autorace)
    only = autorace.find_element(By.CSS_SELECTOR, "[data-facet=trust] .facet:last-child .only")
    only.send_keys(Keys.ENTER)
    assert "node /detect_lane" not in labels(autorace)
    assert "node /gazebo" in labels(autorace)
    only.send_keys(Keys.ENTER)
    assert "node /detect_lane" in labels(autorace)
    for value in autorace.find_elements(By.CSS_SELECTOR, "[data-facet=trust] input"):
        value.click()
    assert autorace.find_element(By.ID, "empty").is_displayed()
    assert labels(autorace, ".box > .press") == set()


def test_a_node_shows_where_its_endpoints_were_read(opened):
    at = (Evidence(file="src/lane.py", line=7),)
    end = speaks("/lane", "/cmd_vel", declared_name="cmd", evidence=at, type="t/Twist")
    nodes = (Node(name="/lane", package="lanes", executable="lane.py"),)
    page = opened(InteractionGraph(app="a", nodes=nodes, endpoints=(end,)), report_of())
    press(page, "[aria-label='node /lane']")
    detail = page.find_element(By.ID, "detail").text.splitlines()
    assert {"lanes", "lane.py", "/cmd_vel", "t/Twist literal", "src/lane.py:7"} <= set(detail)
    assert "remapped from cmd" in detail


def test_what_stayed_unresolved_is_listed(opened):
    page = opened(GRAPH, report_of())
    click(page, "#unresolved-list summary")
    click(page, "#unresolved summary")
    assert page.find_element(By.ID, "unresolved").text.splitlines() == [
        "Not followed in the source 1",
        "look at these places yourself",
        "a publisher of /odd",
        "its name comes from a service call",
        "src/odd.cpp:12",
    ]


def test_implicit_endpoints_come_when_asked_for(opened):
    ends = (("/lane", "/cmd_vel", False), ("/lane", "/rosout", True))
    endpoints = tuple(
        Endpoint(node=n, topic=t, direction=Direction.PUBLISH, implicit=i) for n, t, i in ends
    )
    page = opened(InteractionGraph(app="a", endpoints=endpoints), report_of())
    assert labels(page) == {"node /lane"}
    click(page, "#leaves")
    assert labels(page) == {"node /lane", "topic /cmd_vel"}
    click(page, "#implicit")
    assert labels(page) == {"node /lane", "topic /cmd_vel", "topic /rosout"}


def test_the_theme_can_be_chosen_and_the_saved_picture_stands_alone(autorace):
    found = []
    for _ in range(2):
        click(autorace, "#theme")
        found.append(
            autorace.execute_script("return getComputedStyle(document.body).backgroundColor")
        )
    assert found == ["rgb(246, 247, 249)", "rgb(18, 22, 28)"]
    text = autorace.execute_async_script(
        "const done = arguments[0];"
        "URL.createObjectURL = (blob) => { blob.text().then(done); return '#'; };"
        "document.getElementById('save').click();"
    )
    picture = ET.fromstring(text)
    names = [e.get("aria-label") for e in picture.iter("{http://www.w3.org/2000/svg}g")]
    assert "node /gazebo" in names
    assert "--edge" in picture.find("{http://www.w3.org/2000/svg}style").text


def test_coordination_nodes_show_their_flows(autorace):
    press(autorace, "[aria-label^='GRCN of /cmd_vel']")
    detail = autorace.find_element(By.ID, "detail").text
    assert "Preemption" in detail
    assert {"flow1", "flow4"} <= set(texts(autorace, ".edge.lit .flow"))
    press(autorace, "[aria-label='MSRCN msrcn']")
    assert autorace.find_elements(By.CSS_SELECTOR, ".edge.lane.lit")
    assert "set for 2 s after a message" in autorace.find_element(By.ID, "detail").text
    click(autorace, "#overlay")
    assert not [label for label in labels(autorace) if "RCN" in label]


def test_search_finds_opens_and_chooses(autorace):
    field = autorace.find_element(By.ID, "search")
    assert "topic /move_base/status" not in labels(autorace)
    assert "topic /move_base/feedback" not in labels(autorace)
    click(autorace, "#leaves")
    assert "topic /move_base/feedback" in labels(autorace)
    assert "topic /move_base/status" not in labels(autorace)
    field.send_keys("move_base/status", Keys.ENTER)
    assert "topic /move_base/status" in lit(autorace)
    field.clear()
    field.send_keys("no such name")
    assert "Nothing has this name" in autorace.find_element(By.ID, "found").text


def test_the_keys_lead_through_the_graph(autorace):
    start = autorace.find_element(By.CSS_SELECTOR, "[aria-label='node /gazebo']")
    start.send_keys(Keys.ARROW_RIGHT)
    reached = autorace.switch_to.active_element
    assert reached.get_attribute("aria-label").startswith(("topic ", "GRCN of ", "node "))
    assert reached.rect["x"] > start.rect["x"]
    reached.send_keys(Keys.ENTER)
    assert autorace.find_element(By.ID, "detail").is_displayed()
    reached.send_keys(Keys.ESCAPE)
    assert not autorace.find_element(By.ID, "detail").is_displayed()
    assert lit(autorace) == set()


def test_a_box_is_dragged_with_its_edges(autorace):
    box = autorace.find_element(By.CSS_SELECTOR, "[aria-label='node /map_server']")
    show_all(autorace)
    before = box.rect
    edges = "return [...document.querySelectorAll('.edge .hit')].map((e) => e.getAttribute('d'))"
    ways = autorace.execute_script(edges)
    ActionChains(autorace).drag_and_drop_by_offset(box, -30, -60).perform()
    assert abs(box.rect["y"] - before["y"] + 60) < 3
    moved = [a for a, b in zip(ways, autorace.execute_script(edges), strict=True) if a != b]
    assert len(moved) == 1


def test_what_is_left_out_comes_when_it_is_chosen(autorace):
    assert "topic /move_base/feedback" not in labels(autorace)
    autorace.find_element(By.ID, "search").send_keys("move_base/feedback", Keys.ENTER)
    assert "topic /move_base/feedback" in lit(autorace)
    assert autorace.find_element(By.ID, "leaves").get_attribute("aria-pressed") == "true"


def until(page, condition):
    """Wait for what the next frame shows."""
    WebDriverWait(page, 10, 0.05).until(lambda _: condition())


def test_a_stranger_s_markup_is_shown_as_text(opened):
    evil = "</script><img src=x onerror='document.title=1'><b>x"
    endpoint = Endpoint(node=evil, topic=evil, direction=Direction.PUBLISH, type=evil)
    graph = InteractionGraph(
        app=evil, nodes=(Node(name=evil, package=evil),), endpoints=(endpoint,)
    )
    page = opened(graph, report_of())
    press(page, ".press.pill")
    assert texts(page, "#detail h2") == [evil]
    assert texts(page, "h1") == [evil]
    assert not page.find_elements(By.CSS_SELECTOR, "img")


@pytest.mark.long
def test_a_large_graph_is_laid_out_quickly(opened):
    medium, large = (layout_time(opened, topics) for topics in (200, 800))
    assert large < 64 * medium


def layout_time(opened, topics):
    """Return how long a page lays out a graph with four topics a node, ms."""
    count = topics // 4
    endpoints = [
        Endpoint(node=f"/n{n % count}", topic=f"/t{t}", direction=direction)
        for t in range(topics)
        for n, direction in ((t, Direction.PUBLISH), (t * 7 + t // 9, Direction.SUBSCRIBE))
    ]
    page = opened(InteractionGraph(app="large", endpoints=tuple(endpoints)), report_of())
    assert len([label for label in labels(page) if label.startswith("node ")]) == count
    return page.execute_script(
        "const start = performance.now();"
        "document.getElementById('implicit').click();"
        "return performance.now() - start"
    )


def test_a_finding_stands_first_and_tells_what_to_do(opened):
    finding = replace(HIGH, nodes=("/lane", "/nowhere"), topics=("/cmd_vel", "a service"))
    page = opened(GRAPH, report_of(), None, [finding])
    (first,) = page.find_elements(By.CSS_SELECTOR, "#findings .item")
    assert first.text.split("\n") == ["high", finding.summary]
    first.click()
    detail = page.find_element(By.ID, "detail").text
    for text in (finding.summary, finding.cause, finding.remedy, "src/nav.py:7", "/lane"):
        assert text in detail
    assert "1 finding" in texts(page, "#counts")[0]
    assert {"node /lane", "topic /cmd_vel"} <= lit(page)


def test_a_leaf_that_the_page_names_is_drawn(opened):
    ends = (
        Endpoint(node="/lane", topic=name, direction=Direction.PUBLISH)
        for name in ("/x", "/y", "/z")
    )
    graph = replace(GRAPH, endpoints=(*GRAPH.endpoints, *ends))
    finding = replace(HIGH, nodes=("/lane",), topics=("/x",))
    command = Command(means=Means.TOPIC, name="/y")
    mover = Mover(thing=Thing.BASE, commands=(command, replace(command, name="/z", hops=1)))
    page = opened(graph, report_of(), None, [finding], inventory=[mover])
    drawn = {"topic /x", "topic /y", "topic /z"} & set(labels(page))
    assert drawn == {"topic /x", "topic /y"}


LABEL_SIZES = """
const stage = document.getElementById("picture").getBoundingClientRect();
const isSeen = (r) => r.right > stage.left && r.left < stage.right
  && r.bottom > stage.top && r.top < stage.bottom;
return [...document.querySelectorAll("#world text")]
  .filter((each) => getComputedStyle(each).display !== "none")
  .filter((each) => isSeen(each.getBoundingClientRect()))
  .map((each) => parseFloat(getComputedStyle(each).fontSize) * each.getScreenCTM().a);
"""


@pytest.fixture
def screen(chromium):
    """Give the browser a screen's size; it has its own again after the test."""

    def set_size(width, height):
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    yield set_size
    chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.parametrize(("width", "height"), [(1300, 900), (390, 844)])
def test_the_graph_opens_readable(screen, chromium, autorace_file, width, height):
    screen(width, height)
    page = chromium
    page.get(autorace_file.as_uri())
    WebDriverWait(page, 10).until(lambda page: page.execute_script(LABEL_SIZES))
    assert min(page.execute_script(LABEL_SIZES)) >= 11
    assert len(page.execute_script(LABEL_SIZES)) >= 5
    assert page.execute_script("return document.documentElement.scrollWidth") <= width


def test_on_a_phone_a_findings_node_is_in_the_middle_above_its_details(screen, chromium, tmp_path):
    screen(390, 844)
    graph, path = AUTORACE, tmp_path / "addressed.html"
    report, finding = discover_risks(graph), replace(HIGH, nodes=(), topics=("/cmd_vel",))
    path.write_text(graph_to_html(graph, report, None, [finding], {}), encoding="utf-8")
    chromium.get("about:blank")
    chromium.get(f"{path.as_uri()}#finding:{finding.id}")
    WebDriverWait(chromium, 10).until(lambda page: page.execute_script(LABEL_SIZES))
    top, bottom, lit = chromium.execute_script("""
        const rect = (element) => element.getBoundingClientRect();
        const top = (selector) => rect(document.querySelector(selector)).top;
        const lit = [...document.querySelectorAll(".box.lit")].map(rect);
        const middles = lit.map((each) => (each.top + each.bottom) / 2);
        return [top("#picture"), top("#detail"), middles];
    """)
    assert lit
    assert abs((min(lit) + max(lit)) / 2 - (top + bottom) / 2) < (bottom - top) / 8


def test_the_head_counts_findings_by_severity(opened):
    others = [replace(LOW, subject=f"/other{i}") for i in range(2)]
    page = opened(GRAPH, report_of(), None, [HIGH, *others])
    assert texts(page, "#counts .severity") == ["1 high", "2 low"]


def test_a_finding_has_an_address_with_its_remedy_rule_and_lines(opened, tmp_path):
    place = HIGH.evidence[0]
    path = tmp_path / "lines.html"
    lines = {place: "pub = Publisher('/cmd_vel')"}
    path.write_text(graph_to_html(GRAPH, report_of(), None, [HIGH], lines), encoding="utf-8")
    page = opened(GRAPH, report_of())
    page.get(f"{path.as_uri()}#finding:{HIGH.id}")
    said = page.find_element(By.ID, "detail").text
    for text in (HIGH.summary, HIGH.remedy, HIGH.rule, "pub = Publisher('/cmd_vel')"):
        assert text in said
    page.find_element(By.CSS_SELECTOR, "#detail .close").click()
    assert "#" not in page.current_url
    page.find_element(By.CSS_SELECTOR, "#findings .item").click()
    assert page.current_url.endswith(f"#finding:{HIGH.id}")
    page.execute_script("location.hash = '#finding:none%'")
    assert page.find_element(By.ID, "detail").is_displayed()


def test_the_findings_are_printed_in_full(opened):
    page = opened(GRAPH, report_of(), None, [HIGH])
    assert not page.find_element(By.ID, "printed").is_displayed()
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        said = page.find_element(By.ID, "printed").text
        assert not page.find_element(By.TAG_NAME, "main").is_displayed()
    finally:
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    assert HIGH.summary in said
    assert HIGH.remedy in said
