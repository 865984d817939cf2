#include <numeric>
#include <optional>

#include "backend/distributed/transport.h"
#include "io/appearance_json.h"
#include "io/byte_stream.h"
#include "io/frame_codec.h"
#include "io/recording.h"
#include "io/recording_format.h"
#include "platform/threads.h"

namespace rubble::io {
namespace {

/// A chunk of frames ends at this many frames, or bytes before compression.
constexpr int kFramesInChunk = 32;
constexpr std::size_t kBytesInChunk = 16u << 20;
constexpr std::size_t kBytesOfPose = 20, kBytesOfVertex = 12;

}  // namespace

struct RecordingWriter::Impl {
  Threads threads;
  Transport* transport;
  const int rank, ranks;
  std::optional<ChunkWriter> out;  ///< of the first process
  FrameEncoder frames;
  RecordedObjects objects;
  bool hasBodies = false;
  std::uint64_t bodyOffset = 0;
  std::vector<FrameChunk> index;
  bool finished = false;

  Impl(const std::string& file, const RecordingHeader& header, const RecordingOptions& options)
      : threads(options.threads),
        transport(options.transport),
        rank(transport ? transport->rank() : 0),
        ranks(transport ? transport->ranks() : 1),
        frames(header.resolution) {
    guarded([&] {
      if (rank == 0) begin(file, header);
      awaitAll();
    });
  }

  /// Other processes must not wait for one that has failed.
  template <class F> void guarded(F&& f) try { f(); } catch (const std::exception& error) {
    if (transport) transport->fail(error.what());
    throw;
  }
  /// All processes have come to this call.
  void awaitAll() {
    if (!transport) return;
    std::byte own{};
    std::vector<std::byte> all(static_cast<std::size_t>(ranks));
    transport->gather({&own, 1}, all, std::vector<std::size_t>(all.size(), 1));
  }

  void begin(const std::string& file, const RecordingHeader& header) {
    out.emplace(file);
    out->writeRaw(magicBytes());
    write(kHead, encodeHeader(header));
    if (const std::string own = appearanceText(header.appearance); own != appearanceText({})) {
      ByteWriter text;
      text.put(own);
      write(kLook, text.bytes());
    }
  }
  /// Returns the offset of the chunk in the first process.
  std::uint64_t write(std::uint32_t name, const Bytes& content) {
    std::uint64_t offset = 0;
    if (out) threads.run([&] { offset = out->write(name, content); });
    return offset;
  }

