"""The path of the tool: split, with its circumstances and the histories behind it."""
