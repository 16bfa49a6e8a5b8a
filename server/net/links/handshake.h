// The first frames of a link: who is there, and whether both belong to the same world.
#pragma once

#include "protocol/frame.h"
#include "server/base/result.h"
#include "server/net/links/peer_links.h"

namespace aureole {

/// Part of the reason of a refusal: whoever is told so has been replaced.
inline constexpr const char* newer_start_known = "a newer start of";

struct Introduction {
  PeerId peer;
  PeerHello hello;
};

/// Our own hello towards a peer whose earlier incarnation we knew as `known` (0: never met).
SharedBytes make_hello(const PeerLinksOptions& self, Incarnation known, bool running);
SharedBytes make_refusal(const std::string& reason);

/// Reads the other side's hello. An Error is a sentence for both sides: another protocol version,
/// another world, an id that cannot be, or ourselves.
Result<Introduction> read_hello(const FrameView& frame, const PeerLinksOptions& self);

/// The reason in a refusal frame, made safe to print.
std::string read_refusal(const FrameView& frame);

/// "region r2" or "gateway 0", for logs.
std::string describe(PeerId peer);

}  // namespace aureole
