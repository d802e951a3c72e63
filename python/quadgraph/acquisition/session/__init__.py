"""From photographs of a body on a board, or with cameras of another program, to a capture."""
