"""Scores, alone and beside the script that came with the ground truth."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from evaluation.ros1.architecture import KINDS, Architecture, Score, read_architecture, score
from evaluation.ros1.rosdiscover import SYSTEMS

PAIRS = frozenset({("/a", "/x"), ("/a", "/y"), ("/b", "/x"), ("/b", "/z")})
TRUTH = Path(os.environ.get("RTRON_DATA", "")) / "groundtruth"
PEER = "cmu-rss-lab/rosdiscover-evaluation@4648ad9/experiments/recovery/subjects"
needs_truth = pytest.mark.skipif(
    "RTRON_DATA" not in os.environ, reason="RTRON_DATA names no folder with groundtruth/"
)
needs_apps = pytest.mark.skipif(
    "RTRON_APPS" not in os.environ, reason="RTRON_APPS names no folder of apps"
)


def test_precision_and_recall():
    found = Score(PAIRS, frozenset({("/a", "/x"), ("/c", "/x")}))
    assert (found.hits, found.precision, found.recall) == (1, 0.5, 0.25)
    assert list(found.differences()) == [
        "MISSED /a /y",
        "MISSED /b /x",
        "MISSED /b /z",
        "EXTRA  /c /x",
    ]


def test_nothing_to_find_and_nothing_found():
    nothing = frozenset()
    assert (Score(nothing, nothing).precision, Score(nothing, nothing).recall) == (1, 1)
    assert (Score(PAIRS, nothing).precision, Score(PAIRS, nothing).recall) == (1, 0)
    assert (Score(nothing, PAIRS).precision, Score(nothing, PAIRS).recall) == (0, 1)


def test_ignored_names_count_when_raw():
    observed = Architecture(publishers=frozenset({("/a", "/tf"), ("/a", "/x")}))
    recovered = Architecture(publishers=frozenset({("/a", "/x")}))
    assert score(observed, recovered, raw=False)["publishers"].recall == 1
    assert score(observed, recovered, raw=True)["publishers"].recall == 0.5


NAMES = ["/x", "/tf", "/m/bond", *(f"/m/{p}" for p in ("goal", "cancel", "status", "feedback"))]
NODES = st.lists(
    st.fixed_dictionaries(
        {
            "fullname": st.sampled_from(["/a", "/b", "/c"]),
            "pubs": st.sets(st.sampled_from([*NAMES, "/m/result"])),
            "subs": st.sets(st.sampled_from([*NAMES, "/m/result"])),
            "provides": st.sets(st.sampled_from(["/go", "/a/set_parameters"])),
        }
    ),
    max_size=3,
)


def write_architecture(path, nodes):
    kinds = ("pubs", "subs", "provides")
    rows = [
        node | {kind: [{"name": name} for name in sorted(node[kind])] for kind in kinds}
        for node in nodes
    ]
    path.write_text(yaml.safe_dump(rows))
    return path


def reference_scores(observed, recovered, *flags):
    """Return what the script of the ground truth prints: observed, recovered, hits by kind."""
    command = [sys.executable, str(TRUTH / "score.py"), str(observed), str(recovered), *flags]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = re.findall(r"(?m)^\w+ +observed +(\d+) recovered +(\d+) tp +(\d+)", text)
    return dict(zip(KINDS, [tuple(map(int, row)) for row in rows], strict=True))


def rtron_scores(observed, recovered, *, raw):
    found = score(read_architecture(observed), read_architecture(recovered), raw=raw)
    return {kind: (len(s.observed), len(s.recovered), s.hits) for kind, s in found.items()}


@needs_truth
@pytest.mark.timeout(300)
@settings(max_examples=25, deadline=None)
@given(observed=NODES, recovered=NODES)
def test_any_two_architectures_score_as_the_script_scores_them(
    tmp_path_factory, observed, recovered
):
    folder = tmp_path_factory.mktemp("yaml")
    files = [
        write_architecture(folder / "o.yml", observed),
        write_architecture(folder / "r.yml", recovered),
    ]
    assert rtron_scores(*files, raw=False) == reference_scores(*files)
    assert rtron_scores(*files, raw=True) == reference_scores(*files, "--raw")


@needs_truth
@needs_apps
@pytest.mark.parametrize("system", ["autorally", "turtlebot"])
def test_the_peers_architectures_score_as_the_script_scores_them_and_as_we_say(system):
    recovered = Path(os.environ["RTRON_APPS"]) / PEER / system / "recovered.architecture.yml"
    if not recovered.is_file():
        pytest.skip("RTRON_APPS lacks cmu-rss-lab/rosdiscover-evaluation")
    observed = TRUTH / system / "observed.architecture.yml"
    assert rtron_scores(observed, recovered, raw=False) == reference_scores(observed, recovered)
    assert rtron_scores(observed, recovered, raw=True) == reference_scores(
        observed, recovered, "--raw"
    )
    found = score(read_architecture(observed), read_architecture(recovered), raw=False)
    for kind, peer in SYSTEMS[system].items():
        assert found[kind].precision == pytest.approx(peer.precision, abs=6e-4)
        assert found[kind].recall == pytest.approx(peer.recall, abs=6e-4)
