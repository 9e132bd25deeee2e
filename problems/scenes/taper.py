"""Meshes of the head-neck taper of the example scene, by Gmsh's Python package: python taper.py stem|head SIZE AROUND FILE.

SIZE is the length of edges along the axis in mm. AROUND is the even number of cells around the sector of 30 degrees. It
must be the same for both bodies: flat facets of two different numbers would leave gaps of micrometres between two cones.
"""

import math
import sys

import gmsh

SECTOR = math.radians(30.0)
# Heights in mm: base of the stem, mouth of the head, tip of the stem, bottom of the bore, top of the head.
BASE, MOUTH, TIP, BOTTOM, TOP = 0.0, 3.0, 17.0, 20.0, 24.0
# The stem has a cone angle of 5 degrees 40 minutes, the bore one of 5 degrees 44 minutes; they meet at the tip.
STEM_SLOPE, BORE_SLOPE = (math.tan(math.radians((5 + minutes / 60) / 2)) for minutes in (40, 44))
STEM_RADIUS, BALL_RADIUS, BALL_HEIGHT = 7.0, 16.0, 11.0


def in_stem(radius, height):
    """Radius of a place of the reference sector, where the stem has the radius 1."""
    return radius * (STEM_RADIUS - STEM_SLOPE * height)


def in_head(radius, height):
    """Radius of a place of the reference sector, where the bore has the radius 1 and the ball the radius 2."""
    bore = in_stem(1, TIP) + BORE_SLOPE * (TIP - height)
    ball = math.sqrt(BALL_RADIUS**2 - (height - BALL_HEIGHT) ** 2)
    return radius * bore if radius <= 1 else bore + (radius - 1) ** 1.5 * (ball - bore)


def sector(height, around, rings):
    """Plane surfaces of the reference sector: a core, then rings (outer radius, cells) of two halves each."""
    geo = gmsh.model.geo

    def row(radius):
        turns = (0.0, SECTOR / 2, SECTOR)
        return [geo.addPoint(radius * math.cos(turn), radius * math.sin(turn), height) for turn in turns]

    def surface(curves, corners):
        tag = geo.addPlaneSurface([geo.addCurveLoop(curves, reorient=True)])
        geo.mesh.setTransfiniteSurface(tag, cornerTags=corners)
        geo.mesh.setRecombine(2, tag)
        return (2, tag)

    def divided(curves, cells):
        for curve in curves:
            geo.mesh.setTransfiniteCurve(curve, cells + 1)
        return curves

    axis, points = geo.addPoint(0, 0, height), row(0.6)
    spokes = divided([geo.addLine(axis, points[i]) for i in (0, 2)], around // 2)
    arcs = divided([geo.addLine(points[i], points[i + 1]) for i in (0, 1)], around // 2)
    core, surfaces = surface([spokes[0], *arcs, spokes[1]], [axis, *points]), []
    for radius, cells in rings:
        outer = row(radius)
        spokes = divided([geo.addLine(points[i], outer[i]) for i in range(3)], cells)
        curved = divided([geo.addCircleArc(outer[i], axis, outer[i + 1]) for i in (0, 1)], around // 2)
        for i in (0, 1):
            corners = [points[i], outer[i], outer[i + 1], points[i + 1]]
            surfaces.append(surface([spokes[i], curved[i], spokes[i + 1], arcs[i]], corners))
        points, arcs = outer, curved
    return [core, *surfaces]


def layer(surfaces, height, size):
    """Extrudes surfaces by a height; returns those at the upper end, and the volumes."""
    made = gmsh.model.geo.extrude(surfaces, 0, 0, height, numElements=[round(height / size)], recombine=True)
    at = [i for i, (dimension, _) in enumerate(made) if dimension == 3]
    return [made[i - 1] for i in at], [made[i][1] for i in at]


def name_of(tag, levels, contact):
    """The physical surface of a face of the reference sector, by its nodes."""
    places = gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)[1].reshape(-1, 3)
    radii, turns = [math.hypot(x, y) for x, y, _ in places], [math.atan2(y, x) for x, y, _ in places if abs(x) > 1e-9]
    heights = [z for _, _, z in places]
    if max(heights) - min(heights) < 1e-9:
        return levels.get(round(heights[0]), "free")
    if max(turns) < 1e-9:
        return "side1"
    if min(turns) > SECTOR - 1e-9:
        return "side2"
    return contact if max(radii) < 1 + 1e-9 and min(heights) > MOUTH - 1e-9 else "free"


def main(part, size, around, file):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    if part == "stem":
        surfaces = sector(BASE, around, [(1.0, around // 2)])
        surfaces, below = layer(surfaces, MOUTH - BASE, 2 * size)
        _, inside = layer(surfaces, TIP - MOUTH, size)
        volumes, levels, contact, radius_of = below + inside, {round(BASE): "base"}, "taper", in_stem
    else:
        # Below the bottom of the bore, only the outer ring belongs to the head.
        surfaces = sector(MOUTH, around, [(1.0, around // 2), (2.0, around)])
        surfaces, beside = layer(surfaces, BOTTOM - MOUTH, size)
        _, above = layer(surfaces, TOP - BOTTOM, 2 * size)
        volumes, levels, contact, radius_of = beside[3:] + above, {round(TOP): "top"}, "bore", in_head
    gmsh.model.geo.synchronize()
    gmsh.model.mesh.generate(3)
    faces = {}
    for _, tag in gmsh.model.getBoundary([(3, tag) for tag in volumes], oriented=False):
        faces.setdefault(name_of(tag, levels, contact), []).append(tag)
    for name in sorted(faces):
        gmsh.model.addPhysicalGroup(2, faces[name], name=name)
    gmsh.model.addPhysicalGroup(3, volumes, name="body")
    tags, places, _ = gmsh.model.mesh.getNodes()
    for tag, (x, y, z) in zip(tags, places.reshape(-1, 3)):
        radius = math.hypot(x, y)
        scale = radius_of(radius, z) / radius if radius > 1e-9 else 0.0
        gmsh.model.mesh.setNode(tag, [scale * x, scale * y, z], [])
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(file)
    gmsh.finalize()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4])
