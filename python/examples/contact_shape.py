"""The shape of an elastic block that spreads the pressure under a wavy obstacle, with friction (units N, mm, MPa)."""

import sys
from pathlib import Path

from nonsmooth.contact import Scene

SCENES = Path(__file__).resolve().parents[2] / "problems" / "scenes"


def optimize():
    block = {"body[0].block.bricks": [8, 8, 8], "body[0].block.subdomains": [2, 2, 2]}
    scene = Scene.from_toml(SCENES / "signorini.toml", **block)
    result = scene.optimize()
    return scene.evaluate(), scene.evaluate(result.x), result


def main(picture=None):
    before, after, result = optimize()
    print(f"{before.unit}: {before.theta:.4e} -> {after.theta:.4e} after {result.nfev} evaluations, success {result.success}")
    print(f"peak pressure {before.pressures.max():.0f} -> {after.pressures.max():.0f} MPa")
    if picture:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(1, 2, figsize=(6.5, 2.8))
        for axis, state, title in zip(axes, (before, after), ("flat", "optimized")):
            image = axis.imshow(state.pressures.T, origin="lower", vmin=0, vmax=before.pressures.max(), cmap="viridis")
            axis.set_title(f"{title}: peak {state.pressures.max():.0f} MPa", fontsize=9)
            axis.set_axis_off()
        figure.colorbar(image, ax=axes, label="contact pressure, MPa")
        figure.savefig(picture, dpi=80)
    return before, after, result


if __name__ == "__main__":
    main(*sys.argv[1:2])
