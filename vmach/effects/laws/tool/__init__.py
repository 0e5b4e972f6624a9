"""Laws of tools: size, wear, bending, slipping, chipping."""
