"""Laws of heat: spindle, screws, columns, the shop."""
