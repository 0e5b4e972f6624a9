"""Triangle meshes as nominal CAD: reading, checks, faces."""
