"""The exact engine: edges of the material along surface normals."""
