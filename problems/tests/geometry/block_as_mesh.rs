//! A block as a Gmsh file is the block.
