"""Solves a scene of one body of tetrahedra on a rigid cylinder by another program, and compares the two results.

    contact3d SCENE.toml evaluate --out STATE
    OMP_NUM_THREADS=1 python3 problems/tests/compare_programs.py SCENE.toml STATE --work FOLDER --program calculix [--case NAME]

STATE is the folder of the command above. FOLDER receives input deck and results. Needs numpy and meshio, and `ccx` (Debian:
calculix-ccx) or GetFEM (Debian: python3-getfem). Prints one line per quantity: this project, the other program, difference.

All programs get the same nodes, cells, material, supports and nodal forces. CalculiX has contact by penalties at integration
points (face to face) with a layer of C3D20 elements that do not move; GetFEM has contact stresses that are linear on
the facets, by an augmented Lagrangian in integral form, with the distance to the obstacle itself.

Contact forces along the axes are sums over all nodes here, and integrals of the contact stress there. What is compared node
by node are forces ∫Bᵀσ less the load of the other program. Those of nodes in the middles of edges are shared between the two
ends, so that the force at a corner is ∫p φ with its linear hat function φ, as in this project; pressures are forces over the
same areas. Components that supports hold are left out of what is compared node by node, in both programs: the forces there
contain those of the support.
"""

import argparse
import os
import subprocess
import time
import tomllib
from pathlib import Path

import meshio
import numpy as np

# Local numbers of the nodes of the faces S1 to S4 of C3D10: three corners, then the middles of their edges.
FACES = [(0, 1, 2, 4, 5, 6), (0, 3, 1, 7, 8, 4), (1, 3, 2, 8, 9, 5), (2, 3, 0, 9, 7, 6)]
COMPONENTS = {"u1": 1, "u2": 2, "u3": 3}


def read_scene(path, name):
    """The scene with the changes of one load case, and the offset of the obstacle."""
    scene = tomllib.loads(Path(path).read_text())
    cases = {case["name"]: (case, f"shape_case_{number}") for number, case in enumerate(scene.get("case", []), 1)}
    case, files = cases[name] if cases else ({}, "shape")
    return scene, scene["body"][0] | case.get("body", [{}])[0], np.array(case.get("offset", [0.0] * 3)), files


def read_mesh(path):
    mesh = meshio.read(path)
    cells = np.vstack([block.data for block in mesh.cells if block.type == "tetra10"])
    number = np.full(len(mesh.points), -1)
    used = np.unique(cells)
    number[used] = np.arange(len(used))
    groups = mesh.cell_data["gmsh:physical"]
    faces = {}
    for name, (tag, dimension) in mesh.field_data.items():
        if dimension == 2:
            facets = [block.data[group == tag] for block, group in zip(mesh.cells, groups) if block.type == "triangle6"]
            faces[name] = number[np.vstack(facets)]
    return mesh.points[used], number[cells], faces


def triangle(points, places):
    """Values of the six shape functions and areas per area of the reference triangle, of all facets at its `places`."""
    x, y = places[:, 0], places[:, 1]
    z = 1 - x - y
    values = np.stack([z * (2 * z - 1), x * (2 * x - 1), y * (2 * y - 1), 4 * z * x, 4 * x * y, 4 * y * z], axis=1)
    zero = 0 * x
    by_x = np.stack([1 - 4 * z, 4 * x - 1, zero, 4 * (z - x), 4 * y, -4 * y], axis=1)
    by_y = np.stack([1 - 4 * z, zero, 4 * y - 1, -4 * x, 4 * x, 4 * (z - y)], axis=1)
    normals = np.cross(np.einsum("qn,fni->fqi", by_x, points), np.einsum("qn,fni->fqi", by_y, points))
    return values, np.linalg.norm(normals, axis=2)


# Six points on the triangle, exact for polynomials of degree 4.
A, B = 0.445948490915965, 0.091576213509771
PLACES = np.array([(A, A), (1 - 2 * A, A), (A, 1 - 2 * A), (B, B), (1 - 2 * B, B), (B, 1 - 2 * B)])
WEIGHTS = np.repeat([0.223381589678011 / 2, 0.109951743655322 / 2], 3)


