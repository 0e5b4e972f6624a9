"""The record resolved: moves in machine coordinates, with a clock."""
