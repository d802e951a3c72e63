"""Tetrahedra and the graph of their nodes, with what faces see of each other."""
