"""Functions that fail, are interrupted, answer roughly, or run in several threads; journals."""

import threading
import time

import numpy as np
import pytest

import nonsmooth
from conftest import Interrupt, l1, same_bits, without_times


def crescent(x):
    circle = x[0] ** 2 + (x[1] - 1) ** 2
    pieces = (circle + x[1] - 1, -circle + x[1] + 1)
    sign = 1.0 if pieces[0] >= pieces[1] else -1.0
    return max(pieces), np.array([2 * sign * x[0], 2 * sign * (x[1] - 1) + 1])


def failing_after(count, error):
    calls = []

    def fun(x):
        calls.append(x)
        if len(calls) > count:
            raise error
        return crescent(x)

    return fun


def test_an_exception_comes_back_unchanged_with_the_best_point():
    error = KeyError("my own")
    with pytest.raises(KeyError) as caught:
        nonsmooth.minimize(failing_after(9, error), [-1.5, 2.0])
    assert caught.value is error
    assert error.best.nfev == 9 and error.best.fun < 0.5 * crescent([-1.5, 2.0])[0] and not error.best.success
    assert error.__traceback__ is not None
    if hasattr(error, "add_note"):
        assert "best value" in error.__notes__[0]


def test_an_exception_of_the_first_evaluation_has_no_best_point():
    error = RuntimeError("at once")
    with pytest.raises(RuntimeError) as caught:
        nonsmooth.minimize(failing_after(0, error), [5.0, -3.0])
    assert caught.value is error and error.best is None


def test_an_exception_of_the_callback_ends_the_run():
    def callback(x):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError) as caught:
        nonsmooth.minimize(l1, [5.0, -3.0], callback=callback)
    assert caught.value.best.nfev == 1


def logarithm(x, outside):
    """x - log x, defined for x > 0: minimum 1 at 1."""
    if x[0] <= 0:
        return outside()
    return x[0] - np.log(x[0]), np.array([1 - 1 / x[0]])


def raising():
    raise nonsmooth.OutsideDomain("x <= 0")


@pytest.mark.parametrize("outside", [raising, lambda: (np.nan, np.array([np.nan])), lambda: (np.inf, np.array([0.0]))])
def test_points_outside_the_domain_shorten_the_step(outside):
    result = nonsmooth.minimize(logarithm, [5.0], args=(outside,), options={"first_step": 50.0})
    assert result.counts["failed"] >= 1
    assert abs(result.fun - 1) < 1e-6


def test_a_start_outside_the_domain():
    with pytest.raises(nonsmooth.OutsideDomain, match="x <= 0") as caught:
        nonsmooth.minimize(logarithm, [-5.0], args=(raising,))
    assert caught.value.best is None
    with pytest.raises(ValueError, match="the first evaluation failed: value is not finite"):
        nonsmooth.minimize(logarithm, [-5.0], args=(lambda: (np.nan, np.array([0.0])),))


@pytest.mark.parametrize(
    "answer, error, words",
    [
        (1.0, TypeError, "fun must return .value, subgradient.*it returned float"),
        ((1.0, [1.0]), ValueError, "the subgradient that fun returns has 1 entries, expected 2"),
        ((1.0, "ab"), TypeError, "the subgradient that fun returns is str"),
        (("a", [1.0, 2.0]), TypeError, "the value that fun returns is str"),
        ((1.0, np.zeros((2, 2))), TypeError, "shape .2, 2."),
    ],
)
def test_answers_of_a_wrong_form_are_refused(answer, error, words):
    with pytest.raises(error, match=words):
        nonsmooth.minimize(lambda x: answer, [5.0, -3.0])


@pytest.mark.parametrize(
    "answer",
    [
        lambda v, g: (v, g.tolist()),
        lambda v, g: (np.float32(v), g.astype(np.float32)),
        lambda v, g: (np.array(v), g.astype(int)),
        lambda v, g: (v, np.repeat(g, 2)[::2]),
        lambda v, g: (v, g, 0.0),
    ],
)
def test_numbers_of_all_kinds_are_taken(answer):
    result = nonsmooth.minimize(lambda x: answer(*l1(x)), [5.0, -3.0])
    assert result.fun < 1e-5


