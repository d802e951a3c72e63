"""What mesh files say of colour: textures, colours at vertices and of parts, and volumes of glTF."""
