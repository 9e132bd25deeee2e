"""The pictures of README.md and of the pages: python docs/pictures/make.py [PICTURE.png ...], by default all of them.

Each picture has an entry below that says what draws it, from which run or file. Runs are made anew, in a folder that is
deleted at the end; all of them take about ten minutes.

Needs

* the programs: cargo build --release --locked -p problems
* pip install gmsh matplotlib meshio numpy scipy
* for python_*.png: the Python package (docs/install.md)
* for report_*.png: Node.js 18 or later with npm, and Chromium, which the variable CHROMIUM names
"""

import functools
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import bracket
import roller
import taper

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SCENES = ROOT / "problems" / "scenes"
ASSETS = ROOT / "problems" / "figures" / "assets"
PROGRAMS = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release"

# What is run, in the folder of the repository; OUT is the folder of results.
RUNS = {
    "first": ["signorini3d --mesh 6 --max-evaluations 5 --out OUT"],
    "signorini": ["signorini3d --out OUT"],
    "signorini35": ["signorini3d --mesh 35 --subdomains 5 --degrees 7 --control-points 8x8 --out OUT"],
    "friction": ["signorini3d compare --out OUT"],
    "hertz": ["hertz3d --out OUT"],
    "seat": ["contact3d problems/scenes/jack_seat.toml --out OUT"],
    "toy": ["toy2d --out OUT"],
    "lug": ["contact3d problems/scenes/lug_cases.toml evaluate --out OUT"],
    "bracket": ["contact3d problems/scenes/bracket.toml --out OUT"],
    "roller": ["contact3d problems/scenes/roller.toml --out OUT"],
    "cylinder": [
        "python problems/scenes/roller.py roller 1 OUT.msh",
        "contact3d problems/scenes/roller.toml evaluate --set body[1].mesh=OUT.msh --out OUT",
    ],
    "taper": ["contact3d problems/scenes/taper.toml --out OUT"],
    "matched": [
        "contact3d problems/scenes/taper.toml evaluate --controls problems/scenes/taper_matched.json --out OUT",
    ],
}


def call(*command):
    print("+", *command, flush=True)
    subprocess.run([str(word) for word in command], cwd=ROOT, check=True, stdout=subprocess.PIPE)


@functools.cache
def run(name, scratch):
    """The folder of results of a run."""
    out = scratch / name
    for line in RUNS[name]:
        program, *words = line.split()
        path = Path(sys.executable) if program == "python" else PROGRAMS / program
        if not path.exists():
            sys.exit(f"{path} is missing: cargo build --release --locked -p problems --bin {program}")
        call(path, *(word.replace("OUT", str(out)) for word in words))
    return out


def figure(name):
    """A figure that the program has written into the folder of its results."""
    return lambda file, results: shutil.copyfile(results / name, file)


def gallery(file):
    """Drawn by the example of this name."""
    call(sys.executable, ROOT / "python" / "examples" / f"{file.stem.removeprefix('python_')}.py", file)


def report(kind):
    """A screenshot of the report of a run."""

    def draw(file, results):
        if not (ASSETS / "node_modules").exists():
            call("npm", "ci", "--prefix", ASSETS, "--no-audit", "--no-fund")
        call("node", HERE / "report.mjs", kind, results / "report.html", file)

    return draw


# What draws each picture, and the runs (or files of scenes) that it is drawn from.
PICTURES = {
    "bracket_mesh.png": (bracket.draw_mesh, "bracket.msh"),
    "bracket_pressure.png": (bracket.draw_pressures, "bracket"),
    "bracket_stress.png": (bracket.draw_stresses, "bracket"),
    "first_pressure.svg": (figure("figures/pressure.svg"), "first"),
    "friction_pressure.svg": (figure("figures/pressure.svg"), "friction"),
    "hertz_pressure.svg": (figure("figures/pressure.svg"), "hertz"),
    "python_contact_shape.png": (gallery,),
    "python_fastest_mixing.png": (gallery,),
    "python_filter_design.png": (gallery,),
    "python_own_simulator.png": (gallery,),
    "python_robust_monotone_fit.png": (gallery,),
    "python_sparse_control.png": (gallery,),
    "report_signorini_narrow.png": (report("narrow"), "signorini"),
    "report_space.png": (report("space"), "lug"),
    "roller_pressure.png": (roller.draw_pressures, "roller", "cylinder"),
    "roller_profile.png": (roller.draw_profiles, "roller"),
    "seat_pressure.svg": (figure("figures/pressure.svg"), "seat"),
    "signorini12_convergence.svg": (figure("figures/convergence.svg"), "signorini"),
    "signorini35_pressure_cuts.svg": (figure("figures/pressure_cuts.svg"), "signorini35"),
    "taper_pressure.png": (taper.draw_pressures, "taper", "matched"),
    "taper_profile.png": (taper.draw_profiles, "taper", "matched"),
    "taper_sketch.png": (taper.draw_sketch, "taper_stem.msh", "taper_head.msh"),
    "toy_landscape.svg": (figure("landscape.svg"), "toy"),
}


def main(names):
    unknown = [name for name in names if name not in PICTURES]
    if unknown:
        sys.exit(f"no such picture: {', '.join(unknown)}; there are {', '.join(PICTURES)}")
    with tempfile.TemporaryDirectory() as scratch:
        for name in names or PICTURES:
            draw, *sources = PICTURES[name]
            found = (run(own, Path(scratch)) if own in RUNS else SCENES / own for own in sources)
            draw(HERE / name, *found)
            print(name, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
