"""What may be said of how well a volume's coefficients are known."""

# Members of a material's .npz, each of the shape of its coefficient: standard deviations of logarithms, and lengths
# over which a coefficient is one number, mm. As the engine has them (engine/optics/certainty.h), which a test holds.
CERTAINTY = ("sigma_s_prime_deviation", "sigma_a_deviation", "sigma_s_prime_resolution", "sigma_a_resolution")
