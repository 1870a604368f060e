"""Vectorised exponential and logarithm beside those of the standard library."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from thermicon.base.numbers.compiled import kernel
from thermicon.base.numbers.vector_math import HIGHEST_EXP, LOWEST_EXP, exp, expm1, log, log1p

ULPS = 5
Function = Callable[[float], float]
EXPONENTS = st.floats(LOWEST_EXP, HIGHEST_EXP)
NUMBERS = st.floats(1e-300, 1e300)


def near(found: float, expected: float) -> bool:
    return abs(found - expected) <= ULPS * math.ulp(expected)


@given(x=EXPONENTS)
def test_exponential(x: float) -> None:
    assert near(exp(x), math.exp(x))


@given(x=st.one_of(EXPONENTS, st.floats(-1.0, 1.0)))
def test_exponential_less_one(x: float) -> None:
    assert near(expm1(x), math.expm1(x))


@given(x=st.one_of(NUMBERS, st.floats(0.5, 2.0)))
def test_logarithm(x: float) -> None:
    # Near 1 the logarithm is a small difference: its error is a share of the numbers' own precision.
    assert near(log(x), math.log(x)) or abs(log(x) - math.log(x)) < 2 * math.ulp(1.0)


@given(x=st.one_of(NUMBERS, st.floats(0.0, 4.0)))
def test_logarithm_of_one_and_more(x: float) -> None:
    assert near(log1p(x), math.log1p(x))


@pytest.mark.parametrize(
    ("function", "x", "expected"),
    [
        (exp, 0.0, 1.0),
        (expm1, 0.0, 0.0),
        (log, 1.0, 0.0),
        (log1p, 0.0, 0.0),
        (exp, -1e6, math.exp(LOWEST_EXP)),
        (exp, 1e6, math.exp(HIGHEST_EXP)),
    ],
)
def test_exact_values_and_ends(function: Function, x: float, expected: float) -> None:
    assert near(function(x), expected)


def test_a_loop_gives_what_single_calls_give() -> None:
    def fill(x: Any, found: Any) -> None:
        for k in range(x.size):
            found[0, k], found[1, k], found[2, k] = exp(x[k]), log(x[k]), log1p(x[k])

    x: NDArray[np.float64] = np.geomspace(1e-9, 600.0, 1001)
    found = np.empty((3, x.size))
    kernel(error_model="numpy")(fill)(x, found)
    one_by_one = np.array([[function(each) for each in x.tolist()] for function in (exp, log, log1p)])
    assert np.allclose(found, one_by_one, rtol=1e-15, atol=1e-16)
