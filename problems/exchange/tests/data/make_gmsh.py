"""Makes the meshes of this folder with Gmsh 4.15.2 (pip install gmsh): python make_gmsh.py

two_blocks.msh and two_blocks_binary.msh hold one mesh of two stacked blocks: hex8, several physical groups on one entity, groups without a
name, all elements, parametric coordinates, node tags with holes. box.msh holds tet4 with default options.
"""

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 1)

geo = gmsh.model.geo
points = [geo.addPoint(x, y, 0) for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]]
lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
bottom = geo.addPlaneSurface([geo.addCurveLoop(lines)])
for line in lines:
    geo.mesh.setTransfiniteCurve(line, 3)
geo.mesh.setTransfiniteSurface(bottom)
geo.mesh.setRecombine(2, bottom)
lower = geo.extrude([(2, bottom)], 0, 0, 1, [2], recombine=True)
upper = geo.extrude([lower[0]], 0, 0, 0.5, [1], recombine=True)
geo.synchronize()
middle, top, side = lower[0][1], upper[0][1], lower[2][1]
gmsh.model.addPhysicalGroup(3, [lower[1][1]], 1, "lower")
gmsh.model.addPhysicalGroup(3, [upper[1][1]], 2, "upper")
gmsh.model.addPhysicalGroup(3, [lower[1][1], upper[1][1]], 7, "both blocks")
gmsh.model.addPhysicalGroup(2, [bottom, -middle], 1, "horizontal")
gmsh.model.addPhysicalGroup(2, [middle, top], 30)
gmsh.model.addPhysicalGroup(2, [side], 31, "side")
gmsh.model.addPhysicalGroup(1, lines[:2], 4, "edge")
gmsh.model.addPhysicalGroup(1, lines[3:], 9)
gmsh.model.addPhysicalGroup(0, points[2:], 9)
gmsh.model.mesh.generate(3)
tags = gmsh.model.mesh.getNodes()[0]
gmsh.model.mesh.renumberNodes(tags, [3 * tag + 100 for tag in tags])
gmsh.option.setNumber("Mesh.SaveAll", 1)
gmsh.option.setNumber("Mesh.SaveParametric", 1)
gmsh.write("two_blocks.msh")
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("two_blocks_binary.msh")
gmsh.option.setNumber("Mesh.SaveAll", 0)
gmsh.option.setNumber("Mesh.SaveParametric", 0)
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
gmsh.write("two_blocks_2_binary.msh")
gmsh.option.setNumber("Mesh.Binary", 0)
gmsh.write("two_blocks_2.msh")

gmsh.clear()
gmsh.option.restoreDefaults()
gmsh.option.setNumber("General.Verbosity", 1)
gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(3, [1], 1, "box")
gmsh.model.addPhysicalGroup(2, [1, 2], 2, "ends")
gmsh.option.setNumber("Mesh.MeshSizeMin", 1)
gmsh.model.mesh.generate(3)
gmsh.write("box.msh")
gmsh.write("box_view.msh")
nodes = gmsh.model.mesh.getNodes()[0]
view = gmsh.view.add("height")
gmsh.view.addModelData(view, 0, gmsh.model.getCurrent(), "NodeData", nodes, [[float(node)] for node in nodes])
gmsh.view.write(view, "box_view.msh", append=True)
