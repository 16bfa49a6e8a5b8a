// Keys and codes by libsodium.
#include "server/net/links/secret.h"

#include <sodium.h>

#include <fstream>
#include <iterator>
#include <string>

#include "server/base/check.h"

namespace aureole {
namespace {

static_assert(Secret::mac_bytes == crypto_auth_hmacsha512256_BYTES);
static_assert(crypto_auth_hmacsha512256_KEYBYTES == 32);

void use_sodium() {
  static const int started = sodium_init();
  AUREOLE_CHECK(started >= 0, "libsodium has a source of random numbers");
}

}  // namespace

Result<Secret> Secret::from_text(std::string_view text) {
  if (text.size() < min_characters || text.size() > max_characters)
    return Error::format("a secret of {} characters; expected {} to {}", text.size(),
                         min_characters, max_characters);
  use_sodium();
  Secret secret;
  crypto_generichash(secret.key_.data(), secret.key_.size(),
                     reinterpret_cast<const unsigned char*>(text.data()), text.size(), nullptr, 0);
  return secret;
}

Result<Secret> Secret::read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return Error::format("cannot read {}", file.string());
  std::string text(max_characters + 2, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) return Error::format("cannot read {}", file.string());
  text.resize(static_cast<std::size_t>(in.gcount()));
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  auto secret = from_text(text);
  if (!secret) return Error::format("{} holds {}", file.string(), secret.error().message);
  return secret;
}

Secret::Mac Secret::mac(std::initializer_list<std::span<const std::byte>> parts) const {
  crypto_auth_hmacsha512256_state state;
  crypto_auth_hmacsha512256_init(&state, key_.data(), key_.size());
  for (const auto part : parts)
    crypto_auth_hmacsha512256_update(&state, reinterpret_cast<const unsigned char*>(part.data()),
                                     part.size());
  Mac mac;
  crypto_auth_hmacsha512256_final(&state, reinterpret_cast<unsigned char*>(mac.data()));
  return mac;
}

bool Secret::are_same(const Mac& a, const Mac& b) {
  return sodium_memcmp(a.data(), b.data(), mac_bytes) == 0;
}

std::array<std::byte, 32> random_nonce() {
  use_sodium();
  std::array<std::byte, 32> nonce;
  randombytes_buf(nonce.data(), nonce.size());
  return nonce;
}

std::string random_secret() {
  const auto bytes = random_nonce();
  std::string text(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                 bytes.size());
  text.pop_back();
  return text;
}

}  // namespace aureole
