"""What the package returns is what the engine returns in Rust, bit for bit."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import nonsmooth
from conftest import same_bits, without_times
from nonsmooth import _engine, _minimize
from nonsmooth._engine import CollectionProblem

NAMES = CollectionProblem.names()
COUNTS = Path(__file__).parents[2] / "tests" / "engine" / "evaluation_counts.rs"


def constraints(problem):
    rows, lower, upper = problem.rows
    return [(rows, lower, upper)] if len(rows) else ()


def both(problem, x0, options):
    """The run through the package, and the same setup in Rust."""
    setups, calls = [], []

    def fun(x):
        calls.append(None)
        return problem(x)

    original = _engine.minimize

    class Spy:
        @staticmethod
        def minimize(setup):
            setups.append(setup)
            return original(setup)

    _minimize._engine = Spy
    try:
        result = nonsmooth.minimize(
            fun, x0, bounds=np.transpose(problem.bounds), constraints=constraints(problem), options=options
        )
    finally:
        _minimize._engine = _engine
    assert len(calls) == result.nfev
    return result, problem.minimize(setups[0])


def assert_same(result, outcome):
    assert same_bits(result.x, outcome["x"]) and same_bits(result.fun, outcome["value"])
    assert without_times(result.history) == without_times(json.loads(outcome["history"]))
    assert result.counts == json.loads(outcome["counts"]) and result.reason == outcome["reason"]
    if result.certificate is not None:
        assert same_bits(result.certificate.multipliers, outcome["certificate"].multipliers)
        assert same_bits(result.certificate.subgradients, outcome["certificate"].subgradients)


@pytest.mark.parametrize("name", NAMES)
def test_the_collection(name):
    problem = CollectionProblem(name)
    options = {"max_evaluations": 3000 if len(problem.start) >= 50 else 2000}
    assert_same(*both(problem, problem.start, options))


def test_the_counts_are_those_that_the_repository_pins():
    pinned = dict(re.findall(r'\("(\w+)", (\d+)\),', COUNTS.read_text()))
    assert len(pinned) == 42 and len(NAMES) == 44
    different = {}
    for name, count in pinned.items():
        problem = CollectionProblem(name)
        level = problem.optimal_value + 1e-6 * (1 + abs(problem.optimal_value))
        values = []

        def fun(x):
            answer = problem(x)
            values.append(answer[0])
            return answer

        def stop(x):
            if min(values) <= level:
                raise StopIteration

        nonsmooth.minimize(
            fun, problem.start, bounds=np.transpose(problem.bounds), constraints=constraints(problem), callback=stop
        )
        # Dense kernels round by the processor, and the last bit leads two courses apart.
        if abs(len(values) - int(count)) > max(5, int(count) // 4):
            different[name] = (len(values), int(count))
    assert different == {}


SMALL = [name for name in NAMES if len(CollectionProblem(name).start) <= 10]


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(SMALL),
    moves=st.lists(st.floats(-0.5, 0.5), min_size=10, max_size=10),
    options=st.fixed_dictionaries(
        {"max_evaluations": st.integers(1, 120)},
        optional={
            "tolerance": st.sampled_from([1e-3, 1e-5, 1e-9]),
            "first_step": st.floats(1e-3, 10.0),
            "bundle_size": st.integers(3, 30),
            "objective_scale": st.floats(0.1, 10.0),
            "x_scale": st.floats(0.1, 10.0),
            "convex": st.booleans(),
        },
    ),
)
def test_any_start_and_any_options(name, moves, options):
    problem = CollectionProblem(name)
    x0 = problem.start * (1 + np.array(moves[: len(problem.start)])) + np.array(moves[: len(problem.start)]) * 0.1
    try:
        result, outcome = both(problem, x0, options)
    except ValueError as error:
        # The function may not be defined at the moved start.
        assert "the first evaluation failed" in str(error) or "allowed" in str(error)
        return
    assert_same(result, outcome)
