"""What a block makes the machine do: frames, lines, arcs, cycles, cutter compensation."""
