"""What the engine predicts for the photographs of a capture, and which pixels count by how much."""
