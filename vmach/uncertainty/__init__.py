"""How well a prediction is known: first order (GUM), and Monte Carlo (JCGM 101)."""
