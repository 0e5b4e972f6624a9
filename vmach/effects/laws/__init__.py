"""The effects of vmach, one law a file, in rooms by where they come from."""
