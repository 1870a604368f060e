"""The rig and the observer that the options of a command name."""

from __future__ import annotations

import contextlib
import sys
import tomllib
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from .messages import VERBOSE, fail, note, noted, usage

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet
    from thermicon.perception.observer.observer_model import ObserverModel

DEFAULT_RIG = "thenar"


def check_changes(changes: Sequence[str]) -> None:
    """Fail with a usage error unless every ``--set`` has the form KEY=VALUE."""
    for change in changes:
        key, equals, value = change.partition("=")
        if not (key.strip() and equals and value.strip()):
            raise usage(f"{change!r} is not of the form KEY=VALUE, for example contact.area_cm2=4", "--set")


def load_rig(name: str | None, changes: Sequence[str], *, site: str | None = None, named: bool = False) -> Rig:
    """Load the rig of ``--rig``, or the usual one for a site, with the changes of ``--set``, and warn of it.

    `named`: warnings say of which rig they are.
    """
    check_changes(changes)
    from thermicon.circuit import Rig

    rig = Rig.of(name, site)
    if name is None and rig.name == site != DEFAULT_RIG:
        note(f"on the {site} rig, since the set is for that site; --rig names another")
    if changes:
        rig = rig.with_set(list(changes))
    warn_of_rig(rig, named)
    return rig


def warn_of_rig(rig: Rig, named: bool = False) -> None:
    """Warn on stderr of what is unusual about a rig: whole sentences where safety needs them, or who reads wants all.

    On a terminal the rest is one short line, once for a rig in a folder.
    """
    from thermicon.circuit.rig.rig_words import rig_warnings

    whole, brief = VERBOSE.get() or not sys.stderr.isatty(), list[str]()
    for each in rig_warnings(rig):
        if whole or each.brief is None:
            note(f"warning: {f'{rig.name}: ' if named else ''}{each.text}")
        else:
            brief.append(each.brief)
    if brief and _is_new(f"{Path.cwd()}\n{rig.document}"):
        note(f"warning: rig {rig.name}: {'; '.join(brief)} (in full: thermicon -v)")


def _is_new(text: str) -> bool:
    """Whether this was not asked before; an empty file in the cache folder remembers it."""
    from hashlib import sha256

    from thermicon.base.files.cache_folder import cache_folder

    told = cache_folder() / "told" / sha256(text.encode()).hexdigest()[:20]
    if told.exists():
        return False
    with contextlib.suppress(OSError):
        told.parent.mkdir(parents=True, exist_ok=True)
        told.touch()
    return True


def site_warnings(file: str, icons: IconSet | Icon, rig: Rig) -> tuple[str, ...]:
    """Warnings of a set for another site than the rig's."""
    if icons.context.site in (None, rig.site):
        return ()
    site = icons.context.site
    return (f"{file} is for the site {site}, the rig {rig.name} is for {rig.site}{site_meant(site)}",)


def site_meant(site: str | None) -> str:
    """Which site is meant by one that neither a shipped rig nor published data know; empty for a known one."""
    from thermicon.base.words.near_words import proposals

    shipped = (resources.files("thermicon.circuit") / "rigs").iterdir()
    rigs = {tomllib.loads(rig.read_text("utf-8"))["skin"]["site"] for rig in shipped}
    if site is None or site in rigs:
        return ""
    from thermicon.perception.sensation.coverage import load_coverage, nearest_site, outside_site

    if not outside_site(site.replace("-", " ")):
        return ""
    known = sorted({*rigs, *(str(record.site) for record in load_coverage().select("site"))})
    near = proposals(site, known, cutoff=0.75) or list(filter(None, nearest_site(site)[:1]))
    return f"; did you mean site {near[0]}?" if near else f"; known: {', '.join(known)}"


def load_observer(file: Path | None, rig: Rig | None = None, needs_draws: str = "") -> ObserverModel:
    """Load the shipped observer, or that of ``--observer``, of which notes on stderr say what it cannot give.

    Draws of a laboratory that was asked on another than the `rig` are warned of; `needs_draws` says what cannot be done
    without draws, which is then refused.
    """
    from thermicon.perception.observer.observer_model import ObserverModel

    with noted("warning"):
        model = ObserverModel.load(file)
    if model.posterior is None:
        beside, cure = (
            file and file.with_suffix(".csv"),
            "give the table of draws (.csv) that pilot --keep writes beside it",
        )
        if beside and beside.exists():
            cure = f"give {beside}, which stands beside it"
        if needs_draws:
            fail(f"{model.name}: {needs_draws}, which this observer does not have: {cure}")
        note(f"note: {model.name} has no posterior draws, so that there are no intervals for a new laboratory: {cure}")
    elif (
        rig is not None
        and (held := model.posterior.header.rig)
        and held != (now := ", ".join((rig.name, *rig.changes)))
    ):
        note(f"warning: {model.name} was conditioned on the {held} rig, not on {now}: its answers say less of this one")
    return model


def check_draws(model: ObserverModel, asked: int | None, option: str, usual: int, least: int = 2) -> int:
    """The number of draws to use: what was asked for, or the usual number, or as many as the observer has.

    Fail where more are asked for than there are, and where there are fewer than `least`.
    """
    if model.posterior is not None and (held := len(model.posterior)) < least:
        fail(f"{model.name} has {held} draws, and {least} are needed: keep more with pilot --draws {2 * least}")
    if asked is None:
        if 0 < (draws := model.most_draws(usual)) < usual:
            note(f"note: {model.name} has {draws} draws: all of them are used ({option} is {usual} by default)")
        return draws
    if model.posterior is not None and asked > len(model.posterior):
        fail(f"{option} {asked}: the {model.name} posterior has {len(model.posterior)} draws: ask for as many or fewer")
    return asked
