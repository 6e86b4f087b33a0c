from dataclasses import replace

from rtron.functions.classifier.result import (
    Classification,
    DecisionSource,
    InformationSource,
    RuleEvidence,
)
from rtron.functions.classifier.rule_trace import RuleMatch
from rtron.functions.classifier.tables import build_tables
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.reports.functions.classification import evidence_text
from rtron.reports.functions.json_documents import classification_to_json
from rtron.reports.functions.tables import tables_text
from rtron.vocabulary import FunctionType

MAPPING, PLANNING = FunctionType.MAPPING, FunctionType.PATH_PLANNING
CLASSIFIED = Classification(
    repo="nav",
    functions=(PLANNING, MAPPING),
    primary=PLANNING,
    probabilities={PLANNING: 0.9371, MAPPING: 0.71, FunctionType.SUPPORT: 0.2},
    decided_by=DecisionSource.NAME,
    evidence=(
        RuleEvidence(
            source=InformationSource.NAME, text="nav", rule="planning-word", type=PLANNING
        ),
    ),
    packages={"costmap": (MAPPING,)},
)
UNKNOWN = Classification(
    repo="zzz",
    functions=(FunctionType.EXTENSION,),
    primary=FunctionType.EXTENSION,
    probabilities={FunctionType.EXTENSION: 0.45},
)


def matched(text, package="", piece=InformationSource.NAME, **keys):
    of = {"rule": "mapping-map", "type": MAPPING, "weight": 4.5, "is_vetoed": False}
    return RuleMatch(text=text, package=package, source=piece, **{**of, **keys})


MATCHED = (
    matched("nav", rule="planning-word", type=PLANNING, weight=6.0),
    matched("costmap", "costmap"),
    matched("map", "costmap", InformationSource.MANIFEST),
    matched("costmap", "costmap", InformationSource.MANIFEST),
    matched(
        "mobile base", "costmap", InformationSource.MANIFEST, rule="mobile-drive", is_vetoed=True
    ),
    matched("map\x1b[2J", piece=InformationSource.README),
)
EVIDENCE = """\
nav  1 package, a README
Path Planning, decided by the name, 94 % sure
and Mapping (71 %)
perhaps Support (20 %)

repository nav
  Path Planning  6  planning-word  decided  name “nav”

package costmap
  Mapping
  Mapping  4.5  mapping-map           name “costmap”
  Mapping  4.5  mapping-map           description “map”, “costmap”
  Mapping  4.5  mobile-drive  vetoed  description “mobile base”

README
  Mapping  4.5  mapping-map    README “map\\x1b[2J”
"""


def test_the_evidence_of_a_repository(printed):
    repository = SourceRepository(name="nav", packages=(SourcePackage(name="costmap"),), readme="x")
    assert printed(evidence_text(repository, CLASSIFIED, MATCHED)) == EVIDENCE


def test_that_nothing_tells_is_said(printed):
    text = printed(evidence_text(SourceRepository(name="zzz"), UNKNOWN, ()))
    told = "no rule tells what this is: no name, no description, no code, no README"
    first = "Extension, as most such repositories are, 45 % sure"
    assert text == f"zzz  0 packages\n{told}\n{first}\n"


def test_of_a_repository_that_nothing_decides_no_rule_has_decided(printed):
    weak = replace(CLASSIFIED, decided_by=DecisionSource.NONE)
    text = printed(evidence_text(SourceRepository(name="nav"), weak, MATCHED))
    assert (
        "no rule decides: what matches is too weak, or speaks for several functions alike" in text
    )
    assert "decided" not in text


def test_long_evidence_is_cut(printed):
    words = [matched(f"map {n}", piece=InformationSource.README) for n in range(5)]
    rules = [matched("map", rule=f"r{n}") for n in range(22)]
    text = printed(evidence_text(SourceRepository(name="zzz"), UNKNOWN, [*rules, *words]))
    assert "  and 2 more rules\n" in text
    assert "“map 3”, …\n" in text
    assert "r20" not in text


def test_a_classification_as_json():
    assert classification_to_json(CLASSIFIED) == {
        "repo": "nav",
        "functions": ["Path Planning", "Mapping"],
        "primary": "Path Planning",
        "confidence": 0.937,
        "probabilities": {"Path Planning": 0.937, "Mapping": 0.71, "Support": 0.2},
        "decided_by": "name",
        "evidence": [
            {
                "piece": "name",
                "rule": "planning-word",
                "type": "Path Planning",
                "text": "nav",
                "package": "",
            }
        ],
    }
    assert classification_to_json(UNKNOWN) == {
        "repo": "zzz",
        "functions": ["Extension"],
        "primary": "Extension",
        "confidence": 0.45,
        "probabilities": {"Extension": 0.45},
        "decided_by": "none",
        "evidence": [],
    }


def test_the_tables_at_80_columns(printed):
    text = printed(tables_text(build_tables([CLASSIFIED, CLASSIFIED, UNKNOWN])))
    rows = [row.rstrip() for row in text.splitlines()]
    assert rows[0] == "3 repositories, 2 decided (66.7 %)"
    assert rows[1] == "77.5 % of the first functions are expected to be right"
    assert "                         repos      %     paper      %" in rows
    assert "  Perception                 2   40.0       200   17.6" in rows
    assert "    Mapping                  2   40.0        31    2.7" in rows
    assert "  all                        5  100.0      1135  100.0" in rows
    assert "                         name manifest   code  readme   none  auto %   paper" in rows
    mapping = rows.index(
        "  Mapping                   2        0      0       0      0  100.00   96.77"
    )
    assert (
        rows[mapping + 1] == "                           15       11      0       4      1   96.77"
    )
    assert "  Preprocessing             0        0      0       0      0       -   85.71" in rows
    assert "  Extension                 0        0      0       0      1    0.00   51.60" in rows
    assert "  function nodes            4        0      0       0      0  100.00   88.52" in rows
    assert max(map(len, rows)) <= 80


def test_tables_of_nothing(printed):
    assert printed(tables_text(build_tables([]))).startswith("0 repositories, 0 decided (- %)\n")
