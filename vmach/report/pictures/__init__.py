"""Pictures of the part: colours, camera, meshes to show."""
