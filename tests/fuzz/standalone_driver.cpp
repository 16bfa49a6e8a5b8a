// Runs a fuzz target without libFuzzer: replays seeds and a corpus, then seeds changed at random.
// Usage: fuzz_<name> [--runs N] [--seed S] [--only RUN] [--write-seeds DIR] [FILE or DIR]...
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include "tests/fuzz/fuzz_target.h"

/// There when a sanitizer is linked: it ends the process without a signal.
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());

namespace {

using aureole::Bytes;
using Random = std::mt19937_64;

constexpr std::size_t input_bytes_max = 1u << 16;

std::uint64_t current_seed = 0;
std::uint64_t current_run = 0;

void name_the_run() {
  char text[128];
  const int length = std::snprintf(text, sizeof text, "fuzz: repeat with --seed %llu --only %llu\n",
                                   static_cast<unsigned long long>(current_seed),
                                   static_cast<unsigned long long>(current_run));
  if (length > 0 && write(STDERR_FILENO, text, static_cast<std::size_t>(length)) < 0) std::_Exit(1);
}

void on_signal(int signal) {
  name_the_run();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

std::size_t below(Random& random, std::size_t end) {
  return end == 0 ? 0 : random() % end;
}

/// Numbers at which readers go wrong: edges of integers, NaN and infinity, lengths and offsets.
std::uint64_t interesting_number(Random& random) {
  static constexpr std::uint64_t numbers[] = {0,
                                              1,
                                              4,
                                              7,
                                              8,
                                              16,
                                              255,
                                              256,
                                              4095,
                                              4096,
                                              65535,
                                              1'000'000,
                                              0x7fff'ffff,
                                              0x8000'0000,
                                              0xffff'ffff,
                                              0x7fc0'0000 /* NaN */,
                                              0x7f80'0000 /* infinity */,
                                              0x7ff8'0000'0000'0000,
                                              0x7ff0'0000'0000'0000,
                                              0x7fff'ffff'ffff'ffff,
                                              ~std::uint64_t{0}};
  return numbers[below(random, std::size(numbers))];
}

void change_once(Bytes& bytes, const std::vector<Bytes>& seeds, Random& random) {
  const std::size_t at = below(random, bytes.size() + 1);
  switch (random() % 8) {
    case 0:
      if (at < bytes.size()) bytes[at] ^= static_cast<std::byte>(1u << (random() % 8));
      break;
    case 1:
      if (at < bytes.size()) bytes[at] = static_cast<std::byte>(random());
      break;
    case 2:
    case 3: {
      const std::size_t width = std::size_t{1} << (random() % 4);
      const std::size_t aligned = at - at % width;
      const std::uint64_t number = interesting_number(random);
      if (aligned + width <= bytes.size()) std::memcpy(bytes.data() + aligned, &number, width);
      break;
    }
    case 4: {  // one number a little larger or smaller: offsets that almost fit
      const std::size_t aligned = at - at % 4;
      std::uint32_t number = 0;
      if (aligned + 4 > bytes.size()) break;
      std::memcpy(&number, bytes.data() + aligned, 4);
      number += static_cast<std::uint32_t>(random() % 33) - 16;
      std::memcpy(bytes.data() + aligned, &number, 4);
      break;
    }
    case 5:
      bytes.resize(at);
      break;
    case 6: {
      const std::size_t length = std::min(below(random, 65), bytes.size() - at);
      const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      bytes.erase(from, from + static_cast<std::ptrdiff_t>(length));
      break;
    }
    case 7: {
      const Bytes& other = seeds[below(random, seeds.size())];
      const std::size_t from = below(random, other.size() + 1);
      const std::size_t length = below(random, other.size() - from + 1);
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                   other.begin() + static_cast<std::ptrdiff_t>(from),
                   other.begin() + static_cast<std::ptrdiff_t>(from + length));
      break;
    }
  }
  if (bytes.size() > input_bytes_max) bytes.resize(input_bytes_max);
}

void run_one(std::span<const std::byte> bytes) {
  // A copy of exactly this size: sanitizers see a read past the end.
  const Bytes exact(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(exact.data()), exact.size());
}

void run_changed(const std::vector<Bytes>& seeds, std::uint64_t seed, std::uint64_t run) {
  current_seed = seed;
  current_run = run;
  Random random(seed * 0x9e37'79b9'7f4a'7c15u + run);
  Bytes bytes = seeds[below(random, seeds.size())];
  for (std::uint64_t changes = 1 + random() % 6; changes > 0; --changes)
    change_once(bytes, seeds, random);
  run_one(bytes);
}

Bytes bytes_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Bytes bytes(input_bytes_max);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

void write_seeds(const std::vector<Bytes>& seeds, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    std::ofstream file(folder / ("seed_" + std::to_string(i)), std::ios::binary);
    file.write(reinterpret_cast<const char*>(seeds[i].data()),
               static_cast<std::streamsize>(seeds[i].size()));
  }
}

int usage(std::string_view what) {
  std::fprintf(
      stderr,
      "%.*s\nusage: [--runs N] [--seed S] [--only RUN] [--write-seeds DIR] [FILE or DIR]...\n",
      static_cast<int>(what.size()), what.data());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t runs = 10'000;
  std::uint64_t seed = 1;
  std::uint64_t only = ~std::uint64_t{0};
  std::vector<Bytes> seeds = aureole_fuzz_seeds();
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word.substr(0, 2) != "--") {
      if (!std::filesystem::exists(word)) return usage("there is no such file or folder");
      if (!std::filesystem::is_directory(word)) {
        seeds.push_back(bytes_of_file(word));
        continue;
      }
      for (const auto& entry : std::filesystem::recursive_directory_iterator(word))
        if (entry.is_regular_file()) seeds.push_back(bytes_of_file(entry.path()));
      continue;
    }
    if (i + 1 == argc) return usage("the last option lacks its value");
    const std::string_view value = argv[++i];
    if (word == "--write-seeds") {
      write_seeds(seeds, value);
      return 0;
    }
    std::uint64_t* number = word == "--runs"   ? &runs
                            : word == "--seed" ? &seed
                            : word == "--only" ? &only
                                               : nullptr;
    if (number == nullptr) return usage("unknown option");
    const auto parsed = std::from_chars(value.data(), value.data() + value.size(), *number);
    if (parsed.ec != std::errc{} || parsed.ptr != value.data() + value.size())
      return usage("expected a number");
  }

  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS})
    std::signal(signal, on_signal);
  if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(name_the_run);

  if (only != ~std::uint64_t{0}) {
    run_changed(seeds, seed, only);
    return 0;
  }
  for (const Bytes& bytes : seeds) run_one(bytes);
  for (std::uint64_t run = 0; run < runs; ++run) run_changed(seeds, seed, run);
  std::printf("fuzz: %zu seeds, %llu changed inputs, nothing found\n", seeds.size(),
              static_cast<unsigned long long>(runs));
  return 0;
}
