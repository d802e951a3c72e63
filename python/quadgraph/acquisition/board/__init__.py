"""The printed board: what it is, how it is drawn, found in photographs, and what it says of cameras."""
