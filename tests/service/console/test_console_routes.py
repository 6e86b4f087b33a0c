"""The console's files as the service gives them: by exact name, for ever, and nothing else."""

import gzip
import html
import re
from importlib.resources import files

import httpx
import pytest
from harness import LIMIT_S
from service_app import TLS

from rtron.service.console.routes import digest, source_files, static_files


@pytest.fixture
def get(console):
    with httpx.Client(
        base_url=console.base, headers={"Accept-Encoding": "identity"}, timeout=LIMIT_S, verify=TLS
    ) as client:
        yield client.get


def test_the_page_names_only_files_of_this_version(get):
    page = get("/")
    assert page.status_code == 200
    assert page.headers["cache-control"] == "no-cache"
    named = re.findall(r'(?:href|src)="(/console/[^"]+)"', page.text)
    assert len(named) == 4, "each costs a round trip"
    assert all(name.startswith(f"/console/{digest()}/") for name in named)
    assert {get(name).status_code for name in named} == {200}


def test_the_page_has_nothing_inline(get):
    text = get("/").text
    assert not re.search(r"<script(?![^>]* src=)", text)
    assert not re.search(r"<style|\sstyle=|\son\w+=", text)


def test_the_policy_has_no_way_round(get):
    for path in ("/", f"/console/{digest()}/main.js", "/console/x/main.js"):
        policy = get(path).headers["content-security-policy"]
        assert "default-src 'self'" in policy
        assert "unsafe" not in policy


def test_files_are_kept_for_ever_and_their_types_are_told(get):
    for name, type in (
        ("main.js", "text/javascript"),
        ("console.css", "text/css"),
        ("icon.svg", "image/svg+xml"),
        ("graph/dagre.min.js", "text/javascript"),
        ("vendor/uplot.LICENSE.txt", "text/plain"),
    ):
        answer = get(f"/console/{digest()}/{name}")
        assert answer.headers["content-type"].startswith(type)
        assert "immutable" in answer.headers["cache-control"]
        assert answer.content == static_files()[name].content


def test_files_are_packed_for_who_can_unpack(console):
    with httpx.Client(base_url=console.base, timeout=LIMIT_S, verify=TLS) as client:
        path = f"/console/{digest()}/main.js"
        with client.stream("GET", path, headers={"Accept-Encoding": "gzip"}) as answer:
            assert answer.headers["content-encoding"] == "gzip"
            assert gzip.decompress(b"".join(answer.iter_raw())) == static_files()["main.js"].content


def test_a_page_for_who_is_logged_in_asks_for_the_data_at_once(console, get):
    headers = console.people.session_headers("ada")
    asked = re.findall(r'as="fetch" crossorigin href="([^"]+)"', get("/", headers=headers).text)
    paths = [html.unescape(each) for each in asked]
    assert [get(path, headers=headers).status_code for path in paths] == [200, 200]
    assert get("/").text.count('as="fetch"') == 1, "who it is"


@pytest.mark.parametrize(
    "path",
    [
        "/console/{d}/../routes.py",
        "/console/{d}/%2e%2e/routes.py",
        "/console/{d}/..%2froutes.py",
        "/console/{d}/vendor/../../routes.py",
        "/console/{d}//etc/passwd",
        "/console/{d}/%2fetc%2fpasswd",
        "/console/{d}/main.js%00",
        "/console/{d}/",
        "/console/{d}/vendor",
        "/console/{d}/vendor/README.md",
        "/console/0000000000000000/main.js",
        "/console/main.js",
    ],
)
def test_nothing_else_is_given(path, get):
    answer = get(path.format(d=digest()))
    assert answer.status_code in (400, 404)
    assert "import" not in answer.text


def test_the_graph_is_that_of_the_html_report():
    shared = {path.name: path for path in (files("rtron.reports") / "page" / "graph").iterdir()}
    assert {"dagre.min.js", "layout.js", "draw.js"} <= set(shared)
    for name, path in shared.items():
        assert source_files()[f"graph/{name}"] == path.read_bytes()


def test_every_module_is_in_one_of_the_scripts():
    modules = {name for name in source_files() if name.endswith(".js")}
    bundled = {
        name
        for script in ("main.js", "later.js")
        for name in re.findall(
            r'^modules\["([^"]+)"\] =', static_files()[script].content.decode(), re.MULTILINE
        )
    }
    alone = {name for name in modules if name.endswith(".min.js")}
    assert bundled == modules - alone - {"theme.js"}


def test_no_module_makes_markup_of_text():
    for name, content in source_files().items():
        if name.endswith(".js") and not name.startswith("vendor/") and ".min." not in name:
            text = content.decode()
            for way in (
                "innerHTML",
                "outerHTML",
                "insertAdjacentHTML",
                "document.write",
                "eval(",
                "dangerouslySet",
            ):
                assert way not in text, f"{name}: {way}"
