#include "convert/usd/packed.h"

#include <cstring>

#include <rubble/error.h>

namespace rubble::usd {
namespace {

[[noreturn]] void fail(const std::string& who) { throw Error(who, "well-formed compressed data", "others"); }

template <class T> T read(std::string_view from, std::size_t at, const std::string& who) {
  if (from.size() < sizeof(T) || at > from.size() - sizeof(T)) fail(who);
  T out;
  std::memcpy(&out, from.data() + at, sizeof(T));
  return out;
}

/// One LZ4 block (LZ4 Block Format 1.6): literals, then a copy of earlier bytes, in turn.
void unpackBlock(std::string_view in, std::size_t most, std::string& out, const std::string& who) {
  std::size_t at = 0;
  const auto byte = [&] {
    if (at >= in.size()) fail(who);
    return static_cast<unsigned char>(in[at++]);
  };
  const auto longer = [&](std::size_t size) {
    if (size < 15) return size;
    for (unsigned char more = 255; more == 255;) size += more = byte();
    return size;
  };
  while (at < in.size()) {
    const unsigned char sizes = byte();
    const std::size_t literals = longer(sizes >> 4);
    if (literals > in.size() - at || literals > most - out.size()) fail(who);
    out.append(in.substr(at, literals));
    at += literals;
    if (at == in.size()) return;
    const std::size_t low = byte(), distance = low | static_cast<std::size_t>(byte()) << 8;
    const std::size_t size = longer(sizes & 15) + 4;
    if (distance == 0 || distance > out.size() || size > most - out.size()) fail(who);
    for (std::size_t i = 0; i < size; ++i) out.push_back(out[out.size() - distance]);
  }
}

}  // namespace

std::string unpackBytes(std::string_view packed, std::size_t most, const std::string& who) {
  std::string out;
  const auto chunks = read<std::uint8_t>(packed, 0, who);
  if (chunks == 0) {
    unpackBlock(packed.substr(1), most, out, who);
    return out;
  }
  std::size_t at = 1;
  for (int i = 0; i < chunks; ++i) {
    const auto size = read<std::int32_t>(packed, at, who);
    at += sizeof size;
    if (size < 0 || static_cast<std::size_t>(size) > packed.size() - at) fail(who);
    unpackBlock(packed.substr(at, static_cast<std::size_t>(size)), most, out, who);
    at += static_cast<std::size_t>(size);
  }
  return out;
}

std::vector<std::int64_t> unpackIntegers(std::string_view packed, std::size_t count, bool wide,
                                         const std::string& who) {
  const std::size_t full = wide ? 8 : 4, codes = (count + 3) / 4;
  // a count that is not that of the data ends here, before room is made for it
  if (count > (std::size_t{1} << 40)) fail(who);
  if (count > packed.size() * 255 * 4) fail(who);
  const std::string data = unpackBytes(packed, full + codes + full * count, who);
  std::size_t at = full + codes;
  if (data.size() < at) fail(who);
  const auto number = [&](std::size_t where, std::size_t bytes) -> std::int64_t {
    return bytes == 1   ? read<std::int8_t>(data, where, who)
           : bytes == 2 ? read<std::int16_t>(data, where, who)
           : bytes == 4 ? read<std::int32_t>(data, where, who)
                        : read<std::int64_t>(data, where, who);
  };
  const std::int64_t common = number(0, full);
  std::vector<std::int64_t> out;
  out.reserve(count);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int code = static_cast<unsigned char>(data[full + i / 4]) >> (2 * (i % 4)) & 3;
    std::int64_t difference = common;
    if (code > 0) {
      const std::size_t bytes = wide ? std::size_t{1} << code : std::size_t{1} << (code - 1);
      difference = number(at, bytes);
      at += bytes;
    }
    sum += static_cast<std::uint64_t>(difference);
    out.push_back(
        wide ? static_cast<std::int64_t>(sum)
             : static_cast<std::int64_t>(static_cast<std::int32_t>(static_cast<std::uint32_t>(sum))));
  }
  return out;
}

}  // namespace rubble::usd
