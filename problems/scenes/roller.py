"""Meshes of roller.toml, by Gmsh's Python package: python roller.py roller|raceway FINENESS FILE [C].

FINENESS is a factor on the numbers of cells along all axes; 1 makes the meshes in this folder. C in mm makes a roller with the
logarithmic crown C ln(1/(1 - (2 x1/l)^2)); without it, the roller is a cylinder.

The roller has its axis along x1 and touches the raceway at x3 = 0. Both are cut by the plane of symmetry x2 = 0. The roller is
cut through its axis as well, and held there by a carrier that is wider than the roller.
"""

import math
import sys

import gmsh

RADIUS, LENGTH, WIDTH, CARRIER, LEDGE = 10.0, 20.0, 8.0, 4.0, 4.0
RACEWAY, DEPTH = 26.0, 10.0
# Cells are smallest at the ends of the roller, in a strip that is wider than the contact, and at the contact faces.
END, STRIP, LAYER = 0.12, 0.5, 0.08


def growing(first, length, cells):
    """Places from 0 to length of cells of which each is wider than the one before by the same factor."""
    low, high = 1.0, 10.0
    for _ in range(60):
        factor = (low + high) / 2
        low, high = (factor, high) if first * sum(factor**n for n in range(cells)) < length else (low, factor)
    return [first * sum(low**n for n in range(cell)) for cell in range(cells)] + [length]


def places(kind, fineness):
    """Places along x1 and x2, and distances from the contact face. The grids of the two faces do not match."""
    inner, beyond, strip, side, layers = (13, 0, 7, 6, 9) if kind == "roller" else (11, 5, 6, 5, 8)
    inner, beyond, strip, side, layers = (round(fineness * cells) for cells in (inner, beyond, strip, side, layers))
    half = [LENGTH / 2 - x for x in growing(END / fineness, LENGTH / 2, inner)]
    if beyond:
        half += [LENGTH / 2 + x for x in growing(END / fineness, (RACEWAY - LENGTH) / 2, beyond)[1:]]
    x1 = sorted(half + [-x for x in half if x > 0])
    x2 = [STRIP * n / strip for n in range(strip)] + [STRIP + x for x in growing(STRIP / strip, WIDTH - STRIP, side)]
    return x1, x2, growing(LAYER / fineness, RADIUS if kind == "roller" else DEPTH, layers)


def crown(x1, c):
    """The logarithmic crown, cut off 1 µm before its poles at the ends."""
    return c * math.log(1 / (1 - (2 * min(abs(x1), LENGTH / 2 - 0.001) / LENGTH) ** 2))


def unit_cells(kind, n1, n2, n3):
    """Boxes of cells of length 1, and the faces; returns the names of both."""
    occ, mesh = gmsh.model.occ, gmsh.model.mesh
    if kind == "raceway":
        volumes = {"raceway": [occ.addBox(0, 0, -n3, n1, n2, n3)]}
    else:
        carrier = [occ.addBox(0, 0, n3, n1, n2, 1), occ.addBox(0, n2, n3, n1, 1, 1)]
        volumes = {"roller": [occ.addBox(0, 0, 0, n1, n2, n3)], "carrier": carrier}
    occ.fragment([(3, tag) for tags in volumes.values() for tag in tags], [])
    occ.synchronize()
    for _, tag in gmsh.model.getEntities(1):
        mesh.setTransfiniteCurve(tag, round(occ.getMass(1, tag)) + 1)
    for _, tag in gmsh.model.getEntities(2):
        mesh.setTransfiniteSurface(tag)
        mesh.setRecombine(2, tag)
    for _, tag in gmsh.model.getEntities(3):
        mesh.setTransfiniteVolume(tag)
    faces = {}
    for _, tag in gmsh.model.getEntities(2):
        _, y, z, _, y_max, z_max = (round(x) for x in gmsh.model.getBoundingBox(2, tag))
        if y_max == 0:
            faces.setdefault("symmetry", []).append(tag)
        elif z_max == 0:
            faces["rolling" if kind == "roller" else "track"] = [tag]
        elif z_max == -n3:
            faces["bottom"] = [tag]
        elif z == n3 + 1:
            faces.setdefault("top", []).append(tag)
        elif z_max == n3 and y == n2 and y_max > n2:
            faces["ledge"] = [tag]
    return volumes, faces


def main(kind, fineness, file, c=0.0):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    x1, x2, distances = places(kind, fineness)
    n2, n3 = len(x2) - 1, len(distances) - 1
    volumes, faces = unit_cells(kind, len(x1) - 1, n2, n3)
    for name, tags in faces.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    for name, tags in volumes.items():
        gmsh.model.addPhysicalGroup(3, tags, name=name)
    gmsh.model.mesh.generate(3)
    nodes, places_of_nodes, _ = gmsh.model.mesh.getNodes()
    for node, (i, j, k) in zip(nodes, places_of_nodes.reshape(-1, 3).round().astype(int)):
        x, y = x1[i], x2[j] if j <= n2 else WIDTH + LEDGE
        if kind == "raceway":
            z = -distances[-k]
        elif j <= n2 and k <= n3:
            bottom = RADIUS - (RADIUS**2 - y**2) ** 0.5 + crown(x, c)
            z = bottom + distances[k] / RADIUS * (RADIUS - bottom)
        else:
            z = RADIUS if k <= n3 else RADIUS + CARRIER
        gmsh.model.mesh.setNode(node, [x, y, z], [])
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(file)
    print(file, len(nodes), "nodes")
    gmsh.finalize()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3], *map(float, sys.argv[4:]))
