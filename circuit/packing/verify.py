"""Whether the files of an export belong together: sidecars, drives, set files, rig, device, icon and program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from ..program import code_digest, own_version
from .claims import Claims, claims_of, table_of
from .digests import digest, digest_of_content
from .readback import Figures, StatedFigures, differences, read_back
from .sidecar import sealed, sidecar_text

AGAIN = "export the icon again"
STUDY, REMADE = "study.json", "put the file back as it was made, or make the study again"
RESTORE = "put the file back as it was exported, or export the icon again"


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding about a file: `wrong` where it does not belong to the others, otherwise `told`; with the cure."""

    file: str
    kind: Literal["wrong", "told"]
    text: str
    cure: str = ""

    def __str__(self) -> str:
        return f"{self.file}: {self.text}" + (f"; {self.cure}" if self.cure else "")


@dataclass(frozen=True, slots=True)
class Pair:
    """A sidecar with the drive that it names, and what was read back from that drive, if its format is read.

    `shared`: the files of the set, such as a player, that the sidecar names as well.
    """

    sidecar: str
    drive: str
    icon: str
    figures: Figures | None
    unit: str
    shared: tuple[str, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """Everything that the drive is played with."""
        return (self.drive, self.sidecar, *self.shared)


@dataclass(frozen=True, slots=True)
class Verification:
    """The pairs of a folder and all findings; `well` where nothing is wrong."""

    pairs: tuple[Pair, ...]
    findings: tuple[Finding, ...]

    @property
    def well(self) -> bool:
        """Whether everything belongs together."""
        return all(finding.kind != "wrong" for finding in self.findings)

    def wrong(self, *names: str) -> bool:
        """Whether something is wrong with one of these files."""
        return any(finding.kind == "wrong" and finding.file in names for finding in self.findings)


def verify(files: Mapping[str, bytes]) -> Verification:
    """Return what does and does not belong together among the files of a folder, by their names.

    Another version or code of the program is reported but is not wrong, since its drives stay valid.

    >>> verify({"a.csv": b"1"}).well
    False
    """
    claims = {name: each for name, content in files.items() if (each := _claims(name, content)) is not None}
    if not claims:
        damaged = tuple(_damaged(name) for name, content in sorted(files.items()) if _is_damaged(name, content))
        none = Finding(".", "wrong", "holds no sidecar", "give a folder that was exported")
        return Verification((), damaged or (none,))
    pairs, findings = [], list(_shared(files, claims))
    for name, each in sorted(claims.items()):
        about = table_of(files[name]) or {}
        findings += [*_own(name, files[name], about), *_names(name, each, claims), *_parts(name, about)]
        findings += _bound(name, each, files)
        actual, unit, problems = _figures(each.drive, files, about)
        findings += problems
        icon = about.get("icon")
        shared = tuple(file for file in each.digests if file != each.drive)
        title = str(icon.get("name", "")) if isinstance(icon, dict) else ""
        pairs.append(Pair(name, each.drive, title, actual, unit, shared))
    findings += _extra(files, claims)
    return Verification(tuple(pairs), tuple(dict.fromkeys(findings)))


def _claims(name: str, content: bytes) -> Claims | None:
    return claims_of(content) if name.endswith(".json") else None


def _own(name: str, content: bytes, about: Mapping[str, Any]) -> Iterator[Finding]:
    """The sidecar against its own digest, byte for byte."""
    if "sidecar_sha256" not in about:
        yield Finding(name, "wrong", "contains no digest of itself (sidecar_sha256)", AGAIN)
    elif sealed(about)["sidecar_sha256"] != about["sidecar_sha256"]:
        yield Finding(name, "wrong", "was changed after it was exported: its own digest does not match", RESTORE)
    elif sidecar_text(about) != content:
        yield Finding(name, "wrong", "has the same content, but not the layout in which it was exported", RESTORE)


def _names(name: str, claims: Claims, others: Mapping[str, Claims]) -> Iterator[Finding]:
    """The sidecar's name against that of its drive, and against other sidecars of the same drive."""
    if not claims.drive.startswith(name.removesuffix("json")):
        yield Finding(
            name,
            "wrong",
            f"describes {claims.drive}, which does not match this name",
            "rename it back, or export again",
        )
    if twice := sorted(each for each, other in others.items() if other.drive == claims.drive and each != name):
        yield Finding(name, "wrong", f"describes {claims.drive}, as {twice[0]} does", "remove the one that is a copy")


def _bound(name: str, claims: Claims, files: Mapping[str, bytes]) -> Iterator[Finding]:
    """The drive against the digest that its sidecar holds, and whether it holds one of each file of its set."""
    for file, known in claims.digests.items():
        if not known:
            yield Finding(name, "wrong", f"contains no digest of {file}", AGAIN)
        elif file != claims.drive:
            continue
        elif file not in files:
            yield Finding(file, "wrong", f"is missing; {name} belongs to it", RESTORE)
        elif digest(files[file]) != known:
            yield Finding(file, "wrong", f"is not the drive that {name} was written for: its digest differs", RESTORE)


def _shared(files: Mapping[str, bytes], claims: Mapping[str, Claims]) -> Iterator[Finding]:
    """Files of a set, such as its player, against the digests in the sidecars of all its drives."""
    named: dict[str, dict[str, str]] = {}
    for name, each in sorted(claims.items()):
        for file, known in each.digests.items():
            if known and file != each.drive:
                named.setdefault(file, {})[name] = known
    for file, known_by in named.items():
        here = digest(files[file]) if file in files else None
        against = [name for name, known in known_by.items() if known != here]
        if not against:
            continue
        several = len(against) == len(known_by) > 1
        each_name = [f"all {len(against)} sidecars of the folder"] if several else against
        for name in each_name:
            if here is None:
                yield Finding(file, "wrong", f"is missing; {name} belong{'' if several else 's'} to it", RESTORE)
            else:
                text = f"is not the set's file that {name} {'were' if several else 'was'} written for"
                yield Finding(file, "wrong", f"{text}: its digest differs", RESTORE)


def _parts(name: str, about: Mapping[str, Any]) -> Iterator[Finding]:
    """Rig, device, icon and program as the sidecar holds them, against their digests and against this program."""
    rig, device = about.get("rig"), about.get("device")
    document = rig.get("document") if isinstance(rig, dict) else None
    known = about.get("rig_sha256")
    if not isinstance(rig, dict) or not digest_of_content(document) == rig.get("content_hash") == known:
        yield Finding(name, "wrong", "contains another rig than the one of its digest (rig_sha256)", RESTORE)
    elif text := _other_shipped(rig, str(known)):
        yield Finding(name, "told", text)
    if digest_of_content(device) != about.get("device_sha256"):
        yield Finding(name, "wrong", "contains another device than the one of its digest (device_sha256)", RESTORE)
    yield from _icon(name, about.get("icon"))
    program = about.get("program")
    program = program if isinstance(program, dict) else {}
    if program.get("version") != own_version() or about.get("thermicon") != program.get("version"):
        other = f"thermicon {about.get('thermicon')}, this is {own_version()}"
        yield Finding(name, "told", f"was exported by {other}; if it is exported again, the drive may differ")
    elif program.get("code_sha256") != code_digest():
        yield Finding(
            name,
            "told",
            f"was exported by other code of version {own_version()}; if it is exported again, the drive may differ",
        )


def _other_shipped(rig: Mapping[str, Any], known: str) -> str:
    """A note where the shipped rig of this name has changed since."""
    from ..rig.rig import Rig, rig_names

    name = rig.get("name")
    if name not in rig_names() or rig.get("changes"):
        return ""
    now = digest(Rig.load(str(name)).document.encode("utf-8"))
    return "" if now == known else f"was exported for a rig called {name} that differs from the rig that is shipped now"


def _icon(name: str, icon: object) -> Iterator[Finding]:
    """The icon's text, parsed again, against its content hash."""
    from thermicon.icons import parse

    if not isinstance(icon, dict):
        yield Finding(name, "wrong", "holds no icon", RESTORE)
        return
    try:
        icon_now = parse(str(icon.get("text"))).find(str(icon.get("name")))
    except ValueError:
        yield Finding(name, "told", "contains an icon that this version cannot read")
        return
    if icon_now is None or icon_now.content_hash != icon.get("content_hash"):
        yield Finding(name, "wrong", "contains another icon than the one of its content_hash", RESTORE)


def _figures(
    drive: str, files: Mapping[str, bytes], about: Mapping[str, Any]
) -> tuple[Figures | None, str, tuple[Finding, ...]]:
    """What is read back from a drive, and where it differs from what its sidecar says."""
    if drive not in files:
        return None, "", ()
    try:
        stated = StatedFigures.of(about)
    except (LookupError, TypeError, ArithmeticError, ValueError, StopIteration, AttributeError):
        return None, "", (Finding(drive, "told", "is not compared in length and extremes: its sidecar has no figures"),)
    try:
        actual = read_back(files[drive], about)
    except ValueError as problem:
        return None, stated.unit, (Finding(drive, "wrong", f"cannot be read as its format ({problem})", RESTORE),)
    apart = () if actual is None else differences(actual, stated)
    return (
        actual,
        stated.unit,
        tuple(Finding(drive, "wrong", f"{text}, as its sidecar says", RESTORE) for text in apart),
    )


def _extra(files: Mapping[str, bytes], claims: Mapping[str, Claims]) -> Iterator[Finding]:
    """Files that no sidecar names: wrong where they look like a drive or a sidecar, since somebody might play them."""
    studied = studied_files(files)
    yield from _changed_of_study(studied, files)
    known = {*claims, *studied, *(name for each in claims.values() for name in each.digests)}
    ends = _suffixes()
    for name in sorted(set(files) - known):
        if _is_damaged(name, files[name]):
            yield _damaged(name)
        elif name.endswith(".json"):
            yield Finding(name, "told", "is not a sidecar and was not checked")
        elif name.lower().endswith(ends):
            sidecar = f"{name.partition('.')[0]}.json"
            why = "has no sidecar"
            if sidecar in files and _is_damaged(sidecar, files[sidecar]):
                why = f"has a damaged sidecar, {sidecar}"
            yield Finding(name, "wrong", f"{why}, so its content is unknown", "remove it, or export its icon again")
        else:
            yield Finding(name, "told", "does not belong to an export and was not checked")


def studied_files(files: Mapping[str, bytes]) -> dict[str, str]:
    """Digests of the files of a study by name, from its `study.json`, which names itself with none; empty without one.

    >>> studied_files({"study.json": b'{"study_files": {"a.csv": "77"}}'})
    {'a.csv': '77', 'study.json': ''}
    """
    stated = (table_of(files.get(STUDY, b"")) or {}).get("study_files")
    return {**{str(name): str(known) for name, known in stated.items()}, STUDY: ""} if isinstance(stated, dict) else {}


def _changed_of_study(studied: Mapping[str, str], files: Mapping[str, bytes]) -> Iterator[Finding]:
    """Files of a study that are missing or not as they were made."""
    for name, known in sorted(studied.items()):
        if name not in files:
            yield Finding(name, "wrong", f"is missing; {STUDY} names it", REMADE)
        elif known and digest(files[name]) != known:
            yield Finding(name, "wrong", "has changed since the study was made", REMADE)


def _is_damaged(name: str, content: bytes) -> bool:
    return name.endswith(".json") and table_of(content) is None


def _damaged(name: str) -> Finding:
    return Finding(name, "wrong", "is damaged: it cannot be read as JSON, so it describes no drive", RESTORE)


def _suffixes() -> tuple[str, ...]:
    from ..delivery.formats import format_names, load_format

    return tuple({load_format(name).suffix.lower() for name in format_names()})
