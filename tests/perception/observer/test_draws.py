"""Posterior draws as consistent observers and every error of a file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from thermicon.base.files.records import RecordError
from thermicon.perception import Observer
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.results import inputs_digest
from thermicon.perception.observer.constants import BETWEEN_LABORATORIES
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.draws_file import current_inputs, read_draws, shipped_file, to_text
from thermicon.perception.observer.observer import variant_records
from thermicon.perception.observer.observer_model import ObserverModel


@pytest.fixture(scope="module")
def posterior() -> PosteriorDraws:
    return PosteriorDraws.load()


@pytest.fixture
def text() -> str:
    lines = shipped_file("temperature").read_text(encoding="utf-8").splitlines()
    lines = [line for line in lines if "sha256" not in line]
    head = sum(line.startswith("#") for line in lines)
    return "\n".join(lines[: head + 4]) + "\n"


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.csv"
    path.write_text(text, encoding="utf-8")
    return path


def refused(tmp_path: Path, text: str, match: str) -> None:
    with pytest.raises(RecordError, match=match):
        PosteriorDraws.load(written(tmp_path, text))


def test_the_shipped_draws_belong_to_the_shipped_inputs(posterior: PosteriorDraws) -> None:
    assert posterior.header.inputs == inputs_digest() == current_inputs()
    assert posterior.names == Posterior().priors.names
    assert len(posterior) == 1000


def test_a_draw_is_one_consistent_observer(posterior: PosteriorDraws) -> None:
    observer, values = posterior.observer(17), posterior.draw(17)
    assert observer.threshold_drive.cold == values["cold threshold drive"]
    assert observer.velocity_m_per_s.warm == values["warm conduction velocity"]
    assert observer.criterion == values["criterion of speeded answers"]
    assert observer.timing_noise == Observer.load().timing_noise
    table = posterior.table(17)
    assert table.one("sensitivity between people", channel="cold").central == values["cold sensitivity between people"]
    assert {r.quantity for r in table} == {r.quantity for r in variant_records()}


def test_draws_of_which_one_has_no_spread_between_laboratories_are_not_of_one(posterior: PosteriorDraws) -> None:
    some = posterior.draws.copy()
    some[0, posterior.names.index(BETWEEN_LABORATORIES)] = 0.0
    assert not replace(posterior, draws=some).one_laboratory


def test_the_nominal_draw_lies_in_the_middle(posterior: PosteriorDraws) -> None:
    nominal = posterior.draw(0)
    for name in ("cold threshold drive", "criterion between people", "cold rating exponent"):
        low, _, high = posterior.interval(name, 0.98)
        assert low < nominal[name] < high


def test_a_new_laboratory_differs_by_the_inferred_spread(posterior: PosteriorDraws) -> None:
    offsets = posterior.new_laboratory(3)
    assert offsets.shape == (len(posterior), 2)
    standard = offsets / posterior.values("sensitivity between laboratories")[:, None]
    assert standard.std() == pytest.approx(1.0, abs=0.07)
    np.testing.assert_array_equal(offsets, posterior.new_laboratory(3))


def test_a_file_comes_back_as_it_was_written(posterior: PosteriorDraws, tmp_path: Path) -> None:
    path = written(tmp_path, to_text(posterior.header, posterior.names, posterior.draws[:5]))
    header, names, draws, memory_names, memory = read_draws(path)
    assert (header, names) == (posterior.header, posterior.names)
    assert (memory_names, memory.shape, posterior.memory.shape) == ((), (5, 0), (len(posterior), 0))
    np.testing.assert_allclose(draws, posterior.draws[:5], rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("thenar cold", "1e308", "line {}, thenar cold: '1e308' is not a finite number of at most 1e\\+09"),
        ("cold conduction velocity", "x", "line {}, cold conduction velocity: 'x' is not a finite number"),
        ("cold conduction velocity", "1,2", "line {}: 56 numbers for 55 constants"),
        ("slow adaptation time", "0", "slow adaptation time: 0 must be above 0"),
        ("noise correlation time", "-1", "noise correlation time: -1 must be above 0"),
        ("correlation of cold and warm", "1.2", "correlation of cold and warm: 1.2 must lie in -1 to 1"),
    ],
)
def test_a_number_that_no_person_has_is_refused_in_every_draw(
    tmp_path: Path, text: str, name: str, value: str, words: str
) -> None:
    lines = text.splitlines()
    cells = lines[-1].split(",")
    cells[lines[-4].split(",").index(name)] = value
    refused(tmp_path, "\n".join([*lines[:-1], ",".join(cells)]), words.format(len(lines)))


@pytest.mark.parametrize(
    ("was", "now", "words"),
    [
        ("# form: 1", "# form: 9", r"line 2: form 9 .*reads.* 1"),
        (current_inputs(), "0123456789abcdef", r"made from evidence and priors 0123"),
        ("# sampler:", "# simpler:", r"the header has no line 'sampler'"),
        ("cold limit,", "cold limt,", r"'cold limt' is not a constant.*cold limit"),
        ("cold limit,", "warm limit,", r"two columns have one name"),
    ],
)
def test_a_table_of_another_kind_is_refused(tmp_path: Path, text: str, was: str, now: str, words: str) -> None:
    refused(tmp_path, text.replace(was, now, 1), words)


def test_what_is_no_table_of_draws_is_refused(tmp_path: Path, text: str) -> None:
    refused(tmp_path, "\n".join(text.splitlines()[:-3]) + "\n", r"the table has no draws")
    refused(tmp_path, "a,b\n1,2\n", r"mine.csv, line 1: this is not a table of posterior draws.*evidence sample")
    for path, words in ((tmp_path / "absent.csv", "absent.csv: no such table"), ("/dev/null", "a device, not a file")):
        with pytest.raises(RecordError, match=words):
            PosteriorDraws.load(path)
    with pytest.raises(ValueError, match=r"no constant 'cold limt'.*cold limit"):
        PosteriorDraws.load().values("cold limt")


def test_draws_of_another_variant_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, shipped_file("heat flow").read_text(encoding="utf-8"))
    with pytest.raises(RecordError, match=r"mine.csv: draws of heat flow, not of temperature, the default"):
        ObserverModel.load(path)


def test_draws_that_did_not_converge_warn(posterior: PosteriorDraws, tmp_path: Path) -> None:
    header = replace(posterior.header, converged=False)
    path = written(tmp_path, to_text(header, posterior.names, posterior.draws[:5]))
    with pytest.warns(UserWarning, match=r"mine.csv: NOT CONVERGED, .* not to be trusted"):
        PosteriorDraws.load(path)


def test_a_table_that_was_changed_after_it_was_written_is_refused(posterior: PosteriorDraws, tmp_path: Path) -> None:
    lines = to_text(posterior.header, posterior.names, posterior.draws[:5]).splitlines()
    lines[-1] = lines[-1].replace(lines[-1].split(",")[3], "0.123", 1)
    refused(tmp_path, "\n".join(lines), r"mine\.csv: the draws have sha256 .*: the table was changed after it was")
    unsigned = "\n".join(line for line in lines if "sha256 of the table" not in line)
    assert len(PosteriorDraws.load(written(tmp_path, unsigned))) == 5
