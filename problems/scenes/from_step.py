"""From a STEP file to a mesh for contact3d, by Gmsh's Python package.

python from_step.py part.step
    lists the solids and the faces of the file: number, kind, area, radius, centre.

python from_step.py part.step part.msh --size 3 --contact seat --face seat=4,7 --face stop=2
    makes tetrahedra of second order with edges of about 3 mm. The faces 4 and 7 get the name "seat", face 2 the name "stop";
    scenes ask for faces by these names. Edges are finer on the faces named with --contact: an eighth of the smallest radius of
    curvature there, or --contact-size, and at least a quarter of --size.

Lengths of the file are converted to mm. Of a file with several solids, --solid NUMBER takes one.
"""

import argparse
import sys

import gmsh

EDGES_PER_RADIUS = 8
FINEST = 0.25  # smallest edge on contact faces that follows from their curvature, over --size
GROWTH = 5.0  # number of --size over which the edges of contact faces grow to it
DEFAULT_SIZE = 1 / 20  # edge over the diagonal of the part


class Refused(Exception):
    """What is wrong with the arguments or the file, in words."""


def parsed(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("step", help="STEP file")
    parser.add_argument("mesh", nargs="?", help="MSH file to write; without it, the faces are listed")
    parser.add_argument("--face", action="append", default=[], metavar="NAME=NUMBERS", help="name of faces, such as seat=4,7")
    parser.add_argument("--contact", action="append", default=[], metavar="NAME", help="named faces with finer edges")
    parser.add_argument("--size", type=float, help="length of edges, mm [default: a twentieth of the diagonal of the part]")
    parser.add_argument("--contact-size", type=float, help="length of edges on contact faces, mm")
    parser.add_argument("--solid", type=int, help="number of the solid, of several")
    found = parser.parse_args(arguments)
    for name in ("size", "contact_size"):
        value = getattr(found, name)
        if value is not None and not 0 < value < float("inf"):
            raise Refused(f"--{name.replace('_', '-')} {value}: allowed are finite numbers > 0")
    if found.mesh is None and (found.face or found.contact):
        raise Refused("--face and --contact are for the mesh: name its file after the STEP file")
    return found


def faces_of(solid):
    """The numbers of the faces of a solid, ascending."""
    return sorted({abs(tag) for _, tag in gmsh.model.getBoundary([(3, solid)], oriented=False)})


def solid_of(wanted):
    """The solid to be meshed."""
    solids = [tag for _, tag in gmsh.model.getEntities(3)]
    if not solids:
        raise Refused("the file has no solid: Gmsh meshes closed bodies only")
    if wanted is None and len(solids) > 1:
        raise Refused(f"the file has the solids {', '.join(map(str, solids))}: take one with --solid NUMBER")
    if wanted is not None and wanted not in solids:
        raise Refused(f"--solid {wanted}: the file has {', '.join(map(str, solids))}")
    return wanted or solids[0]


def smallest_radius(face):
    """The smallest radius of curvature on a grid of points of a face, mm; infinite for a plane."""
    if gmsh.model.getType(2, face) == "Plane":
        return float("inf")
    low, high = gmsh.model.getParametrizationBounds(2, face)
    at = [0.1, 0.3, 0.5, 0.7, 0.9]
    points = [low[axis] + share * (high[axis] - low[axis]) for u in at for v in at for axis, share in ((0, u), (1, v))]
    largest, smallest, *_ = gmsh.model.getPrincipalCurvatures(face, points)
    curvature = max(abs(value) for value in [*largest, *smallest])
    return 1 / curvature if curvature > 0 else float("inf")


def list_faces():
    """Prints the solids and their faces."""
    for _, solid in gmsh.model.getEntities(3):
        print(f"solid {solid}: volume {gmsh.model.occ.getMass(3, solid):.6g} mm3")
        print(f"{'face':>5}  {'kind':<16} {'area, mm2':>11} {'radius, mm':>11}   centre, mm")
        for face in faces_of(solid):
            kind, area = gmsh.model.getType(2, face), gmsh.model.occ.getMass(2, face)
            radius = smallest_radius(face)
            shown = f"{radius:.5g}" if radius < float("inf") else "-"
            centre = ", ".join(f"{x:.5g}" for x in gmsh.model.occ.getCenterOfMass(2, face))
            print(f"{face:>5}  {kind:<16} {area:>11.5g} {shown:>11}   ({centre})")


def named(options, known):
    """The numbers of the faces of every name."""
    names, owner = {}, {}
    for option in options:
        name, _, numbers = option.partition("=")
        try:
            faces = [int(number) for number in numbers.split(",")]
        except ValueError:
            raise Refused(f"--face {option}: allowed is NAME=NUMBER,NUMBER,..., such as seat=4,7") from None
        if not name or name == "body":
            raise Refused(f'--face {option}: a name is asked for, other than "body", which is that of the volume')
        for face in faces:
            if face not in known:
                raise Refused(f"--face {option}: there is no face {face}; the solid has {', '.join(map(str, known))}")
            if owner.setdefault(face, name) != name:
                raise Refused(f'--face {option}: face {face} is in "{owner[face]}" already')
        names.setdefault(name, []).extend(faces)
    return names


def refine(faces, fine, size):
    """Edges that grow from contact faces to the rest of the part."""
    field = gmsh.model.mesh.field
    near, growing = field.add("Distance"), field.add("Threshold")
    field.setNumbers(near, "SurfacesList", faces)
    for key, value in [("InField", near), ("SizeMin", fine), ("SizeMax", size), ("DistMin", 0), ("DistMax", GROWTH * size)]:
        field.setNumber(growing, key, value)
    field.setAsBackgroundMesh(growing)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)


