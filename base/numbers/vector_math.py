"""Exponential and logarithm without branches or calls for vectorised loops.

Cody and Waite's reduction with a Taylor polynomial for the exponential, and the series of the inverse hyperbolic
tangent for the logarithm: both are within 5 units in the last place, which tests compare with the standard library.
"""

# mypy: disable-error-code="no-untyped-call,misc,no-any-return,import-untyped,untyped-decorator"
# numba's decorators have no types.
import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.extending import intrinsic

from .compiled import kernel

ROUNDER = 1.5 * 2.0**52
"""A double of this size ends in its integer part: adding it rounds, and leaves the integer in the lowest bits."""
LOG2_E = 1.0 / math.log(2.0)
LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
"""ln 2 in two parts, the first of which ends in zeros: whole multiples of it are exact."""
LOWEST_EXP, HIGHEST_EXP = -708.0, 709.0
FRACTION_BITS, EXPONENT_BIAS = np.int64(52), np.int64(1023 << 52)
SQRT_HALF_BITS = 0x3FE6A09E667F3BCD
FROM_SQRT_HALF, EXPONENT_ZERO = np.int64((1024 << 52) - SQRT_HALF_BITS), np.int64(1024 << 52)
TWO_52_BITS, TWO_52_AND_1024 = np.uint64(0x4330 << 48), 2.0**52 + 1024.0
SQRT_TWO = math.sqrt(2.0)
LEAST = 1e-300
"""What a loop takes the logarithm of, or divides by, in place of 0."""
E2, E3, E4, E5, E6, E7, E8, E9, E10, E11, E12 = (1.0 / math.factorial(k) for k in range(2, 13))
A1, A2, A3, A4, A5, A6, A7, A8, A9, A10 = (1.0 / (2 * k + 1) for k in range(1, 11))


def _bits_of(context: Any, x: Any) -> Any:
    """The 64 bits of a double as an integer."""
    return types.int64(types.float64), lambda _, builder, __, held: builder.bitcast(held[0], ir.IntType(64))


def _double_of(context: Any, bits: Any) -> Any:
    """The double that has these 64 bits."""
    return types.float64(types.int64), lambda _, builder, __, held: builder.bitcast(held[0], ir.DoubleType())


bits_of: Any = intrinsic(_bits_of)
double_of: Any = intrinsic(_double_of)

# Reassociation would take the rounder away again.
vectorised: Any = kernel(nogil=True, error_model="numpy", fastmath={"contract", "nsz"})


@vectorised
def reduced(x: float) -> tuple[float, float, float]:
    """X = n·ln 2 + r with |r| ≤ ln 2/2: r, (e^r − 1 − r)/r², and n with the rounder; held at e^−708 and e^709."""
    x = min(max(x, LOWEST_EXP), HIGHEST_EXP)
    rounded = x * LOG2_E + ROUNDER
    n = rounded - ROUNDER
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    p = ((((((E12 * r + E11) * r + E10) * r + E9) * r + E8) * r + E7) * r + E6) * r + E5
    return r, ((p * r + E4) * r + E3) * r + E2, rounded


@vectorised
def exp(x: float) -> float:
    """e^x = 2^n · e^r."""
    r, p, rounded = reduced(x)
    p = (p * r + 1.0) * r + 1.0
    return double_of(bits_of(p) + (bits_of(rounded) << FRACTION_BITS))


@vectorised
def expm1(x: float) -> float:
    """e^x − 1 = 2^n · (e^r − 1) + (2^n − 1), accurate near 0."""
    r, p, rounded = reduced(x)
    whole = double_of((bits_of(rounded) << FRACTION_BITS) + EXPONENT_BIAS)
    return (p * r * r + r) * whole + (whole - 1.0)


@vectorised
def log_of(above: float, n: float) -> float:
    """Logarithm of (1 + above) · 2^n = 2·artanh(s) + n·ln 2 with s = above/(2 + above), |s| < 0.172."""
    s = above / (2.0 + above)
    z = s * s
    p = ((((((A10 * z + A9) * z + A8) * z + A7) * z + A6) * z + A5) * z + A4) * z + A3
    p = (p * z + A2) * z + A1
    return (2.0 * s + 2.0 * s * z * p) + n * LN2_LOW + n * LN2_HIGH


@vectorised
def log(x: float) -> float:
    """Logarithm of a normal positive double."""
    bits = bits_of(x)
    n = np.uint64(bits + FROM_SQRT_HALF) >> np.uint64(FRACTION_BITS)  # 1024 too large; x = m·2^n with m from √½ to √2
    above = double_of(bits - np.int64(n << np.uint64(FRACTION_BITS)) + EXPONENT_ZERO) - 1.0
    return log_of(above, double_of(np.int64(n | TWO_52_BITS)) - TWO_52_AND_1024)


@vectorised
def log1p(x: float) -> float:
    """Logarithm of 1 + x, of a number that is not negative, accurate near 0."""
    bits = bits_of(1.0 + x)
    n = np.uint64(bits + FROM_SQRT_HALF) >> np.uint64(FRACTION_BITS)
    above = double_of(bits - np.int64(n << np.uint64(FRACTION_BITS)) + EXPONENT_ZERO) - 1.0
    above = x if 1.0 + x < SQRT_TWO else above
    return log_of(above, double_of(np.int64(n | TWO_52_BITS)) - TWO_52_AND_1024)
