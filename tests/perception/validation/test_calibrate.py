from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit.records import Record, RecordError, Table, load_records
from thermicon.perception import Observer
from thermicon.perception.identification.rate_task import rate_task, with_gain
from thermicon.perception.observer.observer import CHANNELS, DATA, NORMS, load_thresholds
from thermicon.perception.observer.variants import VARIANTS, source_of
from thermicon.perception.sensation.detection import false_alarms
from thermicon.perception.sensation.fits import with_unit_drives
from thermicon.perception.sensation.sensation import amplitude_jnd
from thermicon.perception.validation.calibrate import MODEL_CONSTANTS, calibrate, to_toml

SHIPPED = DATA / "observer.toml"
AGAIN = "the observer is out of date: run python -m thermicon.perception.validation.calibrate"


def test_the_shipped_observer_is_what_calibrate_finds() -> None:
    assert to_toml(calibrate()) == SHIPPED.read_text(encoding="utf-8"), AGAIN


def test_predicted_records_do_not_reach_the_observer() -> None:
    table = load_thresholds()
    rng = np.random.default_rng(0)

    values = [r.central for r in table if r.use == "predict"]
    swapped = iter(rng.permutation(values))
    other = Table(
        table.name,
        tuple(replace(r, value=float(next(swapped)), low=None, high=None) if r.use == "predict" else r for r in table),
    )
    assert other != table
    assert to_toml(calibrate(other)) == SHIPPED.read_text(encoding="utf-8"), AGAIN
    kept = Table(table.name, tuple(r for r in table if r.use != "predict"))
    assert to_toml(calibrate(kept)) == SHIPPED.read_text(encoding="utf-8"), AGAIN


def test_references_reach_only_the_model_that_is_theirs() -> None:
    table = load_thresholds()

    def doubled(record: Record) -> Record:
        own = record.use == "reference" and record.quantity not in MODEL_CONSTANTS
        return replace(record, value=2.0 * record.central, low=None, high=None) if own else record

    other = Table(table.name, tuple(doubled(r) for r in table))
    assert other != table
    assert to_toml(calibrate(other)) == SHIPPED.read_text(encoding="utf-8"), AGAIN


def test_every_number_of_the_observer_says_where_it_is_from() -> None:
    for record in load_records(SHIPPED):
        assert record.use in ("calibrate", "assumed") or record.quantity in MODEL_CONSTANTS
        assert "not calibrated" not in record.source
    for variant in VARIANTS:
        found = load_records(SHIPPED).select(f"memory noise{source_of(*variant)}")
        assert {r.method for r in found} == set(NORMS)


def test_gain_control_makes_the_rate_task_depend_least_on_its_conditions() -> None:
    """Its strength is what the independence of rate and span says, and no limits or icons say anything."""
    table, shipped = load_thresholds(), load_records(SHIPPED)
    record = shipped.one("gain control strength")
    spread = {}
    for strength in (0.0, record.central, record.interval[1], 0.8):
        person = with_unit_drives(table, with_gain(Observer.load(), strength))
        sizes = [case.size["max"] for case in rate_task(table, person)]
        spread[strength] = max(sizes) / min(sizes)
    assert record.interval[0] == 0.0
    assert spread[record.central] < spread[0.0]
    assert spread[record.interval[1]] <= spread[0.0] < spread[0.8]


def test_the_threshold_step_is_felt_as_one_with_gain_control() -> None:
    """Unit drive and gain scale are found together: u = 1 at the peak of the very step."""
    for variant in VARIANTS:
        person = Observer.load(variable=variant[0], model=variant[1])
        again = with_unit_drives(load_thresholds(), person)
        for channel in CHANNELS:
            drive, own = again.receptor(channel).threshold_drive, person.receptor(channel).threshold_drive
            assert drive == pytest.approx(own, rel=2e-4)


def test_what_is_not_pinned_down_says_so() -> None:
    shipped = load_records(SHIPPED)
    strength = shipped.one("gain control strength")
    assert strength.interval[0] < strength.central < strength.interval[1]
    assert "pin down only its upper end" in strength.conditions
    for quantity in ("gain control time constant", "gain control scale"):
        assert shipped.one(quantity).source.startswith("no source")
        assert shipped.one(quantity).use == "assumed"


def test_the_slope_keeps_the_amplitude_thresholds_in_their_bands() -> None:
    table, shipped = load_thresholds(), load_records(SHIPPED).one("slope of sensation")
    for a in (shipped.central, *shipped.interval):
        for channel in CHANNELS:
            threshold = table.one("detection threshold", channel=channel, site="thenar").central
            low, high = table.one("amplitude difference threshold", channel=channel).interval
            for pedestal in np.linspace(1.5, 4.5, 13):
                assert low - 1e-5 <= threshold * amplitude_jnd(float(pedestal), a) <= high + 1e-5


def test_the_criterion_keeps_its_false_alarms() -> None:
    person = Observer.load()
    assert false_alarms(person.criterion, person.noise_correlation_s, 5.0) == pytest.approx(0.02, rel=5e-3)


def test_a_table_without_what_is_needed_is_refused() -> None:
    table = load_thresholds()
    without = Table(table.name, tuple(r for r in table if r.quantity != "rate Weber fraction"))
    with pytest.raises(RecordError, match=r"thresholds.toml: no quantity 'rate Weber fraction'"):
        calibrate(without)
    impossible = Table(
        table.name,
        tuple(replace(r, low=1e-6, high=2e-6) if r.quantity == "amplitude difference threshold" else r for r in table),
    )
    with pytest.raises(RecordError, match=r"no slope of sensation gives the amplitude difference thresholds"):
        calibrate(impossible)


def test_all_published_numbers_load() -> None:
    table = load_thresholds()
    assert {r.channel for r in table} == {"cold", "warm", "both"}
    assert len(table.select("limits threshold")) == 12
    assert all(r.use for r in table)


def test_observer_proves_itself() -> None:
    person = Observer.load()
    assert person.path_m("forearm") == 0.55
    assert person.path_m("thenar") == 0.7
    assert repr(person).startswith("Observer(a ")
    with pytest.raises(ValueError, match=r"slope of sensation a = 0 must be above 0"):
        replace(person, a=0.0)
    with pytest.raises(ValueError, match=r"neutral zone 36 to 36 °C is empty"):
        replace(person, neutral_low_C=36.0)
    with pytest.raises(ValueError, match=r"lapse = 1.2 must lie in 0 to 1"):
        replace(person, lapse=1.2)
