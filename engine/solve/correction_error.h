// What is said of a corrected solve.
#pragma once

#include <cstdint>

#include "engine/reference/solution.h"

namespace quadgraph {

// Of what the last sweep has changed the share that all further ones would.
double share_left_by(const CorrectionReport& done);

// The share of a change that leaves the smallest error where the change is known but for so much noise. Nothing is
// known of where the dimmest third begins: what is unlit takes the larger share of both, or of means over patches,
// where these are known. mean_of: as SolveOptions has it.
ErrorEstimate share_taken(const CorrectionReport& done, std::uint32_t mean_of);

// What means over patches say goes into the report, and the share that is taken: all of it where so many sweeps were
// asked for.
void take_patches(CorrectionReport& done, const CorrectedPatches& patches, const SolveOptions& options);

// What the exitance is off by after all sweeps, by part: of the model, the noise and what another sweep would change;
// of the mesh and of the solver what the sweeps leave, which sample where the solve is off, whatever the reason; and
// all of it together. Calibrated on bodies that nobody tuned for (docs/accuracy.md). unresolved: what sweeps lose in
// elements as deep as those at the surface, a relative error; mean_of: as SolveOptions has it.
void state_corrected_error(SolveReport& report, double unresolved, std::uint32_t mean_of);

// Of the model's error what more sweeps would take away, and the noise of a mean of so many solves.
ErrorEstimate left_by_sweeps(const CorrectionReport& done);
ErrorEstimate noise_of(const CorrectionReport& done, std::uint32_t mean_of);

}  // namespace quadgraph
