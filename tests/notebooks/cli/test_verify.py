"""``export --verify``: every mismatch reported with its file and cure."""

import json
import random
import re
import time
from pathlib import Path
from typing import Any

import pytest

from tests.builders import missing
from tests.circuit.delivery.one_drive import prepare
from tests.circuit.surerig import sure_rig
from tests.notebooks.conftest import Cli
from thermicon.circuit import Device
from thermicon.circuit.delivery.formats import format_names, load_format
from thermicon.circuit.delivery.pack import pack, sealed, sidecar_text
from thermicon.circuit.delivery.verify import verify
from thermicon.icons import load_library

SIX = load_library("six-icons")
W, C = "warming-step", "cooling-step"


def exported(form_name: str, *names: str, device: str | None = None) -> dict[str, bytes]:
    """The files of an export, without a disk."""
    form, rig = load_format(form_name), sure_rig()
    return pack([prepare(SIX[name], rig, Device.load(device or form.device), form) for name in names], form)


@pytest.fixture(scope="module")
def by_format() -> dict[str, dict[str, bytes]]:
    """The same icon in every format."""
    return {name: exported(name, "warming-step") for name in format_names()}


@pytest.fixture(scope="module")
def pair() -> dict[str, bytes]:
    """Two icons for PsychoPy: drives, sidecars and the set's own files."""
    return exported("psychopy", W, C)


@pytest.fixture
def out(pair: dict[str, bytes], tmp_path: Path) -> Path:
    """The two icons on a disk."""
    folder = tmp_path / "out"
    folder.mkdir()
    for name, content in pair.items():
        (folder / name).write_bytes(content)
    return folder


def changed(about: bytes, **keys: Any) -> bytes:
    """A sidecar with other content, and with a digest of its own that is right again."""
    return sidecar_text(sealed({**json.loads(about), **keys}))


def said(files: dict[str, bytes]) -> str:
    found = verify(files)
    assert not found.well
    return "\n".join(str(finding) for finding in found.findings if finding.kind == "wrong")


@pytest.mark.parametrize("name", format_names())
def test_every_format(by_format: dict[str, dict[str, bytes]], name: str) -> None:
    found = verify(by_format[name])
    assert found.findings == ()
    assert [each.replace("_", "-") for each in found.claims] == ["warming-step.json"]


def test_another_program_is_told_and_is_not_wrong(pair: dict[str, bytes]) -> None:
    name = "warming-step.json"
    older = {**pair, name: changed(pair[name], program={"version": "0.0.9", "code_sha256": "0"}, thermicon="0.0.9")}
    found = verify(older)
    assert found.well
    assert "was exported by thermicon 0.0.9, this is " in str(found.findings[0])
    program = {**json.loads(pair[name])["program"], "code_sha256": "0"}
    found = verify({**pair, name: changed(pair[name], program=program)})
    assert found.well
    assert "by other code of version" in str(found.findings[0])


def test_any_byte_of_any_file(by_format: dict[str, dict[str, bytes]], pair: dict[str, bytes]) -> None:
    chance = random.Random(1)
    for files in (*by_format.values(), pair):
        for name, content in files.items():
            places = {0, len(content) // 2, len(content) - 1, *(chance.randrange(len(content)) for _ in range(3))}
            for place in places:
                other = bytearray(content)
                other[place] ^= 1 << chance.randrange(8)
                assert not verify({**files, name: bytes(other)}).well, (name, place)


def test_any_file_missing(pair: dict[str, bytes]) -> None:
    for name in pair:
        files = {other: content for other, content in pair.items() if other != name}
        words = "has no sidecar that can be read" if name.endswith(".json") else f"{name}: is missing"
        assert words in said(files)


MOVED = {
    "W.json=C.json C.json=W.json": "W.json: describes C.csv, which does not match",
    "W.csv=C.csv C.csv=W.csv": "W.csv: is not the file that was exported with W",
    "o.csv=W.csv W.csv=": ["W.csv: is missing; it was exported with W.json", "o.csv: has no sidecar"],
    "o.csv=W.csv W.csv= o.json=W.json W.json=": "o.json: describes W.csv, which does not match this name",
    "W.csv.json=W.json": "describes W.csv, as W.json does; remove the one that is a copy",
}


@pytest.mark.parametrize("moves", MOVED)
def test_files_moved(pair: dict[str, bytes], moves: str) -> None:
    short = {name.replace(W, "W").replace(C, "C"): content for name, content in pair.items()}
    to = dict(move.split("=") for move in moves.split())
    moved = {**short, **{name: short.get(source, b"") for name, source in to.items()}}
    files = {name.replace("W", W).replace("C", C): held for name, held in moved.items() if to.get(name) != ""}
    assert missing(MOVED[moves], said(files).replace(W, "W").replace(C, "C")) == []


def test_a_damaged_sidecar(pair: dict[str, bytes]) -> None:
    cut = pair[W + ".json"][:-40]
    text = said({**pair, W + ".json": cut})
    assert f"{W}.json: is damaged: it cannot be read as JSON" in text
    assert f"{W}.csv: has no sidecar that can be read, so its content is unknown" in text
    alone = said({W + ".json": cut, W + ".csv": pair[W + ".csv"]})
    assert f"{W}.json: is damaged" in alone
    assert "holds no sidecar" not in alone


@pytest.mark.parametrize("known", ["as laid out", None, "0"])
def test_a_sidecar_whose_own_digest_is_wrong(pair: dict[str, bytes], known: str | None) -> None:
    about = {**json.loads(pair[W + ".json"]), "sidecar_sha256": known}
    if known is None:
        del about["sidecar_sha256"]
    content = sidecar_text(about)
    if known == "as laid out":
        content = json.dumps(json.loads(pair[W + ".json"]), ensure_ascii=False).encode()
    (told,) = said({**pair, W + ".json": content}).splitlines()
    assert told.startswith(f"{W}.json: was changed after it was exported: its own digest does not match")


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"rig_sha256": "0"}, r"contains another rig than the one of its digest \(rig_sha256\)"),
        ({"device_sha256": "0"}, "contains another device than the one of its digest"),
        ({"device": {"name": "x"}}, "contains another device than the one of its digest"),
        ({"drive_sha256": None}, f"{W}.csv: is not the file that was exported with {W}.json"),
        ({"rig": {"document": {}}}, "contains another rig"),
    ],
)
def test_a_sidecar_sealed_anew(pair: dict[str, bytes], keys: dict[str, Any], words: str) -> None:
    assert re.search(words, said({**pair, W + ".json": changed(pair[W + ".json"], **keys)}))


