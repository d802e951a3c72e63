// What the last workgroup of a solver pass decides.

bvec3 not_finite(vec3 v) {
  return bvec3(isnan(v.x) || isinf(v.x), isnan(v.y) || isinf(v.y), isnan(v.z) || isinf(v.z));
}

// Channels whose residual is still above the tolerance; one without light has none.
bvec3 unconverged(vec3 rz, vec3 norm, float tolerance) {
  return greaterThan(rz, tolerance * tolerance * norm);
}

float worst_residual(vec3 rz, vec3 norm) {
  vec3 ratio = mix(vec3(0), rz / norm, greaterThan(norm, vec3(0)));
  return sqrt(max(ratio.x, max(ratio.y, ratio.z)));
}

uint first_channel(bvec3 flags) {
  return flags.x ? 0u : flags.y ? 1u : 2u;
}

void stop(SolveStates state, uint status, uint channel) {
  state.at[0].iterate = uvec3(0);
  state.at[0].check = uvec3(0);
  state.at[0].status = status;
  state.at[0].channel = channel;
}
