#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

// M of the carriers on the surface, `count` from `first` on, in units of the scale.
struct SurfaceChangePush {
  Fields x;
  Vec3s to_phi;
  SurfaceShares share;
  Boundaries boundaries;  // by body
  Vec3s before;
  Scales scale;
  SolveStates state;
  Reduction reduction;
  uint first;
  uint count;
  uint what;         // SURFACE_*
  uint level;        // whose gate opens the check
  uint verify;       // 1: the true residual has the last word
  uint stall_limit;  // looks in a row at which the residual has hardly fallen; 0: any number
  uint max_iterations;
  uint looks;        // from this one on the estimate counts
  uint by_change;    // 1: the rate is that of the changes where it is the larger one
  float least_rate;  // by which a residual is taken to fall from look to look
  float slow_rate;   // at which it has hardly fallen
  uint by_residual;  // 1: the residual has to be below the tolerance, too
  float tolerance;
};
layout(push_constant, scalar) uniform Block { SurfaceChangePush push; };

// A residual counts as falling by 1 - 1e-4 from look to look at least.
const float LARGEST_RATE = 0.9999;
// Measured on bunnies of 30 and 100 mm, six materials, both models: with this the estimate is never half the error.
const float SAFETY = 1.25;

// Below this a residual that does not fall any more is what single precision allows.
const float PRECISION = 1e-5;

vec3 ratio(vec3 part, vec3 whole) {
  return mix(vec3(0), part / whole, greaterThan(whole, vec3(0)));
}

// What is left of a series of changes after the last one, if they fall as the residual does.
vec3 rest(vec3 change, float rate) {
  vec3 rates = vec3(rate);
  if (push.by_change == 1u) rates = max(rates, ratio(change, push.state.at[0].change));
  rates = clamp(rates, vec3(push.least_rate), vec3(LARGEST_RATE));
  return SAFETY * change * rates / (1.0 - rates);
}

void decide(vec3 change) {
  SolveStates state = push.state;
  float rate = state.at[0].looked > 0.0 ? state.at[0].residual / state.at[0].looked : 0.0;
  uint looks = state.at[0].looks + 1u;
  vec3 algebraic = looks < push.looks ? vec3(-1) : rest(change, rate);
  state.at[0].looks = looks;
  state.at[0].looked = state.at[0].residual;
  state.at[0].change = change;
  state.at[0].algebraic = algebraic;
  state.at[0].slow = rate > push.slow_rate ? state.at[0].slow + 1u : 0u;
  bool residual_met = push.by_residual == 0u || state.at[0].residual <= max(push.tolerance, 2.0 * SOLVED);
  if (looks >= push.looks && residual_met && all(lessThanEqual(algebraic.xy, vec2(push.tolerance)))) {
    stop(state, SOLVE_CONVERGED, 0u);
    if (push.verify == 1u) {
      state.at[0].check = uvec3(state.at[0].groups[push.level], 1u, 1u);
      state.at[0].status = SOLVE_RUNNING;
    }
  } else if (push.stall_limit > 0u && state.at[0].slow >= push.stall_limit) {
    stop(state, state.at[0].residual < PRECISION ? SOLVE_STAGNATED : SOLVE_STALLED, 0u);
  } else if (state.at[0].iterations >= push.max_iterations) {
    stop(state, SOLVE_EXHAUSTED, 0u);
  }
}

void main() {
  vec3 difference_squares = vec3(0), size_squares = vec3(0);
  Scale unit = push.scale.at[0];
  // One factor for all channels, which are weighed alike.
  vec3 scale = unit.scale / max(unit.scale.x, max(unit.scale.y, unit.scale.z));
  EACH(i, push.count) {
    uint carrier = push.first + i;
    SurfaceShare share = push.share.at[i];
    Field x = scaled(element_or_one(push.to_phi, carrier), push.x.at[carrier]);
    vec3 flux = outward_flux(push.boundaries.at[share.body], x);
    vec3 m = scale * (flux - unit.inverse * share.reflected);
    vec3 change = m - push.before.at[i];
    difference_squares += dot(change, change) * share.area;
    size_squares += dot(m, m) * share.area;
    if (push.what != SURFACE_DIFFERENCE) push.before.at[i] = m;
  }
  if (push.what == SURFACE_STORE) return;
  vec3 differences, sizes;
  if (!reduce_dispatch_pair(push.reduction, difference_squares, size_squares, differences, sizes)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  vec3 relative = sqrt(ratio(differences, sizes));
  if (push.what == SURFACE_DIFFERENCE) {
    push.state.at[0].difference = relative;
  } else {
    decide(relative);
  }
}
