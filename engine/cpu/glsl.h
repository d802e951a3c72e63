// The part of GLSL that the shaders use, as C++ types and functions (tools/shader_headers/native.py). All of it is in a
// namespace per level of instructions (QG_LEVEL: v2, v3, v4 of x86-64, or portable), so that the linker mixes none.
#pragma once

#include <cstdint>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

#include "engine/cpu/functions.h"
#include "engine/cpu/lane_order.h"
#include "engine/cpu/matrices.h"

namespace quadgraph::cpu::QG_LEVEL {

inline uint atomicAdd(uint& x, uint y) {
  return __atomic_fetch_add(&x, y, __ATOMIC_RELAXED);
}
inline uint atomicOr(uint& x, uint y) {
  return __atomic_fetch_or(&x, y, __ATOMIC_RELAXED);
}
inline uint atomicMin(uint& x, uint y) {
  uint old = __atomic_load_n(&x, __ATOMIC_RELAXED);
  while (y < old && !__atomic_compare_exchange_n(&x, &old, y, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return old;
}
inline uint atomicMax(uint& x, uint y) {
  uint old = __atomic_load_n(&x, __ATOMIC_RELAXED);
  while (y > old && !__atomic_compare_exchange_n(&x, &old, y, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return old;
}
inline void barrier() {}
inline void memoryBarrierBuffer() {
  __atomic_thread_fence(__ATOMIC_SEQ_CST);
#if defined(__SANITIZE_THREAD__)
  // ThreadSanitizer knows no fences.
  static char fence;
  __tsan_acquire(&fence);
  __tsan_release(&fence);
#endif
}

// A word that threads write and read at the same time: each sees what was there or what another has written.
template <typename T>
struct Relaxed {
  T value;
  operator T() const { return __atomic_load_n(&value, __ATOMIC_RELAXED); }
  void operator=(T now) { __atomic_store_n(&value, now, __ATOMIC_RELAXED); }
};
inline uint atomicOr(Relaxed<uint>& x, uint y) {
  return atomicOr(x.value, y);
}

// Elements of a coherent array. Structs are shared within a workgroup alone, which is one thread.
template <typename T>
struct Coherent {
  using Type = T;
};
template <>
struct Coherent<uint> {
  using Type = Relaxed<uint>;
};
template <typename T>
using CoherentElement = typename Coherent<T>::Type;

// A buffer reference: an array at an address in memory.
template <typename T>
struct Array {
  T* at;
  Array() = default;
  explicit Array(uvec2 address)
      : at(reinterpret_cast<T*>(std::uint64_t{address.x()} | std::uint64_t{address.y()} << 32)) {}
  explicit operator uvec2() const {
    const auto address = reinterpret_cast<std::uint64_t>(at);
    return {address & 0xffffffffu, address >> 32};
  }
};

// Asks memory for an element that is read later.
template <typename T>
void fetch_ahead(const Array<T>& array, int i) {
  __builtin_prefetch(array.at + i);
  asm volatile("");  // without it compilers take what calls this for idle, and leave it out
}

// What shaders/shared/buffers.glsl says in GLSL.
#define QG_ARRAY(Name, Type)  \
  struct Name : Array<Type> { \
    using Array<Type>::Array; \
  }
#define QG_COHERENT_ARRAY(Name, Type) QG_ARRAY(Name, CoherentElement<Type>)
#define QG_ALIGNED_ARRAY(Name, Type, bytes) QG_ARRAY(Name, Type)
#define QG_HEADED_ARRAY(Name, Head, head, Type)                                                       \
  struct Name {                                                                                       \
    Head& head;                                                                                       \
    Type* at;                                                                                         \
    explicit Name(uvec2 address)                                                                      \
        : head(*Array<Head>(address).at), at(reinterpret_cast<Type*>(Array<Head>(address).at + 1)) {} \
  }

// Scratch of a reduction (shaders/shared/reduce.glsl): the ticket, then the partials. Both members are the address.
struct Ticket {
  uint* address;
  operator uint&() const { return *address; }
  const Ticket& operator=(uint value) const {
    __atomic_store_n(address, value, __ATOMIC_RELAXED);
    return *this;
  }
  Ticket(const Ticket&) = default;
};
struct Partials {
  uint* address;
  packed_vec3& operator[](uint i) const { return reinterpret_cast<packed_vec3*>(address + 1)[i]; }
};
union Reduction {
  Ticket ticket;
  Partials partials;
  Reduction() {}
};

}  // namespace quadgraph::cpu::QG_LEVEL
