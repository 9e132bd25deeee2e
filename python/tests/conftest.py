"""Helpers of the tests. The wheel under test is built with the feature `collection`, by .ci/python."""

import json
import os
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from nonsmooth import _engine


def l1(x, at=(1.0, 2.0)):
    """|x - at|_1 with a subgradient."""
    return float(np.abs(x - at).sum()), np.sign(x - np.asarray(at))


def same_bits(a, b):
    """Whether two arrays or numbers are equal to the last bit, NaN included."""
    return np.asarray(a, dtype=float).tobytes() == np.asarray(b, dtype=float).tobytes()


def without_times(history):
    """The records of a run without what the clock decides."""
    return [{key: value for key, value in record.items() if key != "seconds"} for record in history]


@pytest.fixture(scope="session")
def collection():
    """The problems of the collection by name."""
    problem = _engine.CollectionProblem
    return {name: problem(name) for name in problem.names()}


@pytest.fixture(scope="session")
def contact3d():
    """The program of the repository, built if it is not there."""
    # The features of the wheel, so that nothing is built twice.
    packages = ["-p", "problems", "-p", "nonsmooth-python", "--features", "nonsmooth-python/collection"]
    build = ["cargo", "build", "--locked", *packages, "--bin", "contact3d", "--message-format=json"]
    printed = subprocess.run(build, cwd=Path(__file__).parents[2], capture_output=True, check=True, text=True).stdout
    return [json.loads(line)["executable"] for line in printed.splitlines() if '"executable":"' in line][-1]


@pytest.fixture
def interruptible():
    """Ctrl-C raises KeyboardInterrupt, also where whoever started the tests ignores the signal, as shells do in the background."""
    kept = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, kept)


class Interrupt:
    """Ctrl-C after some seconds, sent by another thread."""

    def __init__(self, seconds):
        self.sent = None
        timer = threading.Timer(seconds, self.send)
        timer.start()

    def send(self):
        self.sent = time.process_time()
        os.kill(os.getpid(), signal.SIGINT)

    def age(self):
        """Processor seconds of this process since the signal was sent: what a loaded machine gives to others does not count."""
        return time.process_time() - self.sent
