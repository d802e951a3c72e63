"""What mesh files say of looks: normals and their textures; colours of textures, vertices and parts, media of glTF."""
