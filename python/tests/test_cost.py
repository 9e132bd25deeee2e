"""Memory does not grow, and an evaluation takes no Python but the function."""

import gc
import resource
import sys

import numpy as np

import nonsmooth
from conftest import l1
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


def calls_of_python(evaluations):
    """Calls of functions in Python during a run of so many evaluations."""
    problem = CollectionProblem("Maxquad")
    calls = 0

    def function(x):
        return problem(x)

    def count(frame, event, argument):
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        result = nonsmooth.minimize(function, problem.start, options={"max_evaluations": evaluations})
    finally:
        sys.setprofile(None)
    assert result.nfev == evaluations
    return calls


def test_an_evaluation_calls_the_function_and_nothing_else():
    few, many = calls_of_python(10), calls_of_python(30)
    # What is done once differs by a call or two between the ends of runs.
    assert abs(many - few - 20) <= 3
