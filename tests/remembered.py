"""Verdicts of the safety gate that several tests need: each is computed once in a run, by the test that comes first."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import pytest


def remember_verdicts(patch: pytest.MonkeyPatch, folder: Path) -> None:
    """Keep what exports ask of the gate in a folder, under a hash of all arguments; errors are not kept."""
    from thermicon.circuit.delivery import worstcase

    for name in ("gate_set", "gate_shown", "gate_controlled"):
        patch.setattr(worstcase, name, _remembered(getattr(worstcase, name), folder / name))


def _remembered(judge: Callable[..., Any], folder: Path) -> Callable[..., Any]:
    folder.mkdir(parents=True, exist_ok=True)

    @wraps(judge)
    def remembered(*arguments: Any, **named: Any) -> Any:
        kept = folder / hashlib.sha256(pickle.dumps((arguments, sorted(named.items())))).hexdigest()
        if kept.exists():
            return pickle.loads(kept.read_bytes())
        verdicts = judge(*arguments, **named)
        draft = kept.with_suffix(f".{id(verdicts)}")
        draft.write_bytes(pickle.dumps(verdicts))
        draft.replace(kept)
        return verdicts

    return remembered
