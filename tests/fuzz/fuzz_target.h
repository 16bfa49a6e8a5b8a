// What every fuzz target defines; shared by libFuzzer and by the standalone driver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

#include "protocol/frame.h"

/// Must return 0 for every input, or end the process: that is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Valid inputs to begin from, made in code so that they follow every change of the formats.
std::vector<aureole::Bytes> aureole_fuzz_seeds();

/// The input as a payload comes out of FrameReader: aligned, and padded to a multiple of 8 bytes.
inline aureole::Bytes payload_of(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  aureole::Bytes payload(input.begin(), input.end());
  payload.resize((size + 7) / 8 * 8);
  return payload;
}

/// A property that holds for every input; on in every build.
#define FUZZ_EXPECT(condition)                                                            \
  do {                                                                                    \
    if (!(condition)) {                                                                   \
      std::fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                       \
    }                                                                                     \
  } while (false)
