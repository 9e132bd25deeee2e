"""The pictures of docs/tutorial_roller.md."""

import matplotlib.pyplot as plt
import numpy as np
from drawing import OPTIMUM, OTHER, START, along
from scipy.interpolate import CubicSpline

CASES = ["high", "high, tilted", "low", "low, tilted"]
TOPS = [2800, 2800, 1800, 1800]  # ends of the axes, MPa
HALF = 10.0  # half the length of the roller, mm
LOGARITHMIC = {"3.06 µm (start)": (0.00306, "--"), "7 µm (ISO/TS 16281)": (0.007, ":")}


def draw_pressures(file, optimized, cylinder):
    curves = [
        ("cylinder", cylinder, "shape", OTHER, ":"),
        ("logarithmic crown, 3.06 µm", optimized, "initial", START, "--"),
        ("optimum", optimized, "optimal", OPTIMUM, "-"),
    ]
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 4.6), sharex=True, layout="constrained")
    for number, (axis, case, top) in enumerate(zip(axes.flat, CASES, TOPS), 1):
        for label, folder, shape, color, style in curves:
            table = along(folder / f"pressure_{shape}_case_{number}.csv", "x1_mm")
            axis.plot(table["x1_mm"], table["pressure_MPa"], style, color=color, label=label)
        axis.set(title=case, xlim=(-HALF, HALF), ylim=(0, top))
        axis.grid(alpha=0.3)
    axes[0, 0].legend(frameon=False, loc="lower center")
    for axis in axes[:, 0]:
        axis.set_ylabel("pressure at x₂ = 0, MPa")
    for axis in axes[1]:
        axis.set_xlabel("x₁ along the roller, mm")
    figure.savefig(file, dpi=80)


def draw_profiles(file, optimized):
    start, optimum = (along(optimized / f"pressure_{shape}_case_1.csv", "x1_mm") for shape in ("initial", "optimal"))
    # A spline between the nodes, which are 2 mm apart in the middle; the start is the first formula.
    change = CubicSpline(start["x1_mm"], optimum["x3_mm"] - start["x3_mm"])
    x = np.linspace(-HALF, HALF, 2001)[1:-1]
    figure, axis = plt.subplots(figsize=(7.6, 3.5), layout="constrained")
    for label, (size, style) in LOGARITHMIC.items():
        axis.plot(x, -1e3 * size * np.log(1 - (x / HALF) ** 2), style, color=START, label=f"logarithmic crown, {label}")
    drop = -0.00306 * np.log(1 - (x / HALF) ** 2) + change(x) - change(0)
    axis.plot(x, 1e3 * drop, color=OPTIMUM, linewidth=2, label="optimum")
    axis.set(xlim=(-HALF, HALF), ylim=(0, 25), xlabel="x₁ along the roller, mm", ylabel="drop from the middle, µm")
    axis.grid(alpha=0.3)
    axis.legend(frameon=False, loc="upper center")
    figure.savefig(file, dpi=80)
