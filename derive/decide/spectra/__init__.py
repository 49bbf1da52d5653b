"""Claims of the frequency domain: integrals of logarithms, determinants, eigenvalues, limits."""