def make_mesh(found):
    """Writes the mesh of a solid with its names."""
    solid = solid_of(found.solid)
    known = faces_of(solid)
    names = named(found.face, known)
    for name in found.contact:
        if name not in names:
            raise Refused(f"--contact {name}: no --face has this name")
    low, high = gmsh.model.getBoundingBox(3, solid)[:3], gmsh.model.getBoundingBox(3, solid)[3:]
    size = found.size or DEFAULT_SIZE * sum((b - a) ** 2 for a, b in zip(low, high)) ** 0.5
    contact = [face for name in found.contact for face in names[name]]
    radius = min(map(smallest_radius, contact), default=float("inf"))
    fine = found.contact_size or min(size, max(FINEST * size, radius / EDGES_PER_RADIUS))
    gmsh.option.setNumber("Mesh.MeshSizeMax", max(size, fine))
    if contact:
        refine(contact, fine, size)
    others = [(3, tag) for _, tag in gmsh.model.getEntities(3) if tag != solid]
    gmsh.model.occ.remove(others, recursive=True)
    gmsh.model.occ.synchronize()
    for name, faces in names.items():
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.addPhysicalGroup(3, [solid], name="body")
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.optimize("Relocate3D")
    gmsh.model.mesh.setOrder(2)
    gmsh.model.mesh.optimize("HighOrderElastic")
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(found.mesh)
    unnamed = [face for face in known if all(face not in faces for faces in names.values())]
    print(f"{found.mesh}: {len(gmsh.model.mesh.getNodes()[0])} nodes, edges of {size:.3g} mm", end="")
    print(f", {fine:.3g} mm on contact faces" if contact else "")
    print(f"faces without a name: {', '.join(map(str, unnamed)) or 'none'}")


def main(arguments):
    found = parsed(arguments)
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.model.occ.importShapes(found.step)
        gmsh.model.occ.synchronize()
        if found.mesh is None:
            list_faces()
        else:
            make_mesh(found)
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except Refused as reason:
        sys.exit(f"error: {reason}")
    except Exception as reason:  # Gmsh raises plain exceptions.
        sys.exit(f"error: Gmsh: {reason}")
