// Derivatives of results by inputs as a matrix by rows, each channel by itself; and how rows are recorded on a tape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace quadgraph {

class SparseRows {
 public:
  std::size_t count() const { return first_.size() - 1; }

  // The row's sum of entries times inputs.
  glm::dvec3 times(std::size_t row, std::span<const glm::dvec3> inputs) const {
    glm::dvec3 sum(0);
    for (std::size_t k = first_[row]; k < first_[row + 1]; ++k) sum += value_[k] * inputs[column_[k]];
    return sum;
  }

  // Adds the row's entries times a weight to what belongs to the inputs.
  void add_transposed(std::size_t row, const glm::dvec3& weight, std::span<glm::dvec3> inputs) const {
    for (std::size_t k = first_[row]; k < first_[row + 1]; ++k) inputs[column_[k]] += value_[k] * weight;
  }

  void add(std::uint32_t column, const glm::dvec3& value) {
    column_.push_back(column);
    value_.push_back(value);
  }
  void end_row() { first_.push_back(column_.size()); }

 private:
  std::vector<std::size_t> first_{0};
  std::vector<std::uint32_t> column_;
  std::vector<glm::dvec3> value_;
};

// One row after the other: the derivatives that a tape brings to the inputs of a result.
class RowRecorder {
 public:
  // `inputs`: how many there are.
  explicit RowRecorder(std::size_t inputs) : value_(inputs, glm::dvec3(0)), touched_(inputs, false) {}

  // Where the derivative of the present row by an input is added up.
  glm::dvec3& at(std::size_t input) {
    if (!touched_[input]) {
      touched_[input] = true;
      columns_.push_back(static_cast<std::uint32_t>(input));
    }
    return value_[input];
  }

  // Moves what has come to `rows`; the next row has the same inputs.
  void end_row(SparseRows& rows) {
    for (const std::uint32_t column : columns_) {
      if (value_[column] != glm::dvec3(0)) rows.add(column, value_[column]);
      value_[column] = glm::dvec3(0);
    }
    rows.end_row();
  }

  // The next row has other inputs.
  void forget() {
    for (const std::uint32_t column : columns_) touched_[column] = false;
    columns_.clear();
  }

 private:
  std::vector<glm::dvec3> value_;
  std::vector<bool> touched_;
  std::vector<std::uint32_t> columns_;
};

// Inputs from `first` on, to be read like an array.
struct RecordedInputs {
  RowRecorder& recorder;
  std::size_t first;

  glm::dvec3& operator[](std::size_t i) const { return recorder.at(first + i); }
};

}  // namespace quadgraph
