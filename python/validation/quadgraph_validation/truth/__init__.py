"""Independent truth to hold the engine against: closed forms, discrete ordinates, random walks, and their meshes."""
