"""What the drawings of several pages share."""

import csv

import matplotlib

matplotlib.use("Agg")
import numpy as np

# Colours of what the tutorials compare.
START, OTHER, OPTIMUM = "gray", "tab:red", "tab:blue"


def columns(file):
    """The columns of numbers of a table."""
    with file.open() as text:
        rows = list(csv.DictReader(text))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0] if key != "status"}


def along(file, axis):
    """The columns of numbers at the nodes in the plane x₂ = 0, in the order of an axis (`x1_mm`)."""
    table = columns(file)
    nodes = np.flatnonzero(np.abs(table["x2_mm"]) < 1e-9)
    order = nodes[np.argsort(table[axis][nodes])]
    return {key: values[order] for key, values in table.items()}
