"""Arrays of real numbers of what a user passes."""

import numpy as np


def real(value, what):
    """An array of doubles; complex numbers are refused, of which numpy would drop the imaginary parts with no more than a warning."""
    try:
        array = np.asarray(value)
        if array.dtype.kind in "biufO":
            return array.astype(float)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{what} is {_short(value)}, expected real numbers") from error
    raise TypeError(f"{what} is {_short(value)}, expected real numbers")


def _short(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
