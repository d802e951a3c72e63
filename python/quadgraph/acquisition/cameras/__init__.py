"""Lenses and poses of cameras, and the files of other programs that hold them."""
