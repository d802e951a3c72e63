// Where the levels of a body lie: as in the file, as their vertices were set, or as deformers move them on the device.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/listener.h"
#include "engine/deform/moved_levels.h"
#include "engine/solve/deformed_levels.h"

namespace quadgraph {

class BodyShape {
 public:
  // `graph` must stay alive.
  BodyShape(const QuadGraph& graph, const Listener& listener);

  // The levels as in the file or as set; what deformers do to them is on the device alone.
  const std::vector<Level>& levels() const { return moved_.levels(); }

  // What is known of the present shape: samples of a level, the mean chord, mm, the edges inside a level as inside_edge
  // tells but where they are stretched, and SolveReport::deformed.
  const std::vector<SurfaceSample>& samples(std::uint32_t number) const { return samples_[number]; }
  double chord() const { return chord_; }
  double edge(std::uint32_t number) const { return edge_shares_[number] * chord_; }
  const std::string& spoilt() const { return spoilt_; }

  // Level 0 in its present shape; valid until the next motion.
  const Level& present(device::Device& device, const LevelBuffers& finest);

  // Whether vertices were set since the last put_back.
  bool set() const { return set_; }

  // Moves the vertices of a level, as MovedLevels::move.
  void move(std::uint32_t number, std::span<const glm::vec3> positions);

  // All vertices and nodes as in the file, here and on the device.
  void put_back(device::Device& device, std::vector<LevelBuffers>& levels);

  // Whether the body already is as this list makes it.
  bool is(std::span<const Deformer> list) const;

  // Records what a list of deformers does to all levels, and returns how much of the shape that changes.
  ShapeChange record(Workspace& work, std::span<const Deformer> list, const RestBox& box,
                     std::vector<LevelBuffers>& levels);

  // What came of level `number` of a record that has run; its samples are taken out of it.
  ShapeState measured(std::uint32_t number);

  // Nodes of a level that has got its buffer of them since it was deformed.
  void record_nodes(Workspace& work, std::uint32_t number, const LevelBuffers& level);

 private:
  void sample();

  MovedLevels moved_;
  DeformedLevels deformed_;
  std::optional<MovedLevels> present_;  // of level 0 where the device has moved it, made at first use
  bool set_ = false;
  std::string spoilt_;
  std::vector<std::vector<SurfaceSample>> samples_;
  double chord_ = 0;
  std::vector<double> edge_shares_;  // of the levels' edges inside in the chord of the body at rest
};

}  // namespace quadgraph
