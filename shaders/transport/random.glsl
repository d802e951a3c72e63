// Random numbers from integers alone, alike on every device.
#ifndef QUADGRAPH_RANDOM_GLSL
#define QUADGRAPH_RANDOM_GLSL

// PCG-RXS-M-XS of 32 bits (Jarzynski and Olano 2020).
uint hash(uint x) {
  uint state = x * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// Uniform in [0, 1), and the next state.
float uniform_number(inout uint state) {
  state = state * 747796405u + 2891336453u;
  return float(hash(state) >> 8u) * exp2(-24.0);
}

#endif
