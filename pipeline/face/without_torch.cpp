// Of include/gonogo/learn.h: what needs LibTorch, in a build without it.
#include <gonogo/learn.h>

namespace gonogo::api {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw InputError(std::string(what) + ": this build has no LibTorch; build gonogo with -DGONOGO_TORCH=ON");
}

}  // namespace

TrainReport train(const TrainRequest&) { refuse("train"); }
Evaluation evaluate(const std::string&, const std::filesystem::path&) { refuse("evaluate"); }

}  // namespace gonogo::api