@pytest.mark.parametrize(
    "content",
    [
        b"", b"[]", b"{}", b"nan", b"[" * 100_000, b"{" * 100_000, b'{"a": ' + b"9" * 5000 + b"}",
        b'{"thermicon": "\\ud800", "file": "a.csv"}', b'{"thermicon": 1, "file": 2}', b"\xff\xfe",
        b'{"thermicon": [], "file": "a.csv", "rig": [], "device": 3, "icon": [], "played": {"segments": []}}',
        b'{"thermicon": {}, "file": "a.csv", "format": {"name": []}, "rig": {"name": {}, "content_hash": {}}}',
        b'{"thermicon": {}, "file": "a.csv", "set_files": {"../../x": []}, "program": 1, "icon": {"text": 1}}',
        b'{"thermicon": {}, "file": "a.csv", "format": {"name": "wav", "frames_per_update": 0}, "played": '
        b'{"samples": 1e999, "duration_s": NaN, "offset_V": 1, "step_V": 1}}',
    ],
)  # fmt: skip
def test_anything_may_be_in_a_sidecar(content: bytes) -> None:
    start = time.monotonic()
    assert not verify({"a.json": content, "a.csv": b"x"}).well
    assert time.monotonic() - start < 5


@pytest.mark.parametrize("demand", ["held_cut_off_display_C", "current_limit_A", None])
def test_what_an_older_thermicon_exported_is_refused(pair: dict[str, bytes], demand: str | None) -> None:
    """Its script knows no digest of its drives, no predicted display, and no second cut-off."""
    demands = json.loads(pair[W + ".json"])["hardware_must_prevent"]
    fewer = {name: value for name, value in demands.items() if name != demand} if demand else None
    found = verify({**pair, W + ".json": changed(pair[W + ".json"], hardware_must_prevent=fewer)})
    assert not found.belongs(W + ".json")
    assert found.belongs(C + ".json")
    (old,) = (str(finding) for finding in found.findings if finding.kind == "wrong")
    assert re.search(rf"is of an older thermicon, which .*\({demand or 'watchdog_s'} is missing\); export again", old)


def test_all_well(cli: Cli, out: Path) -> None:
    (out / "README.txt").write_text("mine")
    done = cli.good("export", "--verify", out)
    assert "warming-step.csv   warming-step.json" in done.stdout
    assert f"{out}: 2 drives and their sidecars belong together" in " ".join(done.stdout.split())
    assert done.stderr == "note: README.txt: does not belong to an export and was not checked\n"


@pytest.mark.parametrize(("name", "belong"), [(W + ".csv", ["yes", "NO"]), ("play_icons.py", ["NO", "NO"])])
def test_what_is_wrong_is_named_with_the_cure(cli: Cli, out: Path, name: str, belong: list[str]) -> None:
    with (out / name).open("a") as file:
        file.write("# mine")
    done = cli("export", "--verify", out)
    assert done.exit_code == 1
    assert [line.split()[-1] for line in done.stdout.splitlines() if "-step.csv" in line] == belong
    assert done.stderr.count("wrong: ") == 1
    for words in (f"wrong: {name}: is not the file that was exported", "its digest differs", "export again\n"):
        assert words in done.stderr
    assert done.stderr.endswith("1 thing does not belong together\n")


def test_nothing_of_a_file_reaches_the_terminal_raw(cli: Cli, out: Path) -> None:
    (out / "a.json").write_text('{"thermicon": "\\u001b[2J", "file": "a\\u0007\\u001b[1A.csv"}')
    done = cli("export", "--verify", out)
    assert done.exit_code == 1
    assert not {"\x07", "\x1b"} & set(done.stdout + done.stderr)


def test_a_folder_without_sidecars_is_named(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    assert (
        f"wrong: {tmp_path}: holds no sidecar; give a folder that was exported"
        in cli("export", "--verify", tmp_path).stderr
    )
