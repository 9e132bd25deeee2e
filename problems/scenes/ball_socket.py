"""Meshes of the ball and the socket of the example scene, by Gmsh's Python package: python ball_socket.py BODY SIZE FILE.

BODY is "ball" or "socket", SIZE the length of edges on the contact face in mm; edges grow to three times that away from it.
The bodies are quarters, x1 >= 0 and x2 >= 0; they touch at (0, 0, 12).
"""

import sys

import gmsh

RADIUS, SOCKET = 12.0, 12.05  # of the ball and of the socket
STEM, SIDE, RIM, TOP = 6.0, 16.0, 6.0, 22.0  # length of the stem; half width, lower and upper end of the socket


def quarter(occ, shape):
    """The quarter of a shape."""
    box = occ.addBox(0, 0, -50, 50, 50, 100)
    occ.intersect([(3, shape)], [(3, box)])


def ball(occ):
    """Half a ball on a stem."""
    sphere = occ.addSphere(0, 0, 0, RADIUS)
    upper = occ.intersect([(3, sphere)], [(3, occ.addBox(-50, -50, 0, 100, 100, 50))])[0][0][1]
    stem = occ.addCylinder(0, 0, -STEM, 0, 0, STEM, RADIUS)
    quarter(occ, occ.fuse([(3, upper)], [(3, stem)])[0][0][1])


def socket(occ):
    """A block with a spherical recess."""
    block = occ.addBox(-SIDE, -SIDE, RIM, 2 * SIDE, 2 * SIDE, TOP - RIM)
    recess = occ.addSphere(0, 0, RADIUS - SOCKET, SOCKET)
    quarter(occ, occ.cut([(3, block)], [(3, recess)])[0][0][1])


def name_of(body, tag):
    """The physical surface of a face by its kind and the box around it."""
    low, high = (gmsh.model.getBoundingBox(2, tag)[k : k + 3] for k in (0, 3))
    if gmsh.model.getType(2, tag) == "Sphere":
        return "cap" if body == "ball" else "seat"
    if high[0] < 1e-3:
        return "side1"
    if high[1] < 1e-3:
        return "side2"
    if body == "ball":
        return "base" if high[2] < 1e-3 - STEM else "free"
    return "top" if low[2] > TOP - 1e-3 else "free"


def main(body, size, file):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    {"ball": ball, "socket": socket}[body](gmsh.model.occ)
    gmsh.model.occ.synchronize()
    faces = {}
    for _, tag in gmsh.model.getEntities(2):
        faces.setdefault(name_of(body, tag), []).append(tag)
    for name, tags in faces.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.model.addPhysicalGroup(3, [gmsh.model.getEntities(3)[0][1]], name=body)
    field = gmsh.model.mesh.field
    distance = field.add("Distance")
    field.setNumbers(distance, "SurfacesList", faces["cap" if body == "ball" else "seat"])
    threshold = field.add("Threshold")
    for key, value in {"InField": distance, "SizeMin": size, "SizeMax": 3 * size, "DistMin": 0, "DistMax": 10}.items():
        field.setNumber(threshold, key, value)
    field.setAsBackgroundMesh(threshold)
    for option in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.model.mesh.optimize("HighOrder")
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.write(file)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3])
