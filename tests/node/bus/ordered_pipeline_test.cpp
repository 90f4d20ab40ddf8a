// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/ordered_pipeline.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace orchard::bus {
namespace {

/// Numbers from 0 on: squared by whoever has time, summed up in order.
struct Squares {
  explicit Squares(std::size_t num_slots) : slots(num_slots) {}

  void run(int num_threads, int num_batches) {
    int next = 0;
    run_pipeline(
        [&](std::size_t slot) {
          if (next == num_batches) return false;
          slots[slot] = next++;
          return true;
        },
        {{false,
          [&](std::size_t slot) {
            before(slots[slot]);
            slots[slot] *= slots[slot];
          }},
         {true,
          [&](std::size_t slot) {
            sum += slots[slot];
            slots[slot] = sum;
          }},
         {true, [&](std::size_t slot) { seen.push_back(slots[slot]); }}},
        num_threads, slots.size());
  }

  std::vector<int> slots;
  std::function<void(int)> before = [](int) {};
  int sum = 0;
  std::vector<int> seen;
};

std::vector<int> sums_of_squares(int num) {
  std::vector<int> sums;
  for (int i = 0, sum = 0; i < num; ++i) sums.push_back(sum += i * i);
  return sums;
}

TEST(OrderedPipeline, GivesTheSameForAnyNumberOfThreads) {
  for (const int num_threads : {1, 2, 3, 8}) {
    Squares squares(5);
    squares.before = [](int batch) {  // some take much longer than those after them
      std::atomic<int> spent{0};
      while (spent < (batch % 5 == 0 ? 100'000 : 0)) ++spent;
    };
    squares.run(num_threads, 500);
    EXPECT_EQ(squares.seen, sums_of_squares(500)) << num_threads;
  }
}

TEST(OrderedPipeline, NothingToDoIsDoneAtOnce) {
  Squares squares(3);
  squares.run(4, 0);
  EXPECT_TRUE(squares.seen.empty());
}

TEST(OrderedPipeline, StagesWithoutOrderRunAtOnce) {
  // The first batch waits until another is in the same stage: with one thread it would for ever.
  std::mutex mutex;
  std::condition_variable entered;
  int num_inside = 0;
  Squares squares(4);
  squares.before = [&](int batch) {
    std::unique_lock<std::mutex> lock(mutex);
    ++num_inside;
    entered.notify_all();
    if (batch == 0) entered.wait(lock, [&] { return num_inside >= 2; });
  };
  squares.run(2, 10);
  EXPECT_EQ(squares.seen, sums_of_squares(10));
}

TEST(OrderedPipeline, NoMoreBatchesThanSlotsAreOnTheirWay) {
  std::atomic<int> on_their_way{0};
  std::atomic<int> most{0};
  int next = 0;
  run_pipeline(
      [&](std::size_t) {
        if (next++ == 200) return false;
        const int now = ++on_their_way;
        if (now > most) most = now;
        return true;
      },
      {{false, [](std::size_t) {}}, {true, [&](std::size_t) { --on_their_way; }}}, 4, 3);
  EXPECT_LE(most, 3);
  EXPECT_EQ(on_their_way, 0);
}

TEST(OrderedPipeline, TheEarliestErrorIsThrownAfterAllBeforeIt) {
  for (const int num_threads : {1, 2, 4}) {
    Squares squares(6);
    squares.before = [](int batch) {
      if (batch >= 20) throw std::runtime_error(std::to_string(batch));
    };
    try {
      squares.run(num_threads, 100);
      FAIL() << num_threads;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "20") << num_threads;
    }
    EXPECT_EQ(squares.seen, sums_of_squares(20)) << num_threads;
  }
}

TEST(OrderedPipeline, AnErrorOfWhatFillsIsThrownInItsTurn) {
  for (const int num_threads : {1, 3}) {
    int next = 0;
    int num_through = 0;
    const auto run = [&] {
      run_pipeline(
          [&](std::size_t) {
            if (next++ == 7) throw std::runtime_error("no more can be read");
            return true;
          },
          {{true, [&](std::size_t) { ++num_through; }}}, num_threads, 3);
    };
    EXPECT_THROW(run(), std::runtime_error);
    EXPECT_EQ(num_through, 7);
  }
}

}  // namespace
}  // namespace orchard::bus
