// Work shared out among threads: all of it, each part once, the same result with any number of them.
#include "engine/cpu/thread_pool.h"

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

using namespace quadgraph;

TEST_CASE("every element is worked on once, in parts that do not overlap, also without any and in many rounds") {
  for (const unsigned threads : {1u, 2u, 7u}) {
    CAPTURE(threads);
    cpu::ThreadPool pool(threads);
    CHECK(pool.threads() == threads);
    for (const std::uint32_t count : {0u, 1u, 6u, 7u, 8u, 1000u, 4099u}) {
      for (const std::uint32_t part : {1u, 7u, 5000u}) {
        std::vector<std::atomic<int>> visits(count);
        std::atomic<int> empty = 0;
        pool.run(count, part, [&](std::uint32_t begin, std::uint32_t end) {
          if (begin >= end || end > count) ++empty;
          for (std::uint32_t k = begin; k < std::min(end, count); ++k) ++visits[k];
        });
        CHECK(empty == 0);
        CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& n) { return n == 1; }));
      }
    }
    std::atomic<std::uint64_t> sum = 0;
    for (std::uint32_t round = 0; round < 3000; ++round) {
      pool.run(20, 1, [&](std::uint32_t begin, std::uint32_t end) { sum += end - begin; });
    }
    CHECK(sum == 3000 * 20);
  }
}

TEST_CASE("each thread ends with `last`, once, behind the parts that it worked on") {
  for (const unsigned threads : {1u, 2u, 7u}) {
    CAPTURE(threads);
    cpu::ThreadPool pool(threads);
    for (const std::uint32_t count : {0u, 1u, 1000u}) {
      CAPTURE(count);
      static thread_local std::uint32_t worked;
      std::atomic<std::uint32_t> handed_in = 0, calls = 0;
      pool.run(
          count, 1, [&](std::uint32_t, std::uint32_t) { ++worked; },
          [&] {
            handed_in += std::exchange(worked, 0);
            ++calls;
          });
      CHECK(handed_in == count);
      CHECK(calls == (count <= 1 ? 1 : threads));
    }
  }
}

TEST_CASE("denormals are zero on all threads while they work, and not after") {
  volatile float least = std::numeric_limits<float>::min();
  for (const unsigned threads : {1u, 3u}) {
    cpu::ThreadPool pool(threads);
    std::vector<float> halves(threads, 1.0f), sums(threads, 1.0f);
    volatile float denormal = std::numeric_limits<float>::denorm_min();
    std::atomic<unsigned> working = 0;
    pool.run(threads, 1, [&](std::uint32_t begin, std::uint32_t) {
      for (++working; working < threads;) std::this_thread::yield();  // so that each has one part
      halves[begin] = 0.5f * least;
      sums[begin] = denormal + denormal;
    });
    CHECK(std::all_of(halves.begin(), halves.end(), [](float x) { return x == 0; }));
    CHECK(std::all_of(sums.begin(), sums.end(), [](float x) { return x == 0; }));
    const float half = 0.5f * least;
    CHECK(half > 0);
  }
}

TEST_CASE("what one run has written the next one reads, and sums by parts have the same bits on 1, 2 and 7 threads") {
  constexpr std::uint32_t count = 100'000, part = 64, parts = (count + part - 1) / part;
  const auto sum_with = [&](unsigned threads) {
    cpu::ThreadPool pool(threads);
    std::vector<float> values(count), sums(parts, 0.0f);
    pool.run(count, part, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k) values[k] = std::sin(static_cast<float>(k));
    });
    pool.run(parts, 1, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t p = begin; p < end; ++p) {
        for (std::uint32_t k = p * part; k < std::min((p + 1) * part, count); ++k) sums[p] += values[k];
      }
    });
    return sums;
  };
  const std::vector<float> alone = sum_with(1);
  CHECK(std::accumulate(alone.begin(), alone.end(), 0.0) == doctest::Approx(1.8120).epsilon(1e-3));
  for (const unsigned threads : {2u, 7u}) CHECK(sum_with(threads) == alone);
}
