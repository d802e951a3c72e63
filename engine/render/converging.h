// A picture that converges: solve after solve, each by samples of its own, joins the mean of all, until the error that
// is stated of the picture, model and noise included, is what was asked for.
//
// What is left after the sweeps and the noise of their samples are worked down; what mesh, light and view rays leave is
// not, and where that is all there is to win it ends.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "engine/render/engine.h"
#include "engine/render/picture/convergence.h"
#include "engine/render/picture/picture_noise.h"

namespace quadgraph {

// What a picture is made of, and what is known of it before.
struct ConvergingStart {
  View view{};
  RenderOptions render{};  // with the error that is asked for
  SolveOptions solve{};    // of a solve that is corrected at rest
  SolveReport report{};    // of that
  ErrorEstimate error{};   // of its picture
};

class Converging {
 public:
  // The engine shows what the start is of. It must outlive this, and solve and draw nothing else meanwhile.
  Converging(Engine& engine, const ConvergingStart& start);

  // A solve if one is due, then a frame of the picture. Where `check`, which is called during a solve, throws, that
  // solve is lost and the next call begins it again. Throws as Engine::solve.
  void advance(const std::function<void()>& check = {});

  // Whether all is won that can be, or another solve would not end in time.
  bool ended() const { return found_.reached || !found_.limit.empty(); }

  const Convergence& found() const { return found_; }

  // The mean of the solves so far, on the engine's device; null before the first frame.
  const PictureBuffers* shown() const { return shown_; }

  // The same read back, with its standard error, after a whole solve at least; and what it was made with.
  Picture picture() const;
  const Metadata& metadata() const { return metadata_; }

 private:
  void judge();
  bool sweep_more(double left);
  double picture_error_of(const ErrorEstimate& exitance) const;
  ErrorEstimate light_left() const;
  std::string limit(double whole) const;
  bool out_of_time() const;

  Engine& engine_;
  View view_;
  RenderOptions render_;
  SolveOptions solve_;
  Convergence found_;
  PictureNoise noise_;
  Metadata metadata_;
  std::chrono::steady_clock::time_point began_;
  std::uint32_t frames_;                 // of each solve
  std::uint32_t first_seed_;             // of the start
  std::uint32_t made_ = 0, solves_ = 0;  // all, and those in the mean
  std::uint32_t drawn_ = 0;              // frames of the solve that is being drawn
  bool solved_ = false;
  double change_before_;  // of the last sweep, when sweeps were added last
  const PictureBuffers* shown_ = nullptr;
};

// Engine::render where an error is asked for. told: after each step. Throws InputError where the error is not known.
Picture converged(Engine& engine, const ConvergingStart& start, Picture first,
                  const std::function<void(const ConvergenceStep&)>& told);

}  // namespace quadgraph
