"""Verification of an export's files against the digests in its sidecars."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from thermicon.base.numbers.program import own_version, this_program

from ..safety.demands import DEMANDS
from .export_folder import Claims, claims_of, table_of
from .pack import digest, digest_of_content, sealed, sidecar_text

STUDY = "study.json"
RESTORE = "put the file back as it was exported, or export again"


@dataclass(frozen=True, slots=True)
class Remark:
    """A finding about a file: `wrong` where it does not belong to the others, otherwise `told`; with the cure."""

    file: str
    kind: Literal["wrong", "told"]
    text: str
    cure: str = ""

    def __str__(self) -> str:
        return f"{self.file}: {self.text}" + (f"; {self.cure}" if self.cure else "")


@dataclass(frozen=True, slots=True)
class Verification:
    """Claims of each sidecar of a folder, by its name, and all findings; `well` where nothing is wrong."""

    claims: Mapping[str, Claims]
    findings: tuple[Remark, ...]

    @property
    def well(self) -> bool:
        """Whether everything belongs together."""
        return all(finding.kind != "wrong" for finding in self.findings)

    def belongs(self, sidecar: str) -> bool:
        """Whether nothing is wrong with a sidecar, its drive and what that is played with."""
        files = {sidecar, *self.claims[sidecar].digests}
        return all(finding.kind != "wrong" or finding.file not in files for finding in self.findings)


def verify(files: Mapping[str, bytes]) -> Verification:
    """Mismatches among files by name; another version of the program is reported but does not count as wrong."""
    tables = {name: table_of(content) for name, content in sorted(files.items()) if name.endswith(".json")}
    claims = {name: each for name in tables if (each := claims_of(files[name])) is not None}
    bound = {name: each.digests for name, each in claims.items()}
    studied = (tables.get(STUDY) or {}).get("study_files")
    if isinstance(studied, dict):
        bound[STUDY] = {**bound.get(STUDY, {}), **{str(name): str(known) for name, known in studied.items()}}
    findings = [*_changed(files, bound), *_unbound(files, tables, bound)]
    for name, each in claims.items():
        about = tables[name] or {}
        findings += [*_own(name, files[name], about), *_names(name, each, claims), *_program(name, about)]
        findings += _age(name, about)
    if not claims and all(finding.kind != "wrong" for finding in findings):
        findings.append(Remark(".", "wrong", "holds no sidecar", "give a folder that was exported"))
    return Verification(claims, tuple(findings))


def _changed(files: Mapping[str, bytes], bound: Mapping[str, Mapping[str, str]]) -> Iterator[Remark]:
    """Files against the digests in all sidecars that name them, and in the list of a study."""
    for file in dict.fromkeys(file for digests in bound.values() for file in digests):
        here = digest(files[file]) if file in files else None
        against = [name for name, digests in bound.items() if digests.get(file, here) != here]
        by = f"{against[0]} and {len(against) - 1} more" if len(against) > 1 else "".join(against)
        if here is None:
            yield Remark(file, "wrong", f"is missing; it was exported with {by}", RESTORE)
        elif against:
            yield Remark(file, "wrong", f"is not the file that was exported with {by}: its digest differs", RESTORE)


def _unbound(
    files: Mapping[str, bytes], tables: Mapping[str, object], bound: Mapping[str, Mapping[str, str]]
) -> Iterator[Remark]:
    """Files that no digest covers: wrong where they look like a drive or a sidecar, since somebody might play them."""
    from .formats import format_names, load_format

    ends = tuple({load_format(name).suffix.lower() for name in format_names()})
    covered = {*bound, *(file for digests in bound.values() for file in digests)}
    for name in sorted(set(files) - covered):
        if name in tables and tables[name] is None:
            yield Remark(name, "wrong", "is damaged: it cannot be read as JSON, so it describes no drive", RESTORE)
        elif name not in tables and name.lower().endswith(ends):
            text = "has no sidecar that can be read, so its content is unknown"
            yield Remark(name, "wrong", text, "remove it, or export its icon again")
        else:
            yield Remark(name, "told", "does not belong to an export and was not checked")


def _own(name: str, content: bytes, about: Mapping[str, Any]) -> Iterator[Remark]:
    """The sidecar against its own digest, byte for byte, and the rig and device in it against theirs."""
    if sidecar_text(sealed(about)) != content:
        yield Remark(name, "wrong", "was changed after it was exported: its own digest does not match", RESTORE)
    elements = about.get("elements")
    several: list[Mapping[str, Any]] = []
    if isinstance(elements, list):
        several = [each for each in elements if isinstance(each, dict)]
    kept = [("rig", each) for each in several or [about]] + [("layout", about)] * ("layout" in about)
    for what, holder in (*kept, ("device", about)):
        held = holder.get(what)
        if what != "device":
            held = held.get("document") if isinstance(held, dict) else None
        if digest_of_content(held) != holder.get(f"{what}_sha256"):
            text = f"contains another {what} than the one of its digest ({what}_sha256)"
            yield Remark(name, "wrong", text, RESTORE)


def _names(name: str, claims: Claims, others: Mapping[str, Claims]) -> Iterator[Remark]:
    """The sidecar's name against that of its drive, and against other sidecars of the same drive."""
    if not claims.drive.startswith(name.removesuffix("json")):
        text = f"describes {claims.drive}, which does not match this name"
        yield Remark(name, "wrong", text, "rename it back, or export again")
    if twice := [each for each, other in others.items() if other.drive == claims.drive and each != name]:
        yield Remark(name, "wrong", f"describes {claims.drive}, as {twice[0]} does", "remove the one that is a copy")


def _age(name: str, about: Mapping[str, Any]) -> Iterator[Remark]:
    """Sidecars that lack a demand of today: their drives were judged, and their player checks, by fewer rules."""
    demands = about.get("hardware_must_prevent")
    lacks = [demand for demand in DEMANDS if not isinstance(demands, dict) or demand not in demands]
    if lacks:
        text = f"is of an older thermicon, which did not judge everything that is demanded now ({lacks[0]} is missing)"
        yield Remark(name, "wrong", text, "export again")


def _program(name: str, about: Mapping[str, Any]) -> Iterator[Remark]:
    from ..rig.rig import Rig, rig_names

    rig = about.get("rig")
    shipped = rig.get("name") if isinstance(rig, dict) and not rig.get("changes") else None
    if shipped in rig_names() and digest(Rig.load(str(shipped)).document.encode("utf-8")) != about.get("rig_sha256"):
        text = f"was exported for a rig called {shipped} that differs from the rig that is shipped now"
        yield Remark(name, "told", text)
    then, now = about.get("thermicon"), own_version()
    if about.get("program") != this_program() or then != now:
        by = f"thermicon {then}, this is {now}" if then != now else f"other code of version {now}"
        yield Remark(name, "told", f"was exported by {by}; if it is exported again, the drive may differ")
