"""Memory does not grow, and a call costs little."""

import gc
import resource
import sys
import time

import numpy as np

import nonsmooth
from conftest import l1
from nonsmooth import _minimize
from nonsmooth._engine import CollectionProblem


def failing(x):
    raise nonsmooth.OutsideDomain("never")


def run(kind):
    if kind == 0:
        nonsmooth.minimize(l1, [5.0, -3.0], options={"max_evaluations": 6}, callback=lambda x: None)
    elif kind == 1:
        try:
            nonsmooth.minimize(failing, [5.0, -3.0])
        except nonsmooth.OutsideDomain:
            pass
    else:
        outputs = np.array([1.0, 2.0]), np.eye(2)
        nonsmooth.minimize_composite("max", lambda x: outputs, [5.0, -3.0], options={"max_evaluations": 3}).recheck()


def test_ten_thousand_calls_leave_nothing_behind():
    def resident():
        with open("/proc/self/statm") as statm:
            return int(statm.read().split()[1]) * resource.getpagesize()

    for index in range(1500):
        run(index % 3)
    gc.collect()
    before, objects, references = resident(), len(gc.get_objects()), sys.getrefcount(l1)
    for index in range(10_000):
        run(index % 3)
    gc.collect()
    assert sys.getrefcount(l1) == references
    # Caches of the test run itself may hold some objects.
    assert len(gc.get_objects()) - objects < 200
    # 100 bytes per call; one array of a run that stays would be more.
    assert resident() - before < 1_000_000


def overhead():
    """Seconds per evaluation that the way through Python adds, for a function of Rust with 10 variables."""
    problem = CollectionProblem("Maxquad")
    setups = []
    engine = _minimize._engine

    class Spy:
        @staticmethod
        def minimize(setup):
            setups.append(setup)
            return engine.minimize(setup)

    _minimize._engine = Spy
    try:
        nonsmooth.minimize(problem, problem.start)
    finally:
        _minimize._engine = engine

    def seconds(call):
        begin = time.process_time()
        result = call()
        return time.process_time() - begin, result

    # Time of the processor, by turns: the machine may do other work.
    pairs = [
        (seconds(lambda: problem.minimize(setups[0]))[0], *seconds(lambda: nonsmooth.minimize(problem, problem.start)))
        for _ in range(40)
    ]
    alone, through = (min(pair[k] for pair in pairs) for k in (0, 1))
    return (through - alone) / pairs[0][2].nfev


def test_an_evaluation_costs_at_most_30_microseconds_more():
    assert sorted(overhead() for _ in range(3))[1] < 30e-6