def nodal_forces(points, faces, loads):
    """Consistent nodal forces of tractions, and of forces and moments as tractions that are linear in the position."""
    forces = np.zeros_like(points)
    for load in loads:
        facets = faces[load["face"]]
        values, areas = triangle(points[facets], PLACES)
        if "traction" in load:
            field = areas[:, :, None] * np.array(load["traction"])
        else:
            at = np.einsum("qn,fni->fqi", values, points[facets])
            weights = WEIGHTS * areas
            centre = np.einsum("fq,fqi->i", weights, at) / weights.sum()
            away = at - centre
            second = np.einsum("fq,fqi,fqj->ij", weights, away, away)
            total = np.array(load["force"])
            moment = np.array(load.get("moment", [0.0] * 3)) + np.cross(np.array(load.get("point", centre)) - centre, total)
            turn = np.linalg.solve(np.trace(second) * np.eye(3) - second, moment)
            field = areas[:, :, None] * (total / weights.sum() + np.cross(turn, away))
        np.add.at(forces, facets, np.einsum("q,qn,fqi->fni", WEIGHTS, values, field))
    return forces


def places_of(cells, faces):
    """The cell, and the number of the face of this cell, of every facet."""
    place = {}
    for face, nodes in enumerate(FACES):
        for cell, corners in enumerate(np.sort(cells[:, nodes[:3]])):
            place[tuple(corners)] = cell, face
    return {name: [place[tuple(np.sort(nodes[:3]))] for nodes in facets] for name, facets in faces.items()}


def seat(cylinder, offset, points, facet):
    """A layer of hexahedra of second order (C3D20) behind the cylinder, over the box around `points`: nodes, cells."""
    centre, axis, radius = np.array(cylinder["point"]) + offset, np.array(cylinder["axis"]), cylinder["radius"]
    axis /= np.linalg.norm(axis)
    sign = 1 if cylinder.get("side") == "inside" else -1
    away = points - centre
    away -= np.outer(away @ axis, axis)
    first = away.mean(axis=0)
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    local = np.stack([np.arctan2(away @ second, away @ first), (points - centre) @ axis], axis=1)
    low, high = local.min(axis=0), local.max(axis=0)
    low, high = low - 0.05 * (high - low), high + 0.05 * (high - low)
    counts = np.ceil((high - low) * [radius, 1] / facet).astype(int)
    along = [np.linspace(low[i], high[i], 2 * counts[i] + 1) for i in (0, 1)]
    angle, height, depth = np.meshgrid(*along, np.linspace(0, facet, 3), indexing="ij")
    r = (radius + sign * depth)[..., None]
    nodes = centre + r * np.cos(angle)[..., None] * first + r * np.sin(angle)[..., None] * second + height[..., None] * axis
    nodes, index = nodes.reshape(-1, 3), np.arange(angle.size).reshape(angle.shape)
    # C3D20: corners at depth 0, corners behind, middles of edges at depth 0, behind, and between.
    corners, middles = [(0, 0), (2, 0), (2, 2), (0, 2)], [(1, 0), (2, 1), (1, 2), (0, 1)]
    if sign < 0:
        corners, middles = [corners[i] for i in (0, 3, 2, 1)], middles[::-1]
    layers = [(corners, 0), (corners, 2), (middles, 0), (middles, 2), (corners, 1)]
    order = [(*place, z) for places, z in layers for place in places]
    cells = [[index[2 * i + p, 2 * j + q, z] for p, q, z in order] for i in range(counts[0]) for j in range(counts[1])]
    used, cells = np.unique(cells, return_inverse=True)
    return nodes[used], cells.reshape(-1, 20)


def lines(numbers, per_line):
    """A list of numbers on several lines, each of which but the last ends with a comma."""
    words = [str(number) for number in numbers]
    parts = [", ".join(words[i : i + per_line]) for i in range(0, len(words), per_line)]
    return [part + "," for part in parts[:-1]] + parts[-1:]


