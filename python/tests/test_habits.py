"""What users do by habit or by mistake: it works as in scipy, or is refused by name."""

import copy
import importlib.metadata
import json
import os
import pickle
import sys

import numpy as np
import pytest
import scipy.optimize
from scipy.optimize import Bounds

import nonsmooth
from conftest import l1, same_bits

START = [5.0, -3.0]


@pytest.mark.parametrize(
    "answer",
    [
        lambda value, subgradient: [value, subgradient],
        lambda value, subgradient: (np.array([value]), subgradient),
        lambda value, subgradient: (np.array([[value]]), subgradient.astype(object)),
        lambda value, subgradient: (value, subgradient.astype(np.float16)),
    ],
)
def test_answers_that_scipy_takes_are_taken(answer):
    whole = nonsmooth.minimize(l1, START)
    assert same_bits(nonsmooth.minimize(lambda x: answer(*l1(x)), START).x, whole.x)


def test_args_that_are_no_tuple_are_one_argument():
    def fun(x, at):
        return l1(x, at)

    at = np.array([4.0, 5.0])
    own = nonsmooth.minimize(fun, START, args=at)
    through = scipy.optimize.minimize(fun, START, args=at, jac=True, method=nonsmooth.bundle_trust)
    assert np.abs(own.x - at).max() < 1e-6 and same_bits(own.x, through.x)
    assert nonsmooth.taylor_test(fun, START, args=at, disp=False).right


@pytest.mark.parametrize(
    "call, error, words",
    [
        (dict(x0=np.array([1 + 1j, 2])), TypeError, "x0 is array.*expected real numbers"),
        (dict(x0="ab"), TypeError, "x0 is 'ab', expected real numbers"),
        (dict(bounds=Bounds([np.nan, 0], 1)), ValueError, "bounds.lb has entries that are NaN"),
        (dict(bounds=[(0, np.nan), (0, 1)]), ValueError, "upper bound has entries that are NaN"),
        (dict(bounds=5), TypeError, "2 pairs .lower, upper.*found int"),
        (dict(bounds=[(0, 1), None]), ValueError, "entry 1 is None"),
        (dict(constraints=((1, 1), 0, 2)), TypeError, "not a tuple"),
        (dict(options="maxfev"), TypeError, "options is str, expected a dict"),
        (dict(options={"scaling": "x"}), TypeError, "option scaling is 'x'"),
        (dict(options={"accuracy": (1, 2, "a")}), TypeError, "option accuracy is"),
        (dict(options={"max_seconds": 0}), ValueError, "max_seconds = 0.0 is not allowed; allowed: > 0"),
        (dict(options={"bundle_size": 2}), ValueError, "bundle_size = 2 is not allowed; allowed: ≥ 3"),
        (dict(callback=3), TypeError, "callback is int, expected a function"),
    ],
)
def test_mistakes_are_named(call, error, words):
    with pytest.raises(error, match=words):
        nonsmooth.minimize(l1, **{"x0": START, **call})


@pytest.mark.parametrize("options", [{"max_evaluations": 1e30}, {"convex": None, "disp": None, "first_step": None}])
def test_no_limit_and_none_are_understood(options):
    assert same_bits(nonsmooth.minimize(l1, START, options=options).x, nonsmooth.minimize(l1, START).x)


@pytest.mark.parametrize(
    "answer, words",
    [
        (lambda: (1j, [1.0, 1.0]), "the value that fun returns is complex, expected a real number"),
        (lambda: (1.0, np.array([1j, 1])), "complex128, expected a one-dimensional array of real numbers"),
        (lambda: (1.0, ["1", "2"]), "the subgradient that fun returns is list"),
        (lambda: [1.0], "it returned a list of 1"),
    ],
)
def test_answers_that_are_no_real_numbers_are_refused(answer, words):
    with pytest.raises(TypeError, match=words):
        nonsmooth.minimize(lambda x: answer(), START)


