"""Meshes of the lug of the example scenes, by Gmsh's Python package: python lug.py hex8|tet10 SIZE LAYERS FILE.

SIZE is the length of edges across the profile in mm. LAYERS is the number of layers of hexahedra along x2; tetrahedra take
edges of SIZE everywhere. The lug is 40 mm x 30 mm x 40 mm, with a nose of radius 60 mm below and a hole of radius 8 mm.
"""

import sys

import gmsh

WIDTH, DEPTH, HEIGHT, NOSE, HOLE, MIDDLE = 40.0, 30.0, 40.0, 60.0, 8.0, 24.0


def profile(occ):
    """The profile in the plane x2 = 0: box, cut by the circle of the nose, with the hole."""
    half = WIDTH / 2
    rise = NOSE - (NOSE**2 - half**2) ** 0.5
    corners = [occ.addPoint(x, 0, z) for x, z in [(-half, rise), (half, rise), (half, HEIGHT), (-half, HEIGHT)]]
    middle, bottom = occ.addPoint(0, 0, NOSE), occ.addPoint(0, 0, 0)
    arcs = [occ.addCircleArc(corners[0], middle, bottom), occ.addCircleArc(bottom, middle, corners[1])]
    lines = [occ.addLine(corners[i], corners[(i + 1) % 4]) for i in (1, 2, 3)]
    outer = occ.addCurveLoop(arcs + lines)
    hole = occ.addCircle(0, 0, MIDDLE, HOLE, zAxis=[0, 1, 0])
    return occ.addPlaneSurface([outer, occ.addCurveLoop([hole])])


def name_of(box):
    """The physical surface of a face by the box around it."""
    x, z = (box[0], box[3]), (box[2], box[5])
    if max(x) - min(x) < 1e-3:
        return "wall" if x[0] < 0 else "side"
    if max(z) - min(z) < 1e-3:
        return "top"
    if box[4] - box[1] < 1e-3:
        return "side"
    return "nose" if z[0] < MIDDLE - HOLE - 1e-3 else "hole"


def main(kind, size, layers, file):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    occ, hexahedra = gmsh.model.occ, kind == "hex8"
    surface = profile(occ)
    occ.synchronize()
    if hexahedra:
        gmsh.option.setNumber("Mesh.Algorithm", 8)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 3)
        gmsh.model.mesh.setRecombine(2, surface)
        occ.extrude([(2, surface)], 0, DEPTH, 0, [layers], recombine=True)
    else:
        occ.extrude([(2, surface)], 0, DEPTH, 0)
    occ.synchronize()
    faces = {}
    for _, tag in gmsh.model.getEntities(2):
        faces.setdefault(name_of(gmsh.model.getBoundingBox(2, tag)), []).append(tag)
    for name in ["nose", "wall", "top", "hole", "side"]:
        gmsh.model.addPhysicalGroup(2, faces[name], name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
    gmsh.model.mesh.generate(3)
    if not hexahedra:
        gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(file)
    print(file, len(gmsh.model.mesh.getNodes()[0]), "nodes")
    gmsh.finalize()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4])
