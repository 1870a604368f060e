"""Properties of any input with few examples in the ordinary suite and all in the slow one."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis.strategies import SearchStrategy

ORDINARY_SHARE = 10
"""The ordinary suite has one in so many of the examples."""


def for_any(*strategies: SearchStrategy[Any], examples: int) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make a test of a property: with a tenth of the examples, and slow with all."""

    def decorate(holds: Callable[..., None]) -> Callable[..., None]:
        few = examples // ORDINARY_SHARE

        @pytest.mark.parametrize("examples", [few, pytest.param(examples, marks=pytest.mark.slow)])
        def test(examples: int) -> None:
            settings(max_examples=examples, deadline=None)(given(*strategies)(holds))()

        test.__name__, test.__doc__, test.__module__ = holds.__name__, holds.__doc__, holds.__module__
        return test

    return decorate
