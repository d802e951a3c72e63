"""What is most probably wrong with a capture."""