def test_accuracy_is_asked_for_on_demand():
    asked = []

    def rough(x, accuracy=0.0):
        asked.append(accuracy)
        value, subgradient = crescent(x)
        value += 1
        # An error of the size that is allowed, which the point determines.
        noise = accuracy * value
        return value + noise * np.sin(1e6 * x.sum()), subgradient, noise

    result = nonsmooth.minimize(rough, [-1.5, 2.0])
    assert result.nfev == len(asked)
    assert max(asked) == 1e-2 and min(asked) < 1e-4
    assert result.fun - 1 < 1e-4
    asked.clear()
    nonsmooth.minimize(rough, [-1.5, 2.0], options={"accuracy": "tightest"})
    assert set(asked) == {0.0}
    asked.clear()

    def value(x, accuracy):
        return rough(x, accuracy)[0]

    apart = nonsmooth.minimize(value, [-1.5, 2.0], jac=lambda x: crescent(x)[1])
    assert max(asked) == 1e-2 and apart.fun - 1 < 1e-2


def endless(x):
    """A function that takes 5 ms and has no end: the run creeps along a slope that never vanishes."""
    end = time.perf_counter() + 0.005
    while time.perf_counter() < end:
        pass
    return -float(np.log1p(np.abs(x).sum())), -np.sign(x) / (1 + np.abs(x).sum())


def test_keyboard_interrupt_within_half_a_second(interruptible):
    interrupt = Interrupt(0.3)
    # A signal that does not arrive must not hang the tests.
    options = {"max_evaluations": 10**6, "tolerance": 1e-15, "max_seconds": 10.0}
    with pytest.raises(KeyboardInterrupt) as caught:
        nonsmooth.minimize(endless, [5.0, -3.0], options=options)
    assert interrupt.age() < 0.5
    assert caught.value.best.fun < -2


def test_keyboard_interrupt_in_a_function_without_bytecode(collection, interruptible):
    problem = collection["NesterovWorst_20"]
    options = {"max_evaluations": 10**6, "tolerance": 1e-15}
    x0 = problem.start
    runs = 0
    interrupt = Interrupt(0.2)
    end = time.perf_counter() + 10
    with pytest.raises(KeyboardInterrupt) as caught:
        while time.perf_counter() < end:
            nonsmooth.minimize(problem, x0, options=options)
            runs += 1
    assert interrupt.age() < 0.5
    # Between two runs it is raised by this test, within a run it carries the best point.
    assert runs > 0 or caught.value.best is not None


def test_keyboard_interrupt_in_a_long_subproblem(interruptible):
    # Large enough that the first subproblem takes many times the delay of the signal on any machine.
    rng = np.random.default_rng(1)
    matrix, right = rng.normal(size=(3000, 400)), rng.normal(size=3000)
    interrupts = []

    def residuals(x):
        interrupts.append(Interrupt(0.1) if not interrupts else None)
        return matrix @ x - right, matrix

    with pytest.raises(KeyboardInterrupt) as caught:
        nonsmooth.minimize_composite("max", residuals, np.ones(400), options={"max_seconds": 60.0})
    assert interrupts[0].age() < 0.5
    assert caught.value.best.nfev == len(interrupts) == 1


