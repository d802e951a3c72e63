// What is known of an answer's error before it is solved for: from the depth of the elements at the surface, in mean
// free paths, and from the thickness of the body. Differences of levels cannot tell it where all of them are too coarse
// alike.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/listener.h"
#include "engine/base/solve_options.h"
#include "engine/file/graph.h"
#include "engine/optics/model.h"
#include "shaders/shared/shared.h"

namespace quadgraph {

// An outside face that stands for its neighbours.
struct SurfaceSample {
  double depth = 0;        // mm, height of its tet over it
  double area = 0;         // mm^2
  std::uint32_t tet = 0;   // behind it
  std::uint32_t body = 0;  // of that
};

// Every so many'th face of a level is a sample, from the first one on; reflecting ones are left out.
std::uint32_t surface_sample_step(const Level& level);

// Up to 256 open faces of a level in its present shape, evenly drawn from all of them.
std::vector<SurfaceSample> surface_samples(const Level& level);

// Mean chord of a level's body, mm: four times its volume over its open surface.
double mean_chord(const Level& level);

struct Resolution {
  double error = 0;      // relative RMS error of the exitance over the lit surface, all channels together
  double corrected = 0;  // the same after sweeps of the transport equation
  double decay = 0;      // largest of any channel, mean over the surface
  double slow = 0;       // 0 to 1, the same: how slowly sweeps settle
};

// Resolution of linear elements with the buried source. `optical`: one entry per sample; eta: one per body.
Resolution resolution_of(std::span<const SurfaceSample> samples, std::span<const gpu::Optical> optical,
                         std::span<const float> eta, Model model);

// Edges of the tets of a level that are not at its surface, mm: root of the mean square by volume, each that of the
// regular tet of its volume; 0 where all are at the surface.
double inside_edge(const Level& level, const Listener& listener = {});

// What is to be said, in words, beside the error estimate: of elements that do not resolve the light, at the surface
// and inside (`edge` as inside_edge, in light that falls as in the samples' mean), and of a model where it is not near
// transport; empty if nothing is. chord in mm.
std::string mesh_warning(const Resolution& resolution);
std::string inside_warning(std::span<const gpu::Optical> optical, double edge, double chord);
std::string model_warning(std::span<const gpu::Optical> optical, std::span<const float> eta, double chord,
                          Source source, Model model);

}  // namespace quadgraph
