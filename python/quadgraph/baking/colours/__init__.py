"""The colours of a mesh file as coefficients in the body that was baked of it."""
