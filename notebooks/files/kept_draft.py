"""What an unsaved file holds: a plain text, or a text with version A of the comparison that stood beside it."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

HEAD = '{"thermicon_draft"'
"""How a draft with a version begins, as no cue text does; all else is plain text, as drafts without a version are."""


class _Kept(BaseModel):
    """Keys that another release adds are passed over, so that its drafts can still be restored."""

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)


class KeptVersion(_Kept):
    """A version of a set: its text, the icon that was shown, the rig as the text of a rig file, and its knobs."""

    text: str
    rig: str
    icon: str | None = None
    rig_changes: tuple[str, ...] = ()
    values: dict[str, float | str] = {}


class KeptDraft(_Kept):
    """The text of an editor, and the version A that was kept beside it; None without one."""

    thermicon_draft: Literal[1] = 1
    text: str
    version_a: KeptVersion | None = None


def draft_text(text: str, version: KeptVersion | None) -> str:
    """Write a draft: the text as it is, or both as JSON.

    >>> draft_text("cue 1", None)
    'cue 1'
    >>> read_draft(draft_text("cue 1", KeptVersion(text="cue 1 # A", rig="name = 'x'"))).version_a.text
    'cue 1 # A'
    """
    if version is None:
        return text
    return KeptDraft(text=text, version_a=version).model_dump_json()


def read_draft(kept: str) -> KeptDraft:
    """Read a draft; what is none of this form is plain text.

    >>> read_draft("cue 1").text
    'cue 1'
    """
    if kept.startswith(HEAD):
        try:
            return KeptDraft.model_validate_json(kept)
        except ValidationError:
            pass
    return KeptDraft(text=kept)