def write_deck(path, arguments, scene, body, points, cells, faces, places, forces, rigid):
    material, contact = body["material"], scene["contact"][0]["slave"]["face"]
    count = len(points)
    deck = ["*NODE, NSET=BODY"]
    deck += [f"{i + 1}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(points)]
    deck += ["*NODE, NSET=SEAT"]
    deck += [f"{count + i + 1}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(rigid[0])]
    deck += ["*ELEMENT, TYPE=C3D10, ELSET=BODY"]
    deck += [line for i, cell in enumerate(cells) for line in lines([i + 1, *(cell + 1)], 16)]
    deck += ["*ELEMENT, TYPE=C3D20, ELSET=SEAT"]
    deck += [line for i, cell in enumerate(rigid[1]) for line in lines([len(cells) + i + 1, *(count + cell + 1)], 11)]
    deck += ["*SURFACE, NAME=FOOT, TYPE=ELEMENT"]
    deck += [f"{cell + 1}, S{face + 1}" for cell, face in places[contact]]
    deck += ["*SURFACE, NAME=BED, TYPE=ELEMENT"]
    deck += [f"{len(cells) + i + 1}, S1" for i in range(len(rigid[1]))]
    deck += ["*MATERIAL, NAME=PART", "*ELASTIC", f"{material['young_modulus']}, {material['poisson_ratio']}"]
    deck += ["*SOLID SECTION, ELSET=BODY, MATERIAL=PART", "*SOLID SECTION, ELSET=SEAT, MATERIAL=PART"]
    stiffness = arguments.stiffness * material["young_modulus"]
    deck += ["*SURFACE INTERACTION, NAME=LAW", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:.6e}"]
    if scene["friction"] > 0:
        deck += ["*FRICTION", f"{scene['friction']}, {0.1 * stiffness:.6e}"]
    deck += ["*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE", "FOOT, BED"]
    deck += ["*BOUNDARY", "SEAT, 1, 3"]
    for support in body["supports"]:
        for node in np.unique(faces[support["face"]]):
            deck += [f"{node + 1}, {COMPONENTS[part]}, {COMPONENTS[part]}" for part in support["held"]]
    # One increment: friction then depends on the final displacements alone, as in this project.
    deck += ["*STEP, INC=200", "*STATIC, DIRECT", "1., 1."]
    deck += ["*CLOAD"]
    deck += [f"{node + 1}, {part + 1}, {forces[node, part]:.12e}" for node, part in zip(*np.nonzero(forces))]
    deck += ["*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S", "*CONTACT PRINT", "CSTR", "*CONTACT PRINT, SLAVE=FOOT, MASTER=BED", "CF", "*END STEP", ""]
    path.write_text("\n".join(deck))


def measured(pid, clock):
    """Waits for a process: its seconds, processor seconds and peak memory in MB."""
    _, status, used = os.wait4(pid, 0)
    if status:
        raise SystemExit("the other program has failed")
    return time.time() - clock, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def solve_by_calculix(arguments, scene, body, offset, points, cells, faces, places, forces):
    """Displacements, stresses at the integration points, what was used, the contact force, and the largest pressure at a point."""
    deck = Path(arguments.work) / "deck.inp"
    rigid = seat(scene["contact"][0]["obstacle"], offset, points[np.unique(faces[scene["contact"][0]["slave"]["face"]])], arguments.facet)
    write_deck(deck, arguments, scene, body, points, cells, faces, places, forces, rigid)
    clock = time.time()
    with open(deck.with_suffix(".log"), "w") as log:
        used = measured(subprocess.Popen(["ccx", "-i", deck.stem], cwd=deck.parent, stdout=log, stderr=log).pid, clock)
    # Columns of the file: step, increment, attempt, iterations.
    rows = [line.split() for line in deck.with_suffix(".sta").read_text().splitlines()]
    iterations = sum(int(row[3]) for row in rows if row[0].isdigit())
    read = tables(deck.with_suffix(".dat"))
    stresses = read("stresses")[:, 2:].reshape(len(cells), 4, 6)
    force = read("total surface force")[0, :3]
    return read("displacements")[:, 1:], stresses, (*used, iterations), force, read("contact stress")[:, -3].max()


def solve_by_getfem(arguments, scene, body, offset, points, cells, faces, places, forces):
    """The same by GetFEM, in a process of its own."""
    file, clock = Path(arguments.work) / "displacements.npz", time.time()
    pid = os.fork()
    if pid == 0:
        solved = run_getfem(scene, body, offset, points, cells, places, forces)
        np.savez(file, **solved)
        os._exit(0)
    used = measured(pid, clock)
    solved = np.load(file)
    moved = solved["moved"]
    gradient = np.einsum("cqni,cnj->cqij", slopes_of(points, cells)[0], moved[cells])
    strain = (gradient + np.swapaxes(gradient, 2, 3)) / 2
    young, poisson = body["material"]["young_modulus"], body["material"]["poisson_ratio"]
    trace = np.trace(strain, axis1=2, axis2=3)[:, :, None, None] * np.eye(3)
    tensor = young / (1 + poisson) * (strain + poisson / (1 - 2 * poisson) * trace)
    stresses = np.stack([tensor[:, :, i, j] for i, j in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]], axis=2)
    return moved, stresses, (*used, int(solved["iterations"])), solved["force"], float(solved["peak"])


def run_getfem(scene, body, offset, points, cells, places, forces):
    import getfem

    mesh, kind = getfem.Mesh("empty", 3), getfem.GeoTrans("GT_PK(3,2)")
    for cell in cells:
        mesh.add_convex(kind, points[cell[[0, 4, 1, 6, 5, 2, 7, 8, 9, 3]]].T)
    # Faces of GetFEM: 0 lies opposite to the first corner, then x = 0, y = 0, z = 0.
    regions = {}
    for number, (name, pairs) in enumerate(places.items(), 1):
        regions[name] = number
        mesh.set_region(number, np.array([(cell, (3, 2, 0, 1)[face]) for cell, face in pairs]).T)
    foot = regions[scene["contact"][0]["slave"]["face"]]

    def field(degree, components):
        made = getfem.MeshFem(mesh, components)
        made.set_fem(getfem.Fem(f"FEM_PK(3,{degree})"))
        return made

    displacements, distances = field(2, 3), field(3, 1)
    index = {tuple(point.round(9)): number for number, point in enumerate(points)}
    nodes = np.array([index[tuple(place.round(9))] for place in displacements.basic_dof_nodes()[:, ::3].T])
    # Four integration points for the stiffness, as in the other programs.
    rule, finer = (getfem.MeshIm(mesh, getfem.Integ(f"IM_TETRAHEDRON({degree})")) for degree in (2, 5))
    young, poisson = body["material"]["young_modulus"], body["material"]["poisson_ratio"]
    model = getfem.Model("real")
    model.add_fem_variable("u", displacements)
    model.add_initialized_data("lambda", [young * poisson / (1 + poisson) / (1 - 2 * poisson)])
    model.add_initialized_data("mu", [young / 2 / (1 + poisson)])
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "lambda", "mu")
    model.add_explicit_rhs("u", forces[nodes].ravel())
    for support in body["supports"]:
        # The held faces of these scenes lie across the axis that they hold.
        model.add_normal_Dirichlet_condition_with_multipliers(finer, "u", 2, regions[support["face"]])
    obstacle = scene["contact"][0]["obstacle"]
    axis, away = np.array(obstacle["axis"]), distances.basic_dof_nodes().T - np.array(obstacle["point"]) - offset
    away -= np.outer(away @ axis, axis) / (axis @ axis)
    model.add_initialized_fem_data("distance", distances, np.linalg.norm(away, axis=1) - obstacle["radius"])
    model.add_filtered_fem_variable("stress", field(1, 3), foot)
    model.add_initialized_data("r", [1e5])
    model.add_initialized_data("friction", [scene["friction"]])
    model.add_integral_contact_with_rigid_obstacle_brick(finer, "u", "stress", "distance", "r", "friction", foot, 1)
    # The body begins a little inside the obstacle: nothing else holds it.
    start = np.zeros((len(nodes), 3))
    start[:, 2] = -0.01
    model.set_variable("u", start.ravel())
    iterations, converged = model.solve("max_iter", 100, "max_res", 1e-9, "lsolver", "mumps", "lsearch", "simplest")[:2]
    assert converged
    moved = np.zeros_like(points)
    moved[nodes] = model.variable("u").reshape(-1, 3)
    peak = np.linalg.norm(model.variable("stress").reshape(-1, 3), axis=1).max()
    force = [getfem.asm_generic(finer, 0, f"stress({part})", foot, model) for part in (1, 2, 3)]
    return {"moved": moved, "iterations": iterations, "peak": peak, "force": force}


