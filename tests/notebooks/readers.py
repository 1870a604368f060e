"""The readers of all kinds of input with sound texts, for tests of line ends or damage."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from thermicon.circuit import Device, Rig, read_drive, simulate_current
from thermicon.circuit.delivery.samples import rate_of
from thermicon.circuit.fitting.log import read_log
from thermicon.circuit.safety.session_plan import read_order
from thermicon.icons import load_library, parse
from thermicon.icons.recordings.recorded import read_readings
from thermicon.notebooks.cli.compare import _shifted
from thermicon.notebooks.files.document import Document
from thermicon.notebooks.files.trace_files import align, read_curves
from thermicon.notebooks.report.run_report import Comparison, compare_report
from thermicon.notebooks.study.study_file import parse_study, study_text
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.pilot.measurements_file import read_measurements
from thermicon.perception.pilot.trials_file import read_trials


@dataclass(frozen=True)
class Kind:
    """Sound texts of a kind of input, how often one is damaged, its file, and what reads it: equal for equal input."""

    texts: list[str]
    weight: int
    file: str
    read: Callable[[Path], object]
    command: str = ""


def shipped(package: str, folder: str, ending: str) -> list[str]:
    entries = sorted((files(f"thermicon.{package}") / folder).iterdir(), key=lambda entry: entry.name)
    return [entry.read_text(encoding="utf-8") for entry in entries if entry.name.endswith(ending)]


def data(package: str, name: str) -> str:
    return (files(f"thermicon.{package}") / "data" / name).read_text(encoding="utf-8")


def read_device(path: Path) -> object:
    device = Device.load(path)
    return device if device.driven_by == "set-points" else (device, device.scale(1.0), rate_of(device, 100.0, 8.0))


def read_compared(path: Path) -> object:
    other = path.with_name("sound.csv")
    other.write_text(LOG)
    first, second = read_curves(str(other)), read_curves(str(path))
    compare_report(Comparison("", align(first, _shifted(first, second)[0])))
    return {name: values.tolist() for name, values in second.columns.items()}


def read_played(path: Path) -> object:
    return simulate_current(read_drive(path), Rig.load("thenar"), rate_Hz=10.0).skin_C.tolist()


CUES = ["cue 1 # a comment\nicon dip { cool by 3 °C at 2 °C/s # another\n  hold for 1 s }\n"]
DRIVES = [
    "time_s,current_A\n0,0.1\n1,0.2\n2.5,-0.3\n",
    "time_s,current_A,code\r\n0,0.1,5\r\n0.01,0.2,6\r\n",
    '"time_s" , "current_A"\n\n0,0\n1e-3,1\n',
]
LOG = "time_s,current_A,voltage_V,display_C,skin_C\n" + "".join(
    f"{k / 10},{0.1 * (k % 7)},{1 + 0.2 * (k % 7)},{32 - 0.1 * k},{32 - 0.05 * k}\n" for k in range(25)
)
LOGS = [LOG, LOG.replace(",", ";"), LOG.replace("\n", "\r")]
TRIALS = ["participant,trial,presented,responded,time_s\n" + "".join(
    f"P{k % 3},{k},{'double-dip' if k % 2 else 'cooling-step'},double-dip,{1 + 0.1 * k}\n" for k in range(12)
)]  # fmt: skip
VALUES = [
    "participant,kind,method,channel,value,unit\nP1,threshold,limits,cold,1.1,K\nP2,threshold,limits,warm,0.9,K\n"
]
ORDERS = ["# 4 plays\ncooling-step\nwarming-step, double-dip\ncooling-step\n"]
DRAWS = ["".join(line for line in data("perception", "posterior.csv").splitlines(True)[:24] if "sha256" not in line)]
KEYS = ["contact.area_cm2", "skin.layer.0.thickness_mm", "skin.layer.dermis.perfusion_per_s", "driver.update_Hz"]
SETTINGS = [
    *(f"{key}=1" for key in KEYS),
    "probe.0.name=x",
    "module.datasheet=[{}]",
    "skin.layer=[]",
    "safety.reason=x",
]
NAMES = ["cooling-step", "double-dip"]
KINDS = {
    "cue": Kind(
        [*CUES, *shipped("icons", "library", ".cue")], 3, "a.cue", lambda path: parse(path.read_bytes(), "a.cue"),
        "check a.cue",
    ),
    "cue in an editor": Kind(CUES, 1, "a.cue", lambda path: parse(Document.open(path).text, "a.cue")),
    "rig": Kind(shipped("circuit", "rigs", ".toml"), 3, "a.toml", Rig.load, "simulate six-icons --rig a.toml"),
    "device": Kind(
        shipped("circuit", "devices", ".toml"), 3, "a.toml", read_device,
        "export six-icons --to csv -o out --device a.toml",
    ),
    "drive": Kind(DRIVES, 2, "a.csv", read_played, "simulate --current a.csv"),
    "settings": Kind(
        SETTINGS, 2, "a.txt", lambda path: Rig.load("thenar").with_set([path.read_bytes().decode("utf-8", "replace")])
    ),
    "log": Kind(
        LOGS, 2, "a.csv", lambda path: [values.tolist() for _, values in read_log(path).columns],
        "fit a.csv --free contact.resistance_m2K_per_W",
    ),
    "trace": Kind(LOGS, 2, "a.csv", read_compared, "compare a.csv b.csv"),
    "recording": Kind(LOGS, 1, "a.csv", lambda path: read_readings(path, "skin_C"), "convert a.csv -o b.cue"),
    "answers": Kind(
        TRIALS, 1, "a.csv", lambda path: read_trials(path, NAMES).counts.tolist(), "pilot six-icons --answers a.csv"
    ),
    "measurements": Kind(VALUES, 1, "a.csv", lambda path: repr(read_measurements(path, Rig.load("thenar")))),
    "order": Kind(
        ORDERS, 1, "a.txt", lambda path: read_order(path, load_library("six-icons")),
        "simulate six-icons --order a.txt",
    ),
    "observer": Kind(
        [data("perception", "observer.toml")], 1, "a.toml", lambda path: ObserverModel.load(path).nominal,
        "rank six-icons --observer a.toml",
    ),
    "draws": Kind(
        DRAWS, 1, "a.csv", lambda path: ObserverModel.load(path).nominal.limit_C, "rank six-icons --observer a.csv"
    ),
    "study": Kind(
        [data("notebooks", "example-study.toml")], 1, "a.toml",
        lambda path: parse_study(study_text(path), "study.toml"), "study a.toml -o out",
    ),
}  # fmt: skip