def test_two_runs_at_once_in_threads(collection):
    names = ["Maxquad", "ChainedLQ"]
    alone = {name: nonsmooth.minimize(collection[name], collection[name].start) for name in names}
    together = {}

    def run(name):
        together[name] = nonsmooth.minimize(collection[name], collection[name].start)

    threads = [threading.Thread(target=run, args=(name,)) for name in names for _ in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    for name in names:
        assert same_bits(alone[name].x, together[name].x)
        assert without_times(alone[name].history) == without_times(together[name].history)


def test_a_run_inside_a_run():
    def outer(x):
        inner = nonsmooth.minimize(l1, [5.0, -3.0], args=((x[0], 0.0),))
        return abs(inner.x[0] - 1), np.sign([inner.x[0] - 1])

    assert nonsmooth.minimize(outer, [4.0]).fun < 1e-4


def test_the_interpreter_is_free_while_the_engine_works():
    n = 1000
    ticks, running = [0], [True]

    def tick():
        while running[0]:
            ticks[0] += 1
            time.sleep(0.001)

    def largest_square(x):
        i = np.abs(x).argmax()
        return x[i] ** 2, 2 * x[i] * (np.arange(n) == i)

    thread = threading.Thread(target=tick)
    thread.start()
    begin, used = time.perf_counter(), time.process_time()
    options = {"max_seconds": 1.0, "max_evaluations": 10**6}
    result = nonsmooth.minimize(largest_square, np.arange(n) - 0.5 * n, options=options)
    seconds, used = time.perf_counter() - begin, time.process_time() - used
    running[0] = False
    thread.join()
    assert seconds > 0.5, result.message
    # Nearly 1000 in a processor second with a free interpreter, 60 without.
    assert ticks[0] / used > 200


def test_a_resumed_run_ends_as_one_that_was_never_interrupted(tmp_path):
    folder, whole = tmp_path / "run", nonsmooth.minimize(crescent, [-1.5, 2.0])
    calls = []

    def crescent_again(x):
        calls.append(x)
        return crescent(x)

    def broken(x):
        if len(calls) == 6:
            raise OSError("the disk is full")
        return crescent_again(x)

    broken.__qualname__ = crescent_again.__qualname__ = "crescent"
    with pytest.raises(OSError):
        nonsmooth.minimize(broken, [-1.5, 2.0], journal=folder)
    # The exception is no answer of the function: it is asked again.
    result = nonsmooth.minimize(crescent_again, [-1.5, 2.0], resume=folder)
    assert same_bits(result.x, whole.x) and without_times(result.history) == without_times(whole.history)
    assert len(calls) == whole.nfev and result.warnings == []
    limited = nonsmooth.minimize(crescent_again, [-1.5, 2.0], resume=folder / "journal.jsonl")
    assert same_bits(limited.x, whole.x) and len(calls) == whole.nfev


def test_a_journal_of_another_call_is_refused_and_kept(tmp_path):
    def fun(x, weight=1.0):
        return weight * abs(x[0] - 3.0) + abs(x[1]), np.array([weight * np.sign(x[0] - 3.0), np.sign(x[1])])

    def disc(upper):
        return nonsmooth.NonlinearConstraint(lambda x: x @ x, -np.inf, upper, lambda x: 2 * x)

    call = dict(fun=fun, x0=[0.5, 0.5], args=(1.0,), bounds=[(-5, 5)] * 2, constraints=[disc(4.0)])
    nonsmooth.minimize(**call, journal=tmp_path, options={"max_evaluations": 3})
    kept = (tmp_path / "journal.jsonl").read_bytes()
    for what, other in [
        ("args", {"args": (2.0,)}),
        ("bounds and rows", {"bounds": [(-5, 4), (-5, 5)]}),
        ("bounds and rows", {"constraints": [disc(4.0), ([[1.0, 1.0]], -np.inf, 2.0)]}),
        ("sides of constraints", {"constraints": [disc(1.0)]}),
        ("options", {"options": {"convex": True}}),
        ("options", {"x_scale": [1.0, 2.0]}),
    ]:
        with pytest.raises(ValueError, match=f"another objective.*{what}"):
            nonsmooth.minimize(**{**call, **other}, resume=tmp_path)
        assert (tmp_path / "journal.jsonl").read_bytes() == kept
    resumed = nonsmooth.minimize(**call, resume=tmp_path, options={"max_evaluations": 100, "tolerance": 1e-8})
    assert resumed.success and abs(resumed.x[0] - 2.0) < 1e-6 and resumed.warnings == []


def test_a_run_cut_short_says_that_its_point_violates_a_constraint():
    far = nonsmooth.NonlinearConstraint(lambda x: x @ x, 4.0, np.inf, lambda x: 2 * x)
    result = nonsmooth.minimize(l1, [0.1, 0.1], constraints=far, options={"max_evaluations": 1})
    assert not result.success and "; x violates a nonlinear constraint by 4.0e+00; " in result.message


def test_journals_are_neither_overwritten_nor_confused(tmp_path):
    nonsmooth.minimize(crescent, [-1.5, 2.0], journal=tmp_path / "run", options={"max_evaluations": 3})
    with pytest.raises(FileExistsError, match="pass resume="):
        nonsmooth.minimize(crescent, [-1.5, 2.0], journal=tmp_path / "run")
    with pytest.raises(FileNotFoundError, match="pass journal="):
        nonsmooth.minimize(crescent, [-1.5, 2.0], resume=tmp_path / "other")
    with pytest.raises(ValueError, match="another objective"):
        nonsmooth.minimize(l1, [-1.5, 2.0], resume=tmp_path / "run")
    with pytest.raises(ValueError, match="not both"):
        nonsmooth.minimize(crescent, [-1.5, 2.0], journal="a", resume="b")
