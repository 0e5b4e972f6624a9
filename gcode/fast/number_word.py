"""A number in the text of a word, in compiled code.

A number of up to 15 digits is an exact integer divided by an exact power of ten, which rounds as
correctly as the text's conversion.
"""

from __future__ import annotations

import numpy as np

from gcode.fast.compiled import njit_part

__all__ = ["read_number"]

_MINUS, _PLUS, _POINT, _COMMA = (ord(c) for c in "-+.,")
_DIGITS = 15  #: whole numbers of so many digits are exact, and so are these powers of ten
_POWERS = 10.0 ** np.arange(16)


@njit_part
def read_number(data, at, takes_comma):  # pragma: no cover - compiled
    """Read a sign and up to 15 digits with a point.

    Parameters
    ----------
    data : (bytes,) uint8
    at : int
        Offset of the sign or the first digit.
    takes_comma : bool
        A comma between two digits is a point.

    Returns
    -------
    tuple
        Value; decimals, -1 without a point; offset behind it, -1 where it is no such number.
    """
    negative = data[at] == _MINUS
    if negative or data[at] == _PLUS:
        at += 1
    mantissa, digits, decimals = 0, 0, -1
    while True:
        c = data[at]
        digit = c - 48
        if 0 <= digit <= 9:
            mantissa = mantissa * 10 + digit
            digits += 1
            decimals += decimals >= 0
        elif decimals < 0 and (c == _POINT or (c == _COMMA and takes_comma and digits)):
            if c == _COMMA and not 48 <= data[at + 1] <= 57:
                break
            decimals = 0
        else:
            break
        at += 1
    if digits == 0 or digits > _DIGITS:
        return 0.0, decimals, -1
    return mantissa / _POWERS[max(decimals, 0)] * (-1.0 if negative else 1.0), decimals, at
