"""The gallery of the shipped sets."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from thermicon.circuit import Rig
from thermicon.icons import IconSet, library
from thermicon.notebooks.figures.set_figures import set_figure
from thermicon.perception import Ranking, rank

RIG = "thenar"
PEOPLE = 50
MOST_ICONS, SAMPLED = 12, 6
"""Of more icons than the first number no picture shows the confusions: so many of them stand for all."""
DPI = 110


Write = Callable[[str, bytes], None]


def gallery(kept: Path | None, write: Write) -> str:
    """The shipped sets as Markdown, and their pictures; predictions are kept in a folder, or left out without one."""
    shipped = library()
    return "\n".join("\n".join(_set(entry, shipped[entry.name], kept, write)) for entry in shipped.entries)


def _set(entry: Any, icons: IconSet, kept: Path | None, write: Write) -> Iterator[str]:
    yield f"## {entry.name}\n\n{icons.title}. {entry.icons} icon{'s' * (entry.icons != 1)}; {entry.source}.\n"
    write(f"gallery/{entry.name}.png", png(icons.plot().figure))
    yield f"![Courses of the icons of {entry.name}](gallery/{entry.name}.png)\n"
    if kept is not None and entry.icons > 1 and not icons.spatial:  # of which no one rig tells what people feel
        own = kept / entry.name
        if not (own / "confusions.png").is_file():
            _predict(icons, own)
        said = json.loads((own / "said.json").read_text(encoding="utf-8"))
        write(f"gallery/{entry.name}-confusions.png", (own / "confusions.png").read_bytes())
        yield f"{said['which']}: {said['felt'] * 100:.0f} % felt and named, {said['bits']:.2f} bits, predicted for"
        yield f"{PEOPLE} virtual people on the rig `{RIG}`.\n"
        yield f"![Predicted confusions of {entry.name}](gallery/{entry.name}-confusions.png)\n"
        yield "| icon | means | felt and named | most confused with |\n|---|---|---|---|"
        yield from said["rows"]
        yield ""
    yield f":::{{dropdown}} Cue text of {entry.name}\n:icon: code\n:open:\n"
    text = (files("thermicon.icons") / "library" / f"{entry.name}.cue").read_text(encoding="utf-8")
    yield f"```cue\n{text}```\n:::\n"


def _predict(icons: IconSet, kept: Path) -> None:
    """Rank a set, or some icons of a large one, and keep what the page shows of it."""
    rig, which, members = Rig.load(RIG), "All icons", list(icons)
    if len(members) > MOST_ICONS:
        step = len(members) // SAMPLED  # and one more, so that every parameter varies
        icons = replace(icons, entries=tuple(members[step // 2 :: step + 1][:SAMPLED]))
        which = f"{SAMPLED} of its {len(members)} icons, evenly spaced over the families"
    ranking = rank(icons, rig, people=PEOPLE, parameters=0)
    result = ranking.to_dict()["set"]
    kept.mkdir(parents=True, exist_ok=True)
    said = {"which": which, "felt": result["felt_and_named"], "bits": result["information_bits"]}
    said["rows"] = list(_rows(ranking, icons))
    (kept / "said.json").write_text(json.dumps(said), encoding="utf-8")
    (kept / "confusions.png").write_bytes(png(set_figure(ranking)))


def _rows(ranking: Ranking, icons: IconSet) -> Iterator[str]:
    confusion = ranking.to_dict()["confusion"]
    labels, felt = confusion["labels"], {icon.name: icon.felt_and_named for icon in ranking.icons}
    for name, row in zip(labels, confusion["probability"], strict=True):
        share, other = max((share, label) for label, share in zip(labels, row, strict=True) if label != name)
        meaning = icons[name].metadata.means or ""
        yield f"| `{name}` | {meaning} | {felt[name] * 100:.0f} % | `{other}` {share * 100:.0f}&nbsp;% |"


def png(figure: Figure | Any) -> bytes:
    """A picture for a page, without the name of the program that drew it."""
    file = io.BytesIO()
    figure.savefig(file, dpi=DPI, metadata={"Software": None})
    return file.getvalue()
