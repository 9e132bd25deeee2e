"""A monotone curve through data with outliers: least absolute deviations under linear constraints."""

import sys

import numpy as np

import nonsmooth

KNOTS = 16


def data():
    random = np.random.default_rng(3)
    t = np.sort(random.uniform(0, 1, 120))
    y = 1 / (1 + np.exp(-12 * (t - 0.5))) + 0.03 * random.normal(size=t.size)
    outliers = random.choice(t.size, 18, replace=False)
    y[outliers] += random.uniform(-1.5, 1.5, outliers.size)
    return t, y


def fit():
    t, y = data()
    knots = np.linspace(0, 1, KNOTS)
    # Piecewise linear interpolation of the values at the knots.
    basis = np.array([np.interp(t, knots, row) for row in np.eye(KNOTS)]).T
    growth = np.diff(np.eye(KNOTS), axis=0)  # Values do not fall from knot to knot.
    result = nonsmooth.minimize_composite(
        "l1", lambda v: (basis @ v - y, basis), np.zeros(KNOTS), bounds=[(0, 1)] * KNOTS, constraints=(growth, 0, np.inf)
    )
    squares = np.linalg.lstsq(basis, y, rcond=None)[0]
    return result, squares, knots, t, y


def main(picture=None):
    result, squares, knots, t, y = fit()
    print(f"sum of absolute deviations {result.fun:.8f} after {result.nfev} evaluations, success {result.success}")
    print(f"certificate checked again: {result.recheck().agrees}; active rows {np.sum(result.certificate.row_multipliers < 0)}")
    if picture:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(figsize=(6, 3))
        axes.plot(t, y, ".", color="0.7", label="data")
        axes.plot(knots, squares, "--", color="C1", label="least squares")
        axes.plot(knots, result.x, color="C0", label="monotone, least absolute deviations")
        axes.set(ylim=(-0.6, 1.6), xlabel="t")
        axes.legend(loc="upper left", fontsize=8)
        figure.tight_layout()
        figure.savefig(picture, dpi=80)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:2])
