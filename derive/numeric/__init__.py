"""Numbers: plants, Riccati equations, the spectrum integral, gain optimisation."""
