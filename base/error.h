// Errors that reach a person. See docs/notation.md, "Errors".
//   InputError   the user's input is unusable. Says file, place, value, allowed range, what to do.
//   DeviceError  a library, the operating system or a device failed. Names the call.
//   OutOfMemory  a DeviceError: a GPU holds less than the work needs.
//   Cancelled    the user pressed Ctrl-C. Finished work is kept.
// A numerical failure is a status in the result, not an error. A broken invariant is a bug: GONOGO_ASSERT.
#pragma once
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace gonogo {

struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Place of a fault in the input. Unknown fields are empty or 0.
struct InputPlace {
  std::string file{};      // as the user named it
  std::string path{};      // of a value in a JSON file, "bed.size_m[2]"
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // from 1, in characters of UTF-8
};

/// An InputError with the place of the fault in separate fields, for programs that read `gonogo --json`. The message
/// names the place too.
struct PlacedInputError : InputError {
  PlacedInputError(const std::string& message, InputPlace where) : InputError(message), place(std::move(where)) {}
  InputPlace place;
};

struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct OutOfMemory : DeviceError {
  using DeviceError::DeviceError;
};

/// The user stopped the command; by default one that loses nothing by it.
struct Cancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
  Cancelled()
      : std::runtime_error("interrupted; what was finished is kept, and the same command continues from there") {}
};

/// Process exit codes: 0 success, 1 bug or device failure, 2 bad input, 130 interrupted (128 + SIGINT).
enum class ExitCode { success = 0, failure = 1, bad_input = 2, interrupted = 130 };

}  // namespace gonogo

#ifdef NDEBUG
#define GONOGO_ASSERT(condition) ((void)0)
#elif defined(__CUDA_ARCH__)
#define GONOGO_ASSERT(condition) ((condition) ? (void)0 : __trap())
#else
#define GONOGO_ASSERT(condition) \
  ((condition)                   \
       ? (void)0                 \
       : (std::fprintf(stderr, "%s:%d: broken invariant: %s\n", __FILE__, __LINE__, #condition), std::abort()))
#endif
