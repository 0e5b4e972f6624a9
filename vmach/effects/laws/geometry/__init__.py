"""Laws of geometry: guides, scales, right angles, weight."""
