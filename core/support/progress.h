#pragma once

#include <cstdint>
#include <string>

namespace arete {

/// Receives the progress of long work, and may stop it. Calls come from one thread at a time.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage of the work begins: `label` in the user's words, `total` units of work (cells, atoms...).
  virtual void begin(const std::string& label, std::int64_t total) = 0;
  /// `done` more units are finished. Throws Error{interrupted} when the user asked to stop.
  virtual void advance(std::int64_t done) = 0;
  virtual void end() = 0;
};

/// Ignores everything: the default where no one watches.
class NoProgress final : public Progress {
 public:
  void begin(const std::string&, std::int64_t) override {}
  void advance(std::int64_t) override {}
  void end() override {}
};

}  // namespace arete