def test_numbers_are_enough_for_one_variable():
    b, c = np.array([0.65, 0.12, 0.95]), np.array([0.2, 0.4, 0.9])

    def value(x):
        return np.abs(x * b - c).sum()

    def slope(x):
        return (np.sign(x * b - c) * b).sum()

    whole = nonsmooth.minimize(lambda x: (value(x), np.array([slope(x)])), [0.5])
    for result in (
        nonsmooth.minimize(value, 0.5, jac=slope),
        nonsmooth.minimize(lambda x: (value(x), slope(x)), 0.5),
        scipy.optimize.minimize(value, 0.5, jac=slope, method=nonsmooth.bundle_trust),
    ):
        assert same_bits(result.x, whole.x) and result.nfev == whole.nfev
    assert nonsmooth.taylor_test(value, 0.4, jac=slope, disp=False).right
    composite = nonsmooth.minimize_composite("l1", lambda x: (x * b - c, b), 0.5)
    assert composite.success and abs(composite.fun - whole.fun) < 1e-9


@pytest.mark.parametrize(
    "fun, jac, words",
    [
        (lambda x: l1(x)[0], lambda x: 1.0, "the subgradient that jac returns is float"),
        (lambda x: l1(x)[0], lambda x: [1.0], "the subgradient that jac returns has 1 entries, expected 2"),
        (l1, lambda x: l1(x)[1], "the value that fun returns is tuple"),
        (lambda x: (1.0, 1.0), True, "the subgradient that fun returns is float"),
    ],
)
def test_the_function_that_is_wrong_is_named(fun, jac, words):
    for call in (nonsmooth.minimize, nonsmooth.taylor_test):
        with pytest.raises((TypeError, ValueError), match=words):
            call(fun, START, jac=jac)


def test_messages_name_what_python_has():
    def refused(x):
        if abs(x[0] - 5) > 1e-9:
            raise nonsmooth.OutsideDomain("not here")
        return l1(x)

    ends = [
        nonsmooth.minimize(l1, START, options={"convex": True}),
        nonsmooth.minimize(l1, START, options={"max_evaluations": 3}),
        nonsmooth.minimize(l1, START, options={"max_iterations": 3}),
        nonsmooth.minimize(lambda x: (1.0, np.ones(2)), START, options={"max_evaluations": 200}),
        nonsmooth.minimize(lambda x: (x[0], np.array([1.0])), [0.0]),
        nonsmooth.minimize(refused, START),
    ]
    assert len({result.reason for result in ends}) == len(ends)
    for result in ends:
        assert not any(word in result.message for word in ("verify", "oracle", "Termination", "--"))
    assert "fun failed" in ends[-1].message and "not here" in ends[-1].message


def test_what_a_number_raises_while_it_is_converted_comes_back():
    """JAX computes where its arrays are converted: an interrupt or a failure there is no wrong form."""

    class Lazy:
        def __init__(self, error):
            self.error = error

        def __array__(self, dtype=None, copy=None):
            raise self.error

        def __float__(self):
            raise self.error

    for error in (KeyboardInterrupt(), RuntimeError("the device failed"), MemoryError()):
        for answer in ((1.0, Lazy(error)), (Lazy(error), [1.0, 1.0]), (1.0, [1.0, 1.0], Lazy(error))):
            with pytest.raises(type(error)) as caught:
                nonsmooth.minimize(lambda x: answer, START)
            assert caught.value is error

    class Attached(Lazy):
        """A tensor of PyTorch that carries a gradient."""

    with pytest.raises(TypeError, match="Attached") as caught:
        nonsmooth.minimize(lambda x: (1.0, Attached(RuntimeError("Use tensor.detach().numpy() instead."))), START)
    assert "detach" in str(caught.value.__cause__)


def test_an_exception_that_takes_no_attribute_comes_back():
    class Closed(Exception):
        def __setattr__(self, name, value):
            raise RuntimeError("closed")

    error = Closed()

    def fun(x):
        raise error

    with pytest.raises(Closed) as caught:
        nonsmooth.minimize(fun, START)
    assert caught.value is error


def test_a_function_that_minimises_itself_without_end_is_refused():
    def fun(x):
        return nonsmooth.minimize(fun, x)

    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(100_000)
    try:
        with pytest.raises(RecursionError, match="minimises within itself"):
            nonsmooth.minimize(fun, START)
    finally:
        sys.setrecursionlimit(limit)
    # The count begins anew.
    assert nonsmooth.minimize(l1, START).fun < 1e-6


