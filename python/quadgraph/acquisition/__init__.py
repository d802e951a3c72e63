"""What a body is made of, from photographs of it: coefficients that make the engine's pictures agree with them."""