def tables(path):
    """The tables of a .dat file by the begin of their headings; of those that are printed several times, the last."""
    found, rows = {}, []
    for line in path.read_text().splitlines():
        words = line.split()
        try:
            row = [float(word) for word in words]
        except ValueError:
            rows = found[" ".join(words)] = []
            continue
        if row:
            rows.append(row)
    return lambda begin: np.array(next(rows for heading, rows in reversed(found.items()) if heading.startswith(begin)))


# The integration points of C3D10 in the order of CalculiX.
C, D = 0.138196601125011, 0.585410196624968
INNER = np.array([(C, C, C), (D, C, C), (C, D, C), (C, C, D)])


def slopes_of(points, cells):
    """Gradients of the shape functions at the four integration points of every cell, and determinants of the map."""
    x, y, z = INNER.T
    w, zero = 1 - x - y - z, 0 * x
    by = [
        [1 - 4 * w, 4 * x - 1, zero, zero, 4 * (w - x), 4 * y, -4 * y, -4 * z, 4 * z, zero],
        [1 - 4 * w, zero, 4 * y - 1, zero, -4 * x, 4 * x, 4 * (w - y), -4 * z, zero, 4 * z],
        [1 - 4 * w, zero, zero, 4 * z - 1, -4 * x, zero, -4 * y, 4 * (w - z), 4 * x, 4 * y],
    ]
    slopes = np.stack([np.stack(rows, axis=1) for rows in by], axis=2)
    jacobian = np.einsum("qnj,cni->cqij", slopes, points[cells])
    return np.einsum("qnj,cqji->cqni", slopes, np.linalg.inv(jacobian)), np.linalg.det(jacobian)


