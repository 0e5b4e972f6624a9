"""Numbers as ``repr`` writes them, by compiled code: the fewest digits that read back the same.

Of the decimals with the fewest digits inside a number's rounding interval it is the closest one.

Source: R. Giulietti, The Schubfach way to render doubles (2021).
"""

from __future__ import annotations

import numpy as np
from numba import njit, uint64

__all__ = ["WIDEST", "write_float", "write_whole"]

#: characters of the longest number: sign, 17 digits, point, ``e-308``
WIDEST = 24
#: powers of ten that a double may need
_SMALLEST, _LARGEST = -292, 324
#: ``repr`` writes no exponent where more digits than the first and at most the second are before
#: the point; zeros behind the point count as negative
_POINT_ABOVE, _POINT_TO = -4, 16
_PART = {"error_model": "numpy", "_nrt": False, "no_cpython_wrapper": True,
         "no_cfunc_wrapper": True}  # fmt: skip
_0, _DOT, _MINUS, _PLUS, _E = (ord(c) for c in "0.-+e")
_LOW = np.uint64(0xFFFFFFFF)


def _powers_of_ten() -> np.ndarray:
    """High and low word of 10**k rounded up to 128 bits, (P, 2) uint64, from `_SMALLEST` on."""
    words = []
    for k in range(_SMALLEST, _LARGEST + 1):
        number, divisor = 10 ** max(k, 0), 10 ** max(-k, 0)
        shift = 128 + divisor.bit_length() - number.bit_length()
        value = 0
        while not 0 < value < 1 << 128:
            value = -(-(number << max(shift, 0)) // (divisor << max(-shift, 0)))
            shift -= 1
        words.append((value >> 64, value & (1 << 64) - 1))
    return np.array(words, np.uint64)


_POWERS = _powers_of_ten()


@njit(**_PART)
def _product(a, b):  # pragma: no cover - compiled
    """High and low word of the product of two words."""
    a0, a1, b0, b1 = a & _LOW, a >> uint64(32), b & _LOW, b >> uint64(32)
    low, middle, other = a0 * b0, a1 * b0, a0 * b1
    carry = (low >> uint64(32)) + (middle & _LOW) + (other & _LOW)
    high = a1 * b1 + (middle >> uint64(32)) + (other >> uint64(32)) + (carry >> uint64(32))
    return high, (low & _LOW) | (carry << uint64(32))


@njit(**_PART)
def _scaled(power, factor):  # pragma: no cover - compiled
    """The product over 2**128, rounded to odd: its last bit tells that a rest was left out."""
    rest, _ = _product(_POWERS[power, 1], factor)
    high, low = _product(_POWERS[power, 0], factor)
    low += rest
    if low < rest:
        high += uint64(1)
    return high | uint64(1 if low > uint64(1) else 0)


@njit(**_PART)
def _digits(bits):  # pragma: no cover - compiled
    """Digits as a whole number, and the power of ten behind it, of a positive finite number."""
    fraction, biased = bits & uint64(0xFFFFFFFFFFFFF), np.int64(bits >> uint64(52))
    whole = fraction if biased == 0 else fraction | uint64(1 << 52)
    exponent = max(biased, 1) - 1075
    is_closer_below = fraction == uint64(0) and biased > 1
    odd = whole & uint64(1)
    k = (exponent * 1262611 - (524031 if is_closer_below else 0)) >> 22
    shift = uint64(exponent + ((-k * 1741647) >> 19) + 1)
    power = -k - _SMALLEST
    middle = whole << uint64(2)
    below = _scaled(power, (middle - uint64(1 if is_closer_below else 2)) << shift) + odd
    value = _scaled(power, middle << shift)
    above = _scaled(power, (middle + uint64(2)) << shift) - odd
    s = value >> uint64(2)
    if s >= uint64(10):
        tens = s // uint64(10)
        is_under, is_over = below <= uint64(40) * tens, uint64(40) * tens + uint64(40) <= above
        if is_under != is_over:
            return tens + uint64(1 if is_over else 0), k + 1
    is_under, is_over = below <= uint64(4) * s, uint64(4) * s + uint64(4) <= above
    if is_under == is_over:
        half = uint64(4) * s + uint64(2)
        is_over = value > half or (value == half and s & uint64(1) != uint64(0))
    return s + uint64(1 if is_over else 0), k


@njit(**_PART)
def _write_digits(text, at, digits, count):  # pragma: no cover - compiled
    for place in range(at + count - 1, at - 1, -1):
        text[place] = _0 + np.int64(digits % uint64(10))
        digits //= uint64(10)
    return at + count


@njit(**_PART)
def _count(digits):  # pragma: no cover - compiled
    count, limit = 1, uint64(10)
    while count < 20 and digits >= limit:
        count, limit = count + 1, limit * uint64(10)
    return count


@njit(**_PART)
def _write_name(text, at, first, second, third):  # pragma: no cover - compiled
    text[at], text[at + 1], text[at + 2] = first, second, third
    return at + 3


@njit(**_PART)
def write_whole(text, at, value):  # pragma: no cover - compiled
    """Write a whole number, int64, as ``str`` does; returns where the next character goes."""
    if value < 0:
        text[at] = _MINUS
        at += 1
    digits = uint64(abs(value))
    return _write_digits(text, at, digits, _count(digits))


@njit(**_PART)
def write_float(text, at, value):  # pragma: no cover - compiled
    """Write a number, float64, as ``repr`` does; returns where the next character goes.

    Parameters
    ----------
    text : (bytes,) uint8
        With room for `WIDEST` characters from `at` on.
    at : int
    value : float
    """
    if np.isnan(value):
        return _write_name(text, at, 110, 97, 110)  # nan
    if np.signbit(value):
        text[at] = _MINUS
        at, value = at + 1, -value
    if np.isinf(value):
        return _write_name(text, at, 105, 110, 102)  # inf
    if value == 0.0:
        return _write_name(text, at, _0, _DOT, _0)
    digits, power = _digits(np.float64(value).view(np.uint64))
    while digits % uint64(10) == uint64(0):
        digits, power = digits // uint64(10), power + 1
    count = _count(digits)
    point = count + power  # digits before the point
    if _POINT_ABOVE < point <= _POINT_TO:
        return _write_plain(text, at, digits, count, point)
    return _write_with_exponent(text, at, digits, count, point - 1)


@njit(**_PART)
def _write_plain(text, at, digits, count, point):  # pragma: no cover - compiled
    if point <= 0:
        text[at], text[at + 1] = _0, _DOT
        for k in range(-point):
            text[at + 2 + k] = _0
        return _write_digits(text, at + 2 - point, digits, count)
    if point >= count:
        at = _write_digits(text, at, digits, count)
        for k in range(point - count):
            text[at + k] = _0
        at += point - count
        text[at], text[at + 1] = _DOT, _0
        return at + 2
    _write_digits(text, at + 1, digits, count)
    for k in range(at, at + point):  # the digits before the point move to make room for it
        text[k] = text[k + 1]
    text[at + point] = _DOT
    return at + count + 1


@njit(**_PART)
def _write_with_exponent(text, at, digits, count, exponent):  # pragma: no cover - compiled
    if count == 1:
        at = _write_digits(text, at, digits, 1)
    else:
        _write_digits(text, at + 1, digits, count)
        text[at], text[at + 1] = text[at + 1], _DOT
        at += count + 1
    text[at], text[at + 1] = _E, _MINUS if exponent < 0 else _PLUS
    size = uint64(abs(exponent))
    return _write_digits(text, at + 2, size, max(_count(size), 2))
