"""Meshes of other programs, as meshio reads them, for contact scenes."""

import numpy as np

#: Cells of a scene by meshio's names, with their nodes in Gmsh's order and the corners of their faces.
_CELLS = {
    "tetra": (list(range(4)), [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]),
    "tetra10": ([0, 1, 2, 3, 4, 5, 6, 7, 9, 8], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]),
    "hexahedron": (
        list(range(8)),
        [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    ),
}
#: Cells on the skin of a body, with their number of corners.
_FACETS = {"triangle": 3, "triangle6": 3, "quad": 4}


def from_meshio(mesh, faces=None):
    """Nodes, cells and named faces of a mesh that meshio has read, for `Scene.from_mesh`.

    ``meshio.read`` reads files of Abaqus and CalculiX (.inp), Nastran (.bdf, .fem), VTK and others. Names come from

    - sets of nodes: all facets of the skin whose corners are in the set;
    - sets and physical groups of triangles and quadrilaterals;
    - ``faces``: functions of the centres of the facets of the skin.

    Sets that hold no facet of the skin, such as sets of solid elements, are no faces, and are left out.

    Parameters
    ----------
    mesh : meshio.Mesh
        A mesh of tetrahedra of 4 or 10 nodes or of hexahedra of 8 nodes, all of one kind. Nodes without a cell are left out.
    faces : dict of str to callable, optional
        Further faces: a function takes the centres of the facets, (k, 3), and returns which of them belong to the face, (k,) of bool.

    Returns
    -------
    tuple
        ``(nodes, cells, faces)``: the first arguments of `Scene.from_mesh`.

    Raises
    ------
    ValueError
        For cells of other kinds, of several kinds, or none, and for a face of ``faces`` without facets.

    Examples
    --------
    >>> import meshio
    >>> corners = [[x, y, z] for z in (0.0, 10.0) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
    >>> mesh = meshio.Mesh(corners, [("hexahedron", [range(8)])], point_sets={"HEAD": [4, 5, 6, 7]})
    >>> nodes, cells, faces = from_meshio(mesh, {"foot": lambda centres: centres[:, 2] < 1e-6})
    >>> {name: facets.tolist() for name, facets in faces.items()}
    {'HEAD': [[4, 5, 6, 7]], 'foot': [[0, 3, 2, 1]]}
    """
    solid = [block for block in mesh.cells if block.type in _CELLS and len(block.data)]
    kinds = sorted({block.type for block in solid})
    other = sorted({block.type for block in mesh.cells if block.dim == 3 and block.type not in _CELLS})
    if len(kinds) != 1 or other:
        raise ValueError(f"mesh.cells has solids of the kinds {kinds + other}: allowed is one of {sorted(_CELLS)}")
    order, corners = _CELLS[kinds[0]]
    cells = np.concatenate([np.asarray(block.data)[:, order] for block in solid])
    skin = _skin(cells, corners)
    points = np.asarray(mesh.points, dtype=float)
    found = {name: skin[np.isin(skin, np.asarray(nodes)).all(axis=1)] for name, nodes in _node_sets(mesh).items()}
    for name, facets in _facet_sets(mesh).items():
        wanted = {tuple(sorted(facet)) for facet in facets.tolist()}
        own = skin[[tuple(sorted(facet)) in wanted for facet in skin.tolist()]]
        found[name] = np.concatenate([found[name], own]) if name in found else own
    found = {name: np.unique(facets, axis=0) for name, facets in found.items() if len(facets)}
    for name, belongs in (faces or {}).items():
        found[name] = skin[np.asarray(belongs(points[skin].mean(axis=1)), dtype=bool)]
        if not len(found[name]):
            raise ValueError(f"faces[{name!r}] holds no facet of the skin")
    used, numbers = np.unique(cells, return_inverse=True)
    renumber = lambda old: np.searchsorted(used, old)
    return points[used], numbers.reshape(cells.shape), {name: renumber(facets) for name, facets in found.items()}


def _skin(cells, corners):
    """The faces that one cell alone has, by their corners."""
    facets = np.concatenate([cells[:, list(face)] for face in corners])
    _, index, counts = np.unique(np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True)
    return facets[np.sort(index[counts == 1])]


def _node_sets(mesh):
    return {str(name): nodes for name, nodes in mesh.point_sets.items() if len(nodes)}


def _facet_sets(mesh):
    """Corners of the triangles and quadrilaterals of every set and physical group."""
    sets = {}
    for name, blocks in mesh.cell_sets.items():
        if not str(name).startswith("gmsh:"):
            for block, members in zip(mesh.cells, blocks):
                if block.type in _FACETS and members is not None and len(members):
                    _add(sets, str(name), np.asarray(block.data)[np.asarray(members, dtype=int), : _FACETS[block.type]])
    for name, (tag, dimension) in mesh.field_data.items():
        if dimension == 2 and "gmsh:physical" in mesh.cell_data:
            for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
                if block.type in _FACETS and (tags == tag).any():
                    _add(sets, str(name), np.asarray(block.data)[tags == tag, : _FACETS[block.type]])
    return sets


def _add(sets, name, facets):
    sets[name] = np.concatenate([sets[name], facets]) if name in sets else facets
