// Errors of the exitance by parts of the surface.
#pragma once

namespace quadgraph {

// Relative RMS error of the exitance, weighted by area, channels together; after a correction of its means over patches
// of the surface.
struct ErrorEstimate {
  double whole = 0;    // over the whole surface
  double unlit = 0;    // over the faces with less than a tenth of the mean q; 0 if there are none
  double dimmest = 0;  // over the third of the surface with the least exitance; 0 where that cannot be told
};

// f of each part of the estimates.
template <typename F, typename... Estimates>
ErrorEstimate by_parts(F f, const Estimates&... estimates) {
  return {f(estimates.whole...), f(estimates.unlit...), f(estimates.dimmest...)};
}

}  // namespace quadgraph