def test_results_hold_what_is_for_users_and_are_copied():
    result = nonsmooth.minimize_composite("max", lambda x: (np.array([x[0] - 1, 5 - 2 * x[0]]), np.array([[1.0], [-2.0]])), [3.0])
    assert not any(name.startswith("_") for name in result.keys())
    assert "_" not in repr(result).replace("largest_violation", "").replace("start_value", "").split("message")[0]
    for again in (copy.copy(result), copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        assert again.recheck() == result.recheck() and again.recheck().composite_difference is not None


def test_a_run_without_progress_points_to_the_subgradient():
    result = nonsmooth.minimize(lambda x: (1.0, np.ones(2)), START, options={"max_evaluations": 200})
    assert result.reason == "step_too_short" and "taylor_test" in result.message
    good = nonsmooth.minimize(l1, START, options={"max_evaluations": 3})
    assert "taylor_test" not in good.message and "max_evaluations" in good.message


def test_a_journal_of_another_start_is_not_dropped(tmp_path):
    nonsmooth.minimize(l1, START, journal=tmp_path, options={"max_evaluations": 3})
    kept = (tmp_path / "journal.jsonl").read_bytes()
    with pytest.raises(ValueError, match="began at another x0"):
        nonsmooth.minimize(l1, [5.0, -2.0], resume=tmp_path)
    assert (tmp_path / "journal.jsonl").read_bytes() == kept
    # A start outside the constraints is moved, and need not be the first point.
    rows = ([[1.0, 1.0]], -np.inf, 1.0)
    folder = os.fsencode(tmp_path / "moved")
    nonsmooth.minimize(l1, START, constraints=rows, journal=folder, options={"max_evaluations": 3})
    again = nonsmooth.minimize(l1, START, constraints=rows, resume=folder)
    assert same_bits(again.x, nonsmooth.minimize(l1, START, constraints=rows).x) and again.warnings == []
    # Coordinates of the run round.
    matrix = {"scaling": [[3.0, 1.0], [0.1, 0.7]]}
    nonsmooth.minimize(l1, START, journal=tmp_path / "scaled", options={**matrix, "max_evaluations": 3})
    again = nonsmooth.minimize(l1, START, resume=tmp_path / "scaled", options=matrix)
    assert same_bits(again.x, nonsmooth.minimize(l1, START, options=matrix).x) and again.warnings == []


def test_a_folder_that_cannot_be_is_an_error_of_its_kind(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(NotADirectoryError, match="file"):
        nonsmooth.minimize(l1, START, journal=tmp_path / "file")


@pytest.mark.parametrize(
    "answer, words",
    [
        (1.0, "outer must return .value, subgradient.; it returned float"),
        ((1.0, np.ones(2), 0.0), "it returned a tuple of 3"),
        ((1.0, "ab"), "the subgradient that outer returns is str"),
    ],
)
def test_answers_of_an_outer_function_are_checked(answer, words):
    with pytest.raises(TypeError, match=words):
        nonsmooth.minimize_composite(lambda c: answer, lambda x: (x, np.eye(2)), START)
    with pytest.raises(TypeError, match="exponent is '2'"):
        nonsmooth.minimize_composite("power", lambda x: (x, np.eye(2)), START, exponent="2")


def test_a_taylor_test_that_tests_nothing_is_refused():
    with pytest.raises(ValueError, match="direction is zero"):
        nonsmooth.taylor_test(l1, START, direction=[0, 0])
    with pytest.raises(ValueError, match="not finite at x or next to it"):
        nonsmooth.taylor_test(lambda x: (np.nan, x), START)


def test_the_installed_package_brings_its_licences():
    names = {path.name for path in importlib.metadata.files("nonsmooth")}
    assert {"LICENSE-MIT", "LICENSE-APACHE"} <= names


def test_records_are_plain_data():
    assert json.loads(json.dumps(nonsmooth.minimize(l1, START).history))[0]["kind"] == "start"