  void flushFrames() {
    const int count = frames.frameCount();
    if (count == 0) return;
    // before the chunk, which is in the file then
    if (index.size() == index.capacity()) index.reserve(2 * index.size() + 1);
    index.push_back({writeFrames(), bodyOffset, count});
    frames.clear();
  }
  /// Each process packs its share of the pieces.
  std::uint64_t writeFrames() {
    const std::size_t size = frames.contentSize(), pieces = piecesOf(size), all = std::size_t(ranks),
                      begin = pieces * std::size_t(rank) / all, end = pieces * std::size_t(rank + 1) / all;
    Bytes content, packed;
    threads.run([&] {
      content = frames.content(begin * kPieceBytes, std::min(end * kPieceBytes, size));
      packed = packPieces(content, begin, end);
    });
    collect(packed);
    if (!out) return 0;
    // this process made its own part of the content alone
    if (ranks > 1 && !ChunkWriter::mayStore(size, packed)) content = frames.content();
    return out->write(kFrames, content, packed);
  }
  /// Gives the pieces of all processes to the first one, in the order of ranks.
  void collect(Bytes& packed) {
    if (!transport) return;
    const std::uint64_t own = packed.size();
    std::vector<std::uint64_t> sizes(static_cast<std::size_t>(ranks));
    transport->gather(std::as_bytes(std::span(&own, 1)), std::as_writable_bytes(std::span(sizes)),
                      std::vector<std::size_t>(sizes.size(), sizeof own));
    std::vector<Transport::Send> sends;
    std::vector<Transport::Receive> receives;
    if (rank == 0) {
      packed.resize(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
      std::size_t at = own;
      for (std::size_t r = 1; r < sizes.size(); at += sizes[r++])
        if (sizes[r] > 0)
          receives.push_back(
              {static_cast<int>(r), std::as_writable_bytes(std::span(packed).subspan(at, sizes[r]))});
    } else if (own > 0) {
      sends.push_back({0, std::as_bytes(std::span(packed))});
    }
    transport->exchange(sends, receives);
  }

  void add(const RecordedFrame& frame) {
    if (frames.add(frame)) return;
    flushFrames();
    frames.add(frame);
  }
  void write(const std::vector<RecordedBody>& bodies, const RecordedFrame& frame,
             const std::vector<RecordedSoft>& softs);
  void finish();
};

RecordingWriter::RecordingWriter(const std::string& file, const RecordingHeader& header,
                                 const RecordingOptions& options) {
  if (!(header.resolution > 0))
    throw Error("recording.resolution", "a length above 0 [m]", std::to_string(header.resolution));
  impl_ = std::make_unique<Impl>(file, header, options);
}

RecordingWriter::~RecordingWriter() {
  // other processes may have failed, and not come to this call
  if (impl_->transport) return;
  try {
    finish();
  } catch (...) {
    // A destructor cannot report an error; finish() throws.
  }
}

void RecordingWriter::write(const std::vector<RecordedBody>& bodies, const RecordedFrame& frame,
                            const std::vector<RecordedSoft>& softs) {
  impl_->guarded([&] { impl_->write(bodies, frame, softs); });
}
void RecordingWriter::finish() {
  if (impl_->finished) return;
  impl_->finished = true;
  try {
    impl_->guarded([&] { impl_->finish(); });
  } catch (const std::bad_alloc&) {
    impl_->finished = false;
    throw;
  }
}

void RecordingWriter::Impl::write(const std::vector<RecordedBody>& bodies, const RecordedFrame& frame,
                                  const std::vector<RecordedSoft>& softs) {
  if (finished) throw Error("recording", "a recording that is not finished", "one that is");
  if (bodies.size() != frame.poses.size())
    throw Error("recording.frame", std::to_string(bodies.size()) + " poses",
                std::to_string(frame.poses.size()));
  const auto requireVertices = [&](const RecordedObjects& of) {
    if (of.vertexCount() != frame.vertices.size())
      throw Error("recording.frame", std::to_string(of.vertexCount()) + " vertices",
                  std::to_string(frame.vertices.size()));
  };
  if (!hasBodies || bodies != objects.bodies || softs != objects.softs) {
    RecordedObjects now{bodies, softs};
    requireVertices(now);
    flushFrames();
    bodyOffset = write(kBody, out ? encodeObjects(now) : Bytes());
    objects = std::move(now);
    hasBodies = true;
  }
  requireVertices(objects);
  add(frame);
  const std::size_t bytes = static_cast<std::size_t>(frames.frameCount()) *
                            (bodies.size() * kBytesOfPose + frame.vertices.size() * kBytesOfVertex);
  if (frames.frameCount() < kFramesInChunk && bytes < kBytesInChunk) return;
  try {
    flushFrames();
  } catch (const std::bad_alloc&) {
    frames.takeBack();
    throw;
  }
}

void RecordingWriter::Impl::finish() {
  flushFrames();
  // before the index, which is in the file then
  Bytes footer(sizeof(std::uint64_t) + kMagic.size());
  const std::uint64_t offset = write(kIndex, encodeIndex(index));
  for (std::size_t k = 0; k < sizeof offset; ++k) footer[k] = static_cast<std::uint8_t>(offset >> (8 * k));
  std::ranges::copy(kMagic, footer.begin() + sizeof offset);
  if (out) out->writeRaw(footer);
  awaitAll();
}

}  // namespace rubble::io
