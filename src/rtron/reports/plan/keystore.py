"""The report of `rtron secure`: what differs in a keystore, what is changed, what may break."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph

_SHOWN_KEYS = 12
_RESTART = "The router reads its configuration when it starts, and only then: restart it"
_NO_REVOCATION = (
    "Zenoh knows no revocation: whoever has the former key of a process can use it until its "
    "certificate expires. Make a new keystore if it was stolen"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohReport:
    """Zenoh's files beside graph and plan.

    `certificate` is why the router gets another one, `settings` what else differs in its
    configuration. `new` and `gone` are processes; `added` and `removed` are what the others may
    send and get, under which keys.
    """

    certificate: tuple[str, ...]
    files: tuple[str, ...]
    settings: tuple[str, ...]
    new: tuple[str, ...]
    gone: tuple[str, ...]
    added: Mapping[str, tuple[str, ...]]
    removed: Mapping[str, tuple[str, ...]]
    revokes: bool

    @property
    def differs(self) -> bool:
        """Whether the files do not say, or did not say, what graph and plan say."""
        return bool(self.certificate or self.files)


def zenoh_to_json(report: ZenohReport) -> Mapping[str, object]:
    """Return the JSON document of this part."""
    return {
        "certificate": list(report.certificate),
        "files": list(report.files),
        "settings": list(report.settings),
        "new": list(report.new),
        "gone": list(report.gone),
        "added": {name: list(keys) for name, keys in report.added.items()},
        "removed": {name: list(keys) for name, keys in report.removed.items()},
    }


def zenoh_lines(report: ZenohReport, page: TextPage) -> Iterator[Text]:
    """Yield the lines of this part, none if nothing differs."""
    if report.revokes:
        yield from heading("Zenoh")
        yield from paragraph(_NO_REVOCATION, page, indent=2, style="red")
    if not report.differs:
        return
    yield from heading("Zenoh's router")
    for reason in report.certificate:
        yield line(f"its certificate {reason}", indent=2)
    for name in report.settings:
        yield line(f"{name} differs", indent=2)
    for name in report.gone:
        yield line((f"- {name}", "red"), indent=2)
    for name in report.new:
        yield line((f"+ {name}", "green"), indent=2)
    yield from paragraph(_RESTART, page, indent=2)
    for name in sorted({*report.added, *report.removed}):
        yield from heading(f"Zenoh: {name}")
        yield from _keys(report.removed.get(name, ()), "-", "red")
        yield from _keys(report.added.get(name, ()), "+", "green")


def _keys(keys: tuple[str, ...], sign: str, style: str) -> Iterator[Text]:
    """Yield a line for each key: the messages that may, or may no longer, be sent or got there."""
    messages: dict[tuple[str, str], list[str]] = {}
    for each in keys:
        direction, message, key = each.split(" ", 2)
        messages.setdefault((direction, key), []).append(message)
    for direction, key in list(messages)[:_SHOWN_KEYS]:
        yield line((f"{sign} {key}", style), indent=2)
        yield line(f"{direction} {', '.join(messages[direction, key])}", indent=4)
    if len(messages) > _SHOWN_KEYS:
        rest = f"{len(messages) - _SHOWN_KEYS} more; --format json lists all"
        yield line((f"{sign} {rest}", style), indent=2)


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
