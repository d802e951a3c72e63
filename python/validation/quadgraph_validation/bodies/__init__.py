"""Scenes, meshes and shapes that studies use, and what they are made of."""
