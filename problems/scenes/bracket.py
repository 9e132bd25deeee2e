"""Meshes of the bracket of the example scene, by Gmsh's Python package: python bracket.py SIZE FILE.

SIZE is the length of edges on the seat in mm; edges grow to twice that at the eye. The bracket sits on a shaft whose surface
passes through the origin, along x1. The mesh is the half x2 >= 0.
"""

import math
import sys

import gmsh

LENGTH, WIDTH, TOP = 80.0, 70.0, 22.0  # foot
SHAFT, CLEARANCE = 60.0, 1.0  # radius of the shaft; that of the seat is larger by the clearance
EYE, RING, HEIGHT, THICKNESS = 16.0, 32.0, 56.0, 32.0  # lug: radius of the eye, radius around it, height, thickness
FILLET = 6.0


def bracket(occ):
    """Foot and lug, joined by a fillet, less the shaft and the eye, whose lower half is a face of its own."""
    half = THICKNESS / 2
    foot = occ.addBox(-LENGTH / 2, 0, -SHAFT / 2, LENGTH, WIDTH / 2, TOP + SHAFT / 2)
    plate = occ.addBox(-RING, 0, 0, 2 * RING, half, HEIGHT)
    ring = occ.addCylinder(0, 0, HEIGHT, 0, half, 0, RING)
    body = occ.fuse([(3, foot)], [(3, plate), (3, ring)])[0][0][1]
    occ.synchronize()
    box = [-RING - 1, -1, TOP - 1, RING + 1, half + 1, TOP + 1]
    edges = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=1)]
    body = occ.fillet([body], edges, [FILLET])[0][1]
    tools = [(3, occ.addCylinder(-LENGTH, 0, -SHAFT - CLEARANCE, 2 * LENGTH, 0, 0, SHAFT + CLEARANCE))]
    for turn in (math.pi / 2, -math.pi / 2):
        pin = (3, occ.addCylinder(0, 0, HEIGHT, 0, half, 0, EYE, angle=math.pi))
        occ.rotate([pin], 0, 0, HEIGHT, 0, 1, 0, turn)
        tools.append(pin)
    occ.cut([(3, body)], tools)
    occ.synchronize()


def name_of(tag):
    """The physical surface of a face by the box around it."""
    x0, x1 = -LENGTH / 2, LENGTH / 2
    box = gmsh.model.getBoundingBox(2, tag)
    low, high = box[:3], box[3:]
    if high[1] < 1e-3:
        return "symmetry"
    if high[0] < x0 + 1e-3:
        return "stop"
    if high[2] < 1e-3 and low[0] < x0 + 1e-3 and high[0] > x1 - 1e-3:
        return "seat"
    if low[0] > -EYE - 1e-3 and high[0] < EYE + 1e-3 and high[2] < HEIGHT + 1e-3:
        return "eye"
    return "free"


def main(size, file):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    bracket(gmsh.model.occ)
    faces = {}
    for _, tag in gmsh.model.getEntities(2):
        faces.setdefault(name_of(tag), []).append(tag)
    for name in ["seat", "eye", "stop", "symmetry", "free"]:
        gmsh.model.addPhysicalGroup(2, faces[name], name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
    field = gmsh.model.mesh.field
    near = field.add("Distance")
    field.setNumbers(near, "SurfacesList", faces["seat"])
    growing = field.add("Threshold")
    for key, value in [("InField", near), ("SizeMin", size), ("SizeMax", 2 * size), ("DistMin", 0), ("DistMax", TOP)]:
        field.setNumber(growing, key, value)
    field.setAsBackgroundMesh(growing)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.optimize("Relocate3D")
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(file)
    print(file, len(gmsh.model.mesh.getNodes()[0]), "nodes")
    gmsh.finalize()


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2])
