// The first frames of a link: who is there, whether both belong to the same world, and whether both
// know its secret. protocol/WIRE_FORMAT.md says in which order they go.
#pragma once

#include <array>
#include <optional>

#include "protocol/frame.h"
#include "server/base/result.h"
#include "server/net/links/peer_links.h"
#include "server/net/links/secret.h"

namespace aureole {

struct Introduction {
  PeerId peer;
  PeerHello hello;
};

/// Our own hello towards a peer whose earlier incarnation we knew as `known` (0: never met).
SharedBytes make_hello(const PeerLinksOptions& self, Incarnation known, bool running);
SharedBytes make_refusal(const Refusal& refusal);

/// Reads the other side's hello. An Error is a sentence for both sides: another protocol version,
/// another world, an id that cannot be, or ourselves.
Result<Introduction> read_hello(const FrameView& frame, const PeerLinksOptions& self);

/// What a refusal frame says, made safe to print.
Refusal read_refusal(const FrameView& frame);

/// "region r2" or "gateway 0", for logs.
std::string describe(PeerId peer);

/// Proves to the other side of one link that this side knows the world's secret, and asks the same
/// of it. Each side brings a nonce that was never used before, so that no proof can be used again;
/// what comes after the handshake is neither proven nor hidden.
class Handshake {
 public:
  enum class Side { dials, answers };

  /// `answering` is who was dialled: what is said to one server proves nothing to another one.
  /// Without a secret nothing is proven, and nothing asked. `secret` is copied.
  Handshake(Side side, PeerId answering, const std::optional<Secret>& secret);

  /// The first frame of the side that answers.
  SharedBytes challenge() const;
  /// For the side that dials. An Error is a sentence for both sides: another protocol version, or
  /// one side knows a secret and the other does not.
  Status hear_challenge(const FrameView& frame);
  bool has_heard_challenge() const { return has_heard_challenge_; }

  /// A hello or refusal as it is sent: sealed if there is a secret and the other side's nonce is
  /// known.
  SharedBytes seal(SharedBytes frame) const;

  struct Opened {
    Frame frame;             ///< Of any type if it came without a seal.
    bool is_proven = false;  ///< Or nothing has to be: there is no secret.
  };
  /// What came, out of its seal: a hello or a refusal, and a refusal also when both have said
  /// hello. Refusals may come without a seal, and are not proven then. An Error is a sentence for
  /// both sides.
  Result<Opened> open(const FrameView& frame);

 private:
  using Nonce = std::array<std::byte, 32>;

  Secret::Mac code_of(Side sender, const Nonce& dialling, FrameType type,
                      std::span<const std::byte> payload) const;

  Side side_;
  PeerId answering_;
  std::optional<Secret> secret_;
  bool has_heard_challenge_ = false;
  std::optional<Nonce> answering_nonce_, dialling_nonce_;
};

}  // namespace aureole
