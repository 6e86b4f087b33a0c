"""Tell what is news in a scan, by `rtron.toml`, comments in the code, and an earlier scan."""

from pathlib import Path

from rtron.findings import FINDING_RULES
from rtron.findings.triage import triage
from rtron.risks import RULES
from rtron.sources.ignores.baseline_file import read_baseline
from rtron.sources.ignores.comments import comment_ignores
from rtron.sources.ignores.config_file import CONFIG_NAME, read_config
from rtron.vocabulary import Ignore, Triage
from rtron.workflows.scan import ScanResult


def triage_scan(
    result: ScanResult,
    root: Path | None = None,
    config: Path | None = None,
    baseline: Path | None = None,
) -> Triage:
    """Return what is news in a scan of an app below `root`.

    `config` is by default the `rtron.toml` of the working folder, if there is one: never a file of
    the app, which could silence what is found in it. Raise InputError if a file is wrong.
    """
    earlier = read_baseline(baseline) if baseline else None
    ignores = (*_config_ignores(config), *_comment_ignores(result, root))
    return triage(result.graph, result.findings, result.report.risks, ignores, earlier)


def _config_ignores(config: Path | None) -> tuple[Ignore, ...]:
    path = config or Path(CONFIG_NAME)
    if config is None and not path.is_file():
        return ()
    rules = [*(rule.name for rule in FINDING_RULES), *(rule.name for rule in RULES)]
    return read_config(path, rules)


def _comment_ignores(result: ScanResult, root: Path | None) -> tuple[Ignore, ...]:
    if root is None:
        return ()
    evidence = (each for finding in result.findings for each in finding.evidence if each.file)
    return tuple(comment_ignores(evidence, root))
