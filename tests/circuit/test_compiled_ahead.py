"""Machine code that comes with the package: only where this processor can run it, and never damaged."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import llvmlite
import numba
import pytest

from thermicon.circuit import compiled_ahead
from thermicon.circuit.compiled_ahead import LEVEL, NEEDS, as_brought, brought, read_brought
from thermicon.icons.userfolder import compiled_folder, sealed


@pytest.fixture
def package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Path]:
    """A package that brings code for these versions, on a processor that can run it; returns the folder of the code."""
    monkeypatch.setattr(compiled_ahead, "__file__", str(tmp_path / "compiled_ahead.py"))
    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_features", lambda: dict.fromkeys(NEEDS, True))
    monkeypatch.setattr(numba.config, "CPU_NAME", None)
    monkeypatch.setattr(numba.config, "CPU_FEATURES", None)
    folder = tmp_path / "ahead" / compiled_folder(numba.__version__, llvmlite.__version__).name
    folder.mkdir(parents=True)
    brought.cache_clear()
    yield folder
    brought.cache_clear()


def test_a_processor_that_can_run_it_takes_it(package: Path) -> None:
    assert brought() == package


@pytest.mark.parametrize("missing", NEEDS)
def test_an_older_processor_does_not(package: Path, monkeypatch: pytest.MonkeyPatch, missing: str) -> None:
    less = {need: need != missing for need in NEEDS}
    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_features", lambda: less)
    assert brought() is None


def test_one_that_llvm_does_not_know_does_not(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown() -> None:
        raise RuntimeError("unknown processor")

    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_features", unknown)
    assert brought() is None


@pytest.mark.parametrize(
    ("name", "features", "taken"), [(LEVEL, "", True), ("generic", None, False), (None, "+avx", False)]
)
def test_who_compiles_for_another_processor_is_obeyed(
    package: Path, monkeypatch: pytest.MonkeyPatch, name: str | None, features: str | None, taken: bool
) -> None:
    monkeypatch.setattr(numba.config, "CPU_NAME", name)
    monkeypatch.setattr(numba.config, "CPU_FEATURES", features)
    assert (brought() == package) is taken


def test_other_versions_do_not(package: Path) -> None:
    package.rename(package.with_name("numba-0.1-llvmlite-0.1-cpython-311-x86_64"))
    assert brought() is None


def test_a_checkout_brings_none() -> None:
    brought.cache_clear()
    assert brought() is None


def test_the_key_names_the_level_in_place_of_the_processor() -> None:
    key = ("signature", ("x86_64-unknown-linux-gnu", "znver4", "+avx2,+avx512f"), ("code", "cells"))
    assert as_brought(key) == ("signature", ("x86_64-unknown-linux-gnu", LEVEL, ""), ("code", "cells"))


def test_what_is_damaged_or_absent_is_not_read(tmp_path: Path) -> None:
    file = tmp_path / "code"
    assert read_brought(file) is None
    file.write_bytes(sealed(b"machine code"))
    assert read_brought(file) == b"machine code"
    file.write_bytes(sealed(b"machine code")[:-1])
    assert read_brought(file) is None
