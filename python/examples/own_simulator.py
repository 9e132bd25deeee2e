"""A simulator of your own behind a subprocess: it reads JSON, writes JSON, and may fail. Every run of it is kept.

The simulator here is this file with the argument `simulate`: the travels of two springs with stops, p = (force, gap), cost
p'p/2 - 2 min(p), infinite for p beyond the tested range, where it ends with status 3. The optimum under p[0] + p[1] <= 3/2
is p = (3/4, 3/4), where the spring just touches its stop.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import nonsmooth


def simulate(text):
    force, gap = json.loads(text)["parameters"]
    if force > 2:
        print(f"force {force} is beyond the tested range", file=sys.stderr)
        sys.exit(3)
    stopped = force > gap
    gradient = [force, gap - 2] if stopped else [force - 2, gap]
    print(json.dumps({"cost": (force**2 + gap**2) / 2 - 2 * min(force, gap), "gradient": gradient}))


def run_simulator(p):
    question = json.dumps({"parameters": p.tolist()})
    done = subprocess.run([sys.executable, __file__, "simulate"], input=question, capture_output=True, text=True)
    if done.returncode == 3:
        # The optimizer tries a shorter step.
        raise nonsmooth.OutsideDomain(done.stderr.strip())
    done.check_returncode()
    answer = json.loads(done.stdout)
    return answer["cost"], answer["gradient"]


def optimize(folder):
    arguments = dict(x0=[1.9, 0.25], bounds=[(0, None)] * 2, constraints=([[1, 1]], -1e9, 1.5))
    # Ends after 4 runs of the simulator, as a power failure would; the second call continues.
    nonsmooth.minimize(run_simulator, **arguments, journal=folder, options={"max_evaluations": 4})
    return nonsmooth.minimize(run_simulator, **arguments, resume=folder, options={"first_step": None})


def main(picture=None):
    with tempfile.TemporaryDirectory() as folder:
        result = optimize(Path(folder) / "run")
    print(f"cost {result.fun:.8f} at {result.x.round(4)} after {result.nfev} runs, success {result.success}")
    if picture:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(figsize=(6, 2.6))
        best = [record["center_value"] - result.fun for record in result.history]
        # The last runs confirm the optimum.
        above = [cost for cost in best if cost > 0]
        runs = range(1, len(above) + 1)
        axes.semilogy(runs, above, "o-", markersize=3)
        axes.set(xticks=runs, xlabel="runs of the simulator", ylabel="best cost above the last")
        figure.tight_layout()
        figure.savefig(picture, dpi=80)
    return result


if __name__ == "__main__":
    if sys.argv[1:] == ["simulate"]:
        simulate(sys.stdin.read())
    else:
        main(*sys.argv[1:2])
