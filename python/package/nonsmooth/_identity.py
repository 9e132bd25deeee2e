"""What a journal is recognised by: all that the course of a run depends on, but for what the function computes."""

import hashlib
import json
from collections.abc import Mapping

import numpy as np

#: Options that a run may be continued with.
CHANGEABLE = ("max_evaluations", "max_iterations", "max_seconds", "tolerance")


def identity(name, config, **parts):
    """The name of the function, and a digest of every part under its name."""
    config = {option: value for option, value in json.loads(config).items() if option not in CHANGEABLE}
    found = {**parts, "options": (config, parts.get("options"))}
    return "; ".join([name, *(f"{part.replace('_', ' ')} {_digest(value)}" for part, value in found.items())])


def _digest(value):
    digest = hashlib.sha256()
    _add(digest, value)
    return digest.hexdigest()[:12]


def _add(digest, value):
    if value is None or isinstance(value, (bool, int, float, complex, str, bytes)):
        digest.update(f"{value!r},".encode())
    elif isinstance(value, (np.ndarray, np.generic)) and value.dtype != object:
        digest.update(f"{value.dtype}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, Mapping):
        _add(digest, list(value.items()))
    elif isinstance(value, (list, tuple)):
        digest.update(f"{len(value)}:".encode())
        for entry in value:
            _add(digest, entry)
    else:
        # A function or an object of the user: another process may know it by its name alone.
        digest.update(getattr(value, "__qualname__", type(value).__qualname__).encode())
