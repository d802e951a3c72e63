// Whether a solution has the error that was asked for, and how far the light that it leaves unaccounted for tells that
// it has not.
#pragma once

#include <optional>
#include <string>

#include "engine/reference/solution.h"

namespace quadgraph {

// Share of an error that is asked for which is left to the algebraic one.
inline constexpr double algebraic_share = 0.25;

// Share of the light that scattered which a solution neither lets out nor absorbs, as a relative RMS error of the
// exitance: an error that is the same everywhere, which looks at the surface are slow to see where cycles are slow to
// remove it, is just that. energy: of all light; collided: of what scattered, as the surface and the volume have it.
double unbalanced(const Energy& energy, const Energy& collided);

// With `confidence` (engine/solve/mesh_error.h).
bool certain(const ErrorEstimate& estimate, double wanted);

// In words, of an error that is not certain; no estimate: of a file that has none.
std::string missed(const std::optional<ErrorEstimate>& estimate, double wanted);

// Says of a report anew whether an error that was wanted, 0 if none was, is missed.
void state_missed(SolveReport& report, double wanted);

// In words, of a stated error above 5%: the largest of its parts, and what makes it smaller; empty below.
std::string advice(const SolveReport& report);

// Both, of a report whose stated error has changed.
void state_anew(SolveReport& report, double wanted);

// In words, of a level that did not converge.
std::string stopped(const LevelReport& level);

}  // namespace quadgraph
