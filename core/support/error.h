#pragma once

#include <stdexcept>
#include <string>

namespace arete {

/// What kind of failure it was. The value is the exit code of the command.
enum class ErrorKind {
  usage = 2,        ///< the command line or an argument makes no sense
  input = 3,        ///< an input is missing, damaged, or does not fit the others
  format = 4,       ///< an input or output format that is not supported
  disk = 5,         ///< reading or writing failed; the output exists already; no such folder
  memory = 6,       ///< the job does not fit in the memory budget
  interrupted = 7,  ///< the user stopped it
  damaged = 8,      ///< a file of ours fails its checksum or breaks its own rules
};

/// The only exception that Arete throws on purpose. `what()` is one line for the user:
/// what was attempted and where, what was expected, what was found, what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace arete
