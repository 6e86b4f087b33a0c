"""The console's files as the service gives them: by exact name, for ever, and nothing else."""

import gzip
import re
from importlib.resources import files

import httpx
import pytest
from harness import LIMIT_S

from rtron.service.console.routes import digest, static_files


@pytest.fixture
def get(console):
    with httpx.Client(
        base_url=console.base, headers={"Accept-Encoding": "identity"}, timeout=LIMIT_S
    ) as client:
        yield client.get


def test_the_page_names_only_files_of_this_version(get):
    page = get("/")
    assert page.status_code == 200
    assert page.headers["cache-control"] == "no-cache"
    named = re.findall(r'(?:href|src)="([^"]+)"', page.text)
    assert len(named) > 20
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
        ("base.css", "text/css"),
        ("icon.svg", "image/svg+xml"),
        ("graph/dagre.min.js", "text/javascript"),
        ("vendor/uplot.LICENSE.txt", "text/plain"),
    ):
        answer = get(f"/console/{digest()}/{name}")
        assert answer.headers["content-type"].startswith(type)
        assert "immutable" in answer.headers["cache-control"]
        assert answer.content == static_files()[name].content


def test_files_are_packed_for_who_can_unpack(console):
    with httpx.Client(base_url=console.base, timeout=LIMIT_S) as client:
        path = f"/console/{digest()}/main.js"
        with client.stream("GET", path, headers={"Accept-Encoding": "gzip"}) as answer:
            assert answer.headers["content-encoding"] == "gzip"
            assert gzip.decompress(b"".join(answer.iter_raw())) == static_files()["main.js"].content


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
        assert static_files()[f"graph/{name}"].content == path.read_bytes()


def test_every_module_is_imported_by_a_name_that_exists():
    for name, asset in static_files().items():
        if not name.endswith(".js") or name.startswith("vendor/"):
            continue
        for found in re.findall(r'from "(\.[^"]+)"', asset.content.decode()):
            folder = name.split("/")[:-1]
            for part in found.split("/"):
                folder = folder[:-1] if part == ".." else folder if part == "." else [*folder, part]
            assert "/".join(folder) in static_files(), f"{name} imports {found}"


def test_no_module_makes_markup_of_text():
    for name, asset in static_files().items():
        if name.endswith(".js") and not name.startswith("vendor/") and ".min." not in name:
            text = asset.content.decode()
            for way in (
                "innerHTML",
                "outerHTML",
                "insertAdjacentHTML",
                "document.write",
                "eval(",
                "dangerouslySet",
            ):
                assert way not in text, f"{name}: {way}"
