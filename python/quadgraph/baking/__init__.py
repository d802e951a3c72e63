"""From a mesh file to a .qgraph file."""
