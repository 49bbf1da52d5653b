"""Results known from elsewhere, and the claims that the provers are measured on."""
