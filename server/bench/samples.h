// Collecting what operations of one kind take, and what they dealt with.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/bench/bench.h"
#include "server/measure/measured/measured_run.h"

namespace aureole {

/// Of one operation, over all repeats; becomes a line of the table.
class Samples {
 public:
  struct Size {
    std::size_t bodies = 0, awake = 0, bytes = 0;
  };
  Samples(std::string situation, std::string operation) {
    row_.situation = std::move(situation);
    row_.operation = std::move(operation);
  }

  void add(double cpu_us, const Size& size) {
    cpu_us_.push_back(cpu_us);
    row_.bodies += static_cast<double>(size.bodies);
    row_.awake += static_cast<double>(size.awake);
    row_.bytes += static_cast<double>(size.bytes);
  }
  bool empty() const { return cpu_us_.empty(); }
  void note(std::string text) { row_.note = std::move(text); }
  /// Requires samples.
  BenchRow row() {
    BenchRow row = row_;
    row.cpu = spread_of(cpu_us_);
    row.samples = cpu_us_.size();
    const auto count = static_cast<double>(row.samples);
    row.bodies /= count;
    row.awake /= count;
    row.bytes /= count;
    return row;
  }

 private:
  BenchRow row_;
  std::vector<double> cpu_us_;
};

/// Thread CPU time of `work` (µs). Asking the clock takes 0.3 to 3 µs itself, by the machine.
template <class Work>
double cpu_us_of(Work&& work) {
  const std::int64_t before = thread_cpu_ns();
  work();
  return static_cast<double>(thread_cpu_ns() - before) / 1e3;
}

}  // namespace aureole