def inner_forces(points, cells, stresses):
    """∫Bᵀσ per node, from σ (xx, yy, zz, xy, xz, yz) at the four integration points of every cell."""
    slopes, determinants = slopes_of(points, cells)
    tensor = stresses[:, :, [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
    forces = np.zeros_like(points)
    np.add.at(forces, cells, np.einsum("cq,cqni,cqij->cnj", determinants / 24, slopes, tensor))
    return forces


def von_mises(s):
    """From σ in any order that begins with xx, yy, zz."""
    xx, yy, zz = s[..., 0], s[..., 1], s[..., 2]
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (s[..., 3:] ** 2).sum(axis=-1))


def at_corners(forces, facets):
    """Forces of middle nodes shared between the ends of their edges."""
    shared, done = forces.copy(), set()
    for nodes in facets:
        for middle, ends in zip(nodes[3:], [nodes[[0, 1]], nodes[[1, 2]], nodes[[2, 0]]]):
            if middle not in done:
                shared[ends] += forces[middle] / 2
                done.add(middle)
    return shared


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("state")
    parser.add_argument("--work", required=True)
    parser.add_argument("--program", choices=["calculix", "getfem"], required=True)
    parser.add_argument("--case")
    parser.add_argument("--stiffness", type=float, default=50.0, help="CalculiX: contact stiffness over Young's modulus, 1/mm")
    parser.add_argument("--facet", type=float, default=4.0, help="CalculiX: edge length of the seat, mm")
    arguments = parser.parse_args()
    scene, body, offset, files = read_scene(arguments.scene, arguments.case)
    points, cells, faces = read_mesh(Path(arguments.scene).parent / body["mesh"])
    places = places_of(cells, faces)
    forces = nodal_forces(points, faces, body["loads"])
    facets = faces[scene["contact"][0]["slave"]["face"]]
    Path(arguments.work).mkdir(parents=True, exist_ok=True)
    solve = {"calculix": solve_by_calculix, "getfem": solve_by_getfem}[arguments.program]
    moved, stresses, used, force, peak = solve(arguments, scene, body, offset, points, cells, faces, places, forces)
    print(f"{len(points)} nodes, {len(cells)} cells, load {forces.sum(axis=0).round(3) + 0.0} N")
    print("{}: {:.1f} s, {:.1f} s of processor time, {:.0f} MB, {} iterations".format(arguments.program, *used))

    # Contact forces upon the body, and along held components those of supports as well.
    at_nodes = inner_forces(points, cells, stresses) - forces
    compared = np.ones_like(points)
    for support in body["supports"]:
        for part in support["held"]:
            compared[np.unique(faces[support["face"]]), COMPONENTS[part] - 1] = 0
    free = compared.all(axis=1)
    free[np.unique(facets)] = False
    rest = abs(at_nodes[free]).max() / abs(at_nodes * compared).max()
    print(f"largest force on a node without contact and support: {rest:.1e} of the largest one")
    ours = meshio.read(Path(arguments.state) / "vtk" / f"{files}_bodies.vtu")
    contact = meshio.read(Path(arguments.state) / "vtk" / f"{files}_contact.vtu")
    assert abs(ours.points - points).max() < 1e-9
    index = {tuple(point): number for number, point in enumerate(points)}
    corners = np.array([index[tuple(point)] for point in contact.points])
    data = contact.point_data
    area, normal, own = data["area"].ravel(), data["normal"], data["pressure"].ravel()
    total = -((own[:, None] * normal + data["traction"]) * area[:, None]).sum(axis=0)
    compared = compared[corners]
    theirs = at_corners(at_nodes, facets)[corners] * compared
    pressure = -np.einsum("ni,ni->n", theirs, normal) / area
    slides, along = -data["traction"] * area[:, None] * compared, theirs + (pressure * area)[:, None] * normal

    def line(name, one, two, unit):
        print(f"{name:42} {one:12.6g} {two:12.6g} {unit:4} {100 * (two / one - 1):+8.2f} %")

    def field(name, one, two, weight):
        far = np.sqrt((weight * ((two - one).T ** 2)).sum() / (weight * (one.T**2)).sum())
        print(f"{name:42} {'':12} {'':12} {'':4} {100 * far:8.2f} %")

    line("normal force, sum of lengths at nodes", (own * area).sum(), (pressure * area).sum(), "N")
    for part in range(3):
        line(f"contact force along x{part + 1}, all nodes", total[part], force[part], "N")
    line("friction at nodes, sum of lengths", np.linalg.norm(slides, axis=1).sum(), np.linalg.norm(along, axis=1).sum(), "N")
    line("peak pressure, force over area of a corner", own.max(), pressure.max(), "MPa")
    print(f"{'its own peak of the contact stress':42} {'':12} {peak:12.6g} MPa")
    field("pressures, relative L2 difference", own, pressure, area)
    field("friction, relative L2 difference", slides / area[:, None], along / area[:, None], area)
    centres = ours.cell_data["von_mises"][0].ravel(), von_mises(stresses.mean(axis=1))
    line("largest von Mises stress, centre of a cell", centres[0].max(), centres[1].max(), "MPa")
    field("von Mises stresses, relative L2 difference", *centres, 1.0)
    shift = ours.point_data["displacement"]
    at = np.argmax(np.linalg.norm(shift, axis=1))
    line("largest displacement", np.linalg.norm(shift[at]), np.linalg.norm(moved[at]), "mm")


main()
