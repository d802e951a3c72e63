// A number that remembers what it was made of, so that the derivative of one result by all inputs takes one way back
// (reverse mode; Griewank and Walther 2008, chapter 3).
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace quadgraph {

class Tape;

struct Traced {
  static constexpr std::uint32_t constant = UINT32_MAX;

  double value = 0;
  std::uint32_t node = constant;

  Traced() = default;
  explicit Traced(double number) : value(number) {}
  Traced(double at, std::uint32_t number) : value(at), node(number) {}
};

// What numbers of the thread on which it is the active one are made of. A tape is walked back as often as one likes,
// with other weights each time.
class Tape {
 public:
  // The tape that numbers of this thread are recorded on. There must be one.
  static Tape& active() { return *active_; }

  // Makes it the active one as long as it lives.
  class Recording {
   public:
    explicit Recording(Tape& tape) : before_(active_) { active_ = &tape; }
    ~Recording() { active_ = before_; }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

   private:
    Tape* before_;
  };

  void clear() {
    nodes_.clear();
    weights_.clear();
    inputs_.clear();
  }

  // An input; `derivative` gains that of the weighted results by it on every way back.
  Traced input(double value, double& derivative) {
    const Traced number = record(value, Traced(), 0, Traced(), 0);
    inputs_.push_back({number.node, &derivative});
    return number;
  }

  // A number of two others, and its derivatives by them.
  Traced record(double value, const Traced& a, double by_a, const Traced& b, double by_b) {
    nodes_.push_back({a.node, b.node, by_a, by_b});
    return {value, static_cast<std::uint32_t>(nodes_.size() - 1)};
  }

  // Counts a number among the results, with a weight.
  void weigh(const Traced& result, double weight) {
    if (result.node == Traced::constant) return;
    weights_.resize(nodes_.size());
    weights_[result.node] += weight;
  }

  // Brings the weights to the inputs, and takes them from the results.
  void back() {
    weights_.resize(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const Node& node = nodes_[i];
      if (node.a != Traced::constant) weights_[node.a] += node.by_a * weights_[i];
      if (node.b != Traced::constant) weights_[node.b] += node.by_b * weights_[i];
    }
    for (const Input& input : inputs_) *input.derivative += weights_[input.node];
    weights_.clear();
  }

 private:
  struct Node {
    std::uint32_t a, b;
    double by_a, by_b;
  };
  struct Input {
    std::uint32_t node;
    double* derivative;
  };

  static inline thread_local Tape* active_ = nullptr;
  std::vector<Node> nodes_;
  std::vector<double> weights_;
  std::vector<Input> inputs_;
};

inline double value_of(const Traced& a) {
  return a.value;
}

// Of one or two numbers; constants are not recorded.
inline Traced traced(double value, const Traced& a, double by_a, const Traced& b = Traced(), double by_b = 0) {
  if (a.node == Traced::constant && b.node == Traced::constant) return Traced(value);
  return Tape::active().record(value, a, by_a, b, by_b);
}

inline Traced operator-(const Traced& a) {
  return traced(-a.value, a, -1);
}
inline Traced operator+(const Traced& a, const Traced& b) {
  return traced(a.value + b.value, a, 1, b, 1);
}
inline Traced operator+(const Traced& a, double b) {
  return traced(a.value + b, a, 1);
}
inline Traced operator-(const Traced& a, const Traced& b) {
  return traced(a.value - b.value, a, 1, b, -1);
}
inline Traced operator-(double a, const Traced& b) {
  return traced(a - b.value, b, -1);
}
inline Traced operator*(const Traced& a, const Traced& b) {
  return traced(a.value * b.value, a, b.value, b, a.value);
}
inline Traced operator*(const Traced& a, double b) {
  return traced(a.value * b, a, b);
}
inline Traced operator*(double a, const Traced& b) {
  return b * a;
}
inline Traced operator/(const Traced& a, const Traced& b) {
  const double value = a.value / b.value;
  return traced(value, a, 1 / b.value, b, -value / b.value);
}
inline Traced operator/(const Traced& a, double b) {
  return traced(a.value / b, a, 1 / b);
}

inline Traced exp(const Traced& a) {
  const double value = std::exp(a.value);
  return traced(value, a, value);
}
inline Traced expm1(const Traced& a) {
  return traced(std::expm1(a.value), a, std::exp(a.value));
}
inline Traced log(const Traced& a) {
  return traced(std::log(a.value), a, 1 / a.value);
}

// As of engine/reference/exitance.h and block.h.
inline Traced positive(const Traced& a) {
  return a.value > 0 ? a : Traced();
}
inline Traced safe_ratio(const Traced& a, const Traced& b) {
  return b.value > 0 ? a / b : Traced();
}

}  // namespace quadgraph
