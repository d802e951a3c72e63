// The noise of a picture that is the mean of several, each by samples of its own: known of each pixel from how far they
// are apart.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/render/picture/picture.h"

namespace quadgraph {

class PictureNoise {
 public:
  // The mean of one, of two, of three ... pictures, in this order.
  void add(const Picture& mean);

  // RGB per pixel: of the sum of the layers; empty of a single picture, of which it is not known.
  std::vector<float> standard_error() const;

  // Of scattered light, channels together, relative RMS over the pixels that the body covers wholly; 0 where it is not
  // known.
  double relative() const;

 private:
  // Squares of deviations from the mean, added up from mean to mean (Welford 1962).
  struct Sums {
    std::vector<double> mean, squares;
    void add(std::vector<double> next, std::uint32_t count);
  };

  double variance(const Sums& sums, std::size_t i) const;

  std::uint32_t count_ = 0;
  Sums radiance_;   // per value
  Sums scattered_;  // per pixel, channels together
  std::vector<bool> covered_;
};

}  // namespace quadgraph
