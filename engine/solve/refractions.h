// The surface of each body of a file, by its index of refraction and its coat, as passes read it.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "engine/device/memory.h"
#include "engine/optics/boundary.h"
#include "shaders/shared/refraction.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// What the surfaces do to the fields inside, by body: for the host, and gpu::Boundary on the device.
struct BodyBoundaries {
  std::vector<Boundary> of_body;
  std::uint64_t on_device = 0;  // address

  // Sp3Head::bodies: the bits that tell the bodies apart; 0 where all have one boundary.
  std::uint32_t bits() const;
  // The least k11 of any body.
  double least_k11() const;
};

class Refractions {
 public:
  // `bodies`, at least 1: of the file; all of index 1 at first.
  Refractions(device::Device& device, std::uint32_t bodies);
  Refractions(const Refractions&) = delete;
  Refractions& operator=(const Refractions&) = delete;

  // One index for all bodies, or one for each; false: as it was. Throws InputError on another number of them, and as
  // check_eta; then all stays as it was.
  bool set(std::span<const float> eta);

  // The same of finishes; surfaces that nothing is said of are bare and smooth. Throws InputError on another number of
  // them.
  bool set_finishes(std::span<const Finish> finishes);

  std::vector<float> eta() const;                                         // by body
  std::span<const OpticalSurface> surfaces() const { return surfaces_; }  // the same
  // gpu::Refraction by body; where it lies does not change.
  const device::Buffer& on_device() const { return on_device_; }
  // The words before the kinds of faces (shaders/shared/refraction.h).
  std::vector<std::uint32_t> head(std::uint32_t faces) const;

  // boundary_of by body, found at first use; valid until the surfaces change.
  const BodyBoundaries& boundaries(Method method, Source source, Model model);

 private:
  bool take(std::vector<OpticalSurface> wanted);
  void write();
  std::size_t first_of(Method method, Source source, Model model) const;

  device::Device& device_;
  std::vector<OpticalSurface> surfaces_;
  device::Buffer on_device_;
  device::Buffer reflectances_;  // and boundaries, for each surface that differs from those before
  // By body, of each method, source and model, which keep their places: what a solve takes of memory does not hang on
  // the solves before it.
  std::vector<gpu::Boundary> boundaries_on_host_;
  device::Buffer boundaries_on_device_;
  std::map<std::tuple<Method, Source, Model>, BodyBoundaries> boundaries_;
};

// The different ones among surfaces, each once, in the order in which they come first: the pictures of what enters of
// an environment are in this order (gpu::Refraction::entering).
std::vector<OpticalSurface> different_surfaces(std::span<const OpticalSurface> surfaces);

}  // namespace quadgraph
