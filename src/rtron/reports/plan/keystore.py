"""The report of `rtron secure`: what differs in a keystore, what is changed, what may break."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rich.text import Text

from rtron.reports.plan.zenoh_files import ZenohReport, zenoh_lines, zenoh_to_json
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph

SECURE_SCHEMA = "rtron.secure/1"
_SHOWN_DOUBTS = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class EnclaveReport:
    """One enclave: its nodes, what they may do, why its files change, what comes and goes.

    `rights` are names of ROS, without what every node may do; `added` and `removed` are DDS topics.
    """

    name: str
    nodes: tuple[str, ...]
    rights: tuple[str, ...]
    is_new: bool
    reasons: tuple[str, ...]
    added: tuple[str, ...]
    removed: tuple[str, ...]

    @property
    def is_changed(self) -> bool:
        """Whether something of it differs."""
        return bool(self.is_new or self.reasons or self.added or self.removed)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeystoreReport:
    """A keystore beside graph and plan; `written` says that it was made or changed to fit.

    `doubts` are a node, what it may not do or what is not known of it, and why.
    """

    path: str
    written: bool
    is_new: bool
    governance: tuple[str, ...]
    enclaves: tuple[EnclaveReport, ...]
    revoked: tuple[str, ...]
    unused: tuple[str, ...]
    problems: tuple[str, ...]
    doubts: tuple[tuple[str, str, str], ...]
    zenoh: ZenohReport | None = None

    @property
    def differs(self) -> bool:
        """Whether the keystore does not say, or did not say, what graph and plan say."""
        changed = any(enclave.is_changed for enclave in self.enclaves)
        others = self.governance or self.revoked or self.unused or self.problems
        return bool(changed or others or (self.zenoh and self.zenoh.differs))


def keystore_to_json(report: KeystoreReport) -> Mapping[str, object]:
    """Return the JSON document."""
    return {
        "schema": SECURE_SCHEMA,
        "keystore": report.path,
        "written": report.written,
        "differs": report.differs,
        "governance": list(report.governance),
        "enclaves": [
            {
                "enclave": each.name,
                "nodes": list(each.nodes),
                "rights": list(each.rights),
                "new": each.is_new,
                "reasons": list(each.reasons),
                "added": list(each.added),
                "removed": list(each.removed),
            }
            for each in report.enclaves
        ],
        "revoked": list(report.revoked),
        "unused": list(report.unused),
        "problems": list(report.problems),
        "doubts": [{"node": node, "what": what, "why": why} for node, what, why in report.doubts],
        **({"zenoh": zenoh_to_json(report.zenoh)} if report.zenoh else {}),
    }


def keystore_text(report: KeystoreReport) -> Report:
    """Return a report: what differs by enclave, what is left, what may break."""
    return Report(lambda page: _lines(report, page))


def _lines(report: KeystoreReport, page: TextPage) -> Iterator[Text]:
    yield line((report.path, "bold"), f"  {_verdict(report)}")
    for problem in report.problems:
        yield from paragraph(problem, page, indent=2, style="red")
    if report.governance and not report.is_new:
        yield from heading("Governance")
        for each in report.governance:
            yield from paragraph(each, page, indent=2)
    for enclave in report.enclaves:
        yield from _enclave(enclave, page) if enclave.is_changed else ()
    if report.revoked:
        yield from heading("Revoked")
        yield from paragraph(", ".join(report.revoked), page, indent=2)
    if report.unused:
        yield from heading("Unused")
        yield from paragraph(_unused_text(report.unused), page, indent=2, style="yellow")
    if report.zenoh:
        yield from zenoh_lines(report.zenoh, page)
    if report.doubts:
        yield from _doubts(report.doubts, page)


def _verdict(report: KeystoreReport) -> str:
    changed = sum(enclave.is_changed for enclave in report.enclaves)
    count = f"{counted(len(report.enclaves), 'enclave')}, {changed} "
    return count + ("written" if report.written else "differ" if changed != 1 else "differs")


def _enclave(enclave: EnclaveReport, page: TextPage) -> Iterator[Text]:
    others = [node for node in enclave.nodes if node != enclave.name]
    yield from heading(enclave.name + (f"  ({', '.join(others)})" if others else ""))
    if enclave.is_new:
        yield line(("new", "green"), "" if enclave.rights else "  what every node may do", indent=2)
        for right in enclave.rights:
            yield line((f"+ {right}", "green"), indent=2)
        return
    for reason in enclave.reasons:
        yield from paragraph(reason, page, indent=2)
    for name in enclave.removed:
        yield line((f"- {name}", "red"), indent=2)
    for name in enclave.added:
        yield line((f"+ {name}", "green"), indent=2)


def _unused_text(unused: tuple[str, ...]) -> str:
    names = ", ".join(unused)
    return f"{names}: no node of the app has it, and it is still valid; --revoke takes it back"


def _doubts(doubts: tuple[tuple[str, str, str], ...], page: TextPage) -> Iterator[Text]:
    yield from heading("What may break under Enforce")
    shown = doubts[:_SHOWN_DOUBTS]
    names = columns([(node or "the app", what) for node, what, _ in shown], ("cyan",), indent=2)
    for (_, _, why), name in zip(shown, names, strict=True):
        yield name
        yield from paragraph(why, page, indent=4)
    if len(doubts) > len(shown):
        yield line(f"and {len(doubts) - len(shown)} more; --format json lists all", indent=2)
