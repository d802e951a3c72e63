"""Lamps and projectors from photographs of the board: where they are, which way they shine, and how strongly."""
