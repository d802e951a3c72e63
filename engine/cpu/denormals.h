// Numbers too small for full precision count as zero, as on GPUs: computing with them takes processors many times as
// long, and light that has fallen that far is seen by none.
#pragma once

#include <cstdint>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace quadgraph::cpu {

// On this thread, for as long as it is.
class DenormalsAreZero {
 public:
  DenormalsAreZero() { set(before_ | zeros); }
  ~DenormalsAreZero() { set(before_); }
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

 private:
#if defined(__x86_64__)
  static constexpr std::uint32_t zeros = 1u << 15 | 1u << 6;  // of results, and of operands
  static std::uint32_t get() { return _mm_getcsr(); }
  static void set(std::uint32_t mode) { _mm_setcsr(mode); }
  std::uint32_t before_ = get();
#elif defined(__aarch64__)
  static constexpr std::uint64_t zeros = 1u << 24;
  static std::uint64_t get() {
    std::uint64_t mode;
    asm volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
  }
  static void set(std::uint64_t mode) { asm volatile("msr fpcr, %0" : : "r"(mode)); }
  std::uint64_t before_ = get();
#else
  static constexpr int zeros = 0;
  static void set(int) {}
  int before_ = 0;
#endif
};

}  // namespace quadgraph::cpu
