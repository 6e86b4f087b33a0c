"""The sdist and the wheel: what is in them, and whether each runs in an environment of its own."""

import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from email.parser import BytesParser
from pathlib import Path

import pytest
from small_app import LAUNCH_FILE, write_app

from rtron import __version__

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "rtron"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
ADDRESS = PROJECT["urls"]["Source"]
UNITS = {path.name for path in (ROOT / "deploy" / "systemd").iterdir()}
UNREACHED = re.compile(
    "error sending request|dns error|Failed to fetch|not found in the package reg"
)
NO_INDEX = re.compile("NewConnectionError|No matching distribution|Temporary failure")
BESIDES = {"CHANGELOG.md", "LICENSE", "README.md", "pyproject.toml", "PKG-INFO", ".gitignore"}


def run_uv(*arguments):
    command = [sys.executable, "-m", "uv", *map(str, arguments)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if UNREACHED.search(ran.stderr):
        pytest.fail("no package index", pytrace=False)
    assert ran.returncode == 0, ran.stderr


pytestmark = pytest.mark.network


@pytest.fixture(scope="module")
def dist(tmp_path_factory):
    """Build the sdist from the repository, and the wheel from the sdist, as `build` does."""
    folder = tmp_path_factory.mktemp("dist")
    run_uv("build", "--quiet", "--out-dir", folder, ROOT)
    return folder


@pytest.fixture(scope="module")
def sdist(dist):
    return dist / f"rtron-{__version__}.tar.gz"


@pytest.fixture(scope="module")
def wheel(dist):
    return dist / f"rtron-{__version__}-py3-none-any.whl"


@pytest.fixture(scope="module")
def metadata(wheel):
    with zipfile.ZipFile(wheel) as archive:
        return BytesParser().parsebytes(archive.read(f"rtron-{__version__}.dist-info/METADATA"))


def source_files():
    files = (path for path in SOURCE.rglob("*") if path.is_file())
    return {path.relative_to(SOURCE.parent).as_posix() for path in files if path.suffix != ".pyc"}


def test_the_sdist_has_the_source_and_what_builds_it(sdist):
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    units = {f"deploy/systemd/{name}" for name in UNITS}
    assert names == BESIDES | units | {f"src/{name}" for name in source_files()}


def test_the_wheel_has_every_module_and_data_file_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    info, data = (f"rtron-{__version__}.{kind}/" for kind in ("dist-info", "data"))
    code = {name for name in names if not name.startswith((info, data))}
    assert code == source_files()
    units = {f"{data}data/share/rtron/systemd/{name}" for name in UNITS}
    assert {name for name in names if name.startswith(data)} == units
    assert {"rtron/py.typed", "rtron/service/console/static/index.html"} <= names
    licences = {name.removeprefix(f"{info}licenses/") for name in names if "/licenses/" in name}
    assert licences == {
        path.relative_to(ROOT).as_posix()
        for pattern in PROJECT["license-files"]
        for path in ROOT.glob(pattern)
    }


def test_programs_of_the_demo_stay_programs(wheel):
    with zipfile.ZipFile(wheel) as archive:
        modes = {each.filename: each.external_attr >> 16 for each in archive.infolist()}
    programs = {name: mode for name, mode in modes.items() if "/scripts/" in name}
    assert programs
    for name, mode in programs.items():
        assert mode & 0o111 == (SOURCE.parent / name).stat().st_mode & 0o111, name


def test_links_and_pictures_of_the_package_page_lead_to_files_of_the_repository(metadata):
    page = metadata.get_payload()
    links = re.findall(r"\]\(([^)]+)\)", page)
    assert len(links) > 20
    raw = ADDRESS.replace("github.com", "raw.githubusercontent.com")
    for link in links:
        base = next(
            base for base in (f"{ADDRESS}/blob/main/", f"{raw}/main/") if link.startswith(base)
        )
        path = ROOT / link.removeprefix(base).partition("#")[0]
        assert path.is_file(), link
        is_picture = path.suffix in {".png", ".svg"}
        assert is_picture == (base.startswith(raw)), link


def test_the_project_links_are_of_one_repository(metadata):
    links = dict(line.split(", ") for line in metadata.get_all("Project-URL"))
    assert links.keys() == {"Source", "Issues", "Documentation", "Changelog"}
    assert all(link.startswith(ADDRESS) for link in links.values())


def test_the_readme_s_installation_works_as_pasted(tmp_path):
    """What RTron needs is there already, as beside these tests: the wheel is installed with it."""
    (block,) = re.findall(r"```sh\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    clone = tmp_path / "rtron"
    subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
    quick = os.environ | {"PIP_NO_COMPILE": "1", "PYTHONPATH": sysconfig.get_path("purelib")}
    ran = subprocess.run(
        ["bash", "-ec", block], cwd=clone, env=quick, capture_output=True, text=True, check=False
    )
    if NO_INDEX.search(ran.stderr):
        pytest.fail("no package index", pytrace=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.endswith(f"rtron {__version__}\n")
    assert list(clone.glob("rtron-env/lib/python*/site-packages/rtron/py.typed"))


def test_the_wheel_is_installed_and_scans_an_app(wheel, tmp_path):
    """It was built from the sdist."""
    run_uv("venv", "--quiet", "--python", sys.executable, tmp_path / "venv")
    python = tmp_path / "venv" / "bin" / "python"
    run_uv("pip", "install", "--quiet", "--python", python, wheel)

    def rtron(*arguments):
        environment = {"PATH": os.environ["PATH"], "HOME": str(tmp_path), "LANG": "C.UTF-8"}
        command = [python.with_name("rtron"), *map(str, arguments)]
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )

    assert rtron("--version").stdout == f"rtron {__version__}\n"
    assert "From an app to a guarded app" in rtron("--help").stdout
    scan = rtron("scan", write_app(tmp_path), "--launch", LAUNCH_FILE)
    assert (scan.returncode, scan.stderr) == (1, "")
    assert "/cmd_vel" in scan.stdout
    assert "pip install" in rtron("serve").stderr  # the service is an extra
