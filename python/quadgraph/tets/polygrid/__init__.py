"""Polygrids (Wang et al. 2008): grids of regular connectivity and irregular shape that fill a body."""
