#include "backend/engine.h"

namespace rubble {

namespace {

class SavedBytes final : public EngineSnapshot {
 public:
  explicit SavedBytes(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  std::vector<std::byte> bytes() const override { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

std::shared_ptr<const EngineSnapshot> Engine::snapshot() const {
  return std::make_shared<SavedBytes>(save());
}

}  // namespace rubble
