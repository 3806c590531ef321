// Samplers outside the program: what a hanging, crashing or lying one does.
#include "learning/sampler/external.h"

#include <chrono>

#include "base/files/file.h"
#include "learning/formats/dimod.h"
#include "learning/sampler/exact.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

Problem pair() {
  Problem problem;
  problem.labels = {"a", "b"};
  problem.linear = {0.5, -1};
  problem.couplings = {{0, 1, 2}};
  return problem;
}

SamplerSettings script(const std::string& text, double limit_s = 20) {
  return {{"program", std::vector<std::string>{"sh", "-c", text, "script", "{problem}", "{answer}", "{reads}"}},
          {"time_limit_s", limit_s}};
}

}  // namespace

TEST_CASE("a program's answer is taken when it is whole") {
  const TemporaryFolder folder;
  const SampleSet answer = make_sampler("exact")->sample(pair(), {.reads = 12, .seed = 1});
  write_file_atomically(folder / "answer.json", to_dimod_json(answer));
  const std::string copy = "test -s \"$1\" && cp '" + (folder / "answer.json").string() + "' \"$2\"";
  CHECK(make_sampler("command", script(copy))->sample(pair(), {.reads = 12}) == answer);
  refused([&] { make_sampler("command", script(copy))->sample(pair(), {.reads = 13}); }, "12 of 13 reads");
  refused([&] { make_sampler("command", script(copy))->sample(pair(), {.reads = 11}); }, "more than 11");
  Problem other = pair();
  other.linear[0] = 0.75;
  refused([&] { make_sampler("command", script(copy))->sample(other, {.reads = 12}); }, "energy");
  // the same answer, but the program fails afterwards: a partial answer is never used
  refused(
      [&] {
        make_sampler("command", script(copy + "; echo out of helium >&2; exit 3"))->sample(pair(), {.reads = 12});
      },
      "exit status 3");
  refused(
      [&] {
        make_sampler("command", script(copy + "; echo out of helium >&2; exit 3"))->sample(pair(), {.reads = 12});
      },
      "out of helium");
  refused(
      [&] {
        make_sampler("command", script("head -c 40 '" + (folder / "answer.json").string() + "' > \"$2\""))
            ->sample(pair(), {.reads = 12});
      },
      "JSON");
}

TEST_CASE("a program that hangs, crashes, writes nothing or does not exist is an error") {
  const auto begin = std::chrono::steady_clock::now();
  refused(
      [] { make_sampler("command", script("echo waiting >&2; sleep 60 & wait", 0.4))->sample(pair(), {.reads = 1}); },
      "waiting");
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(10));
  refused([] { make_sampler("command", script("kill -SEGV $$"))->sample(pair(), {.reads = 1}); }, "signal 11");
  refused([] { make_sampler("command", script("true"))->sample(pair(), {.reads = 1}); }, "no answer");
  refused([] { run_process({"/no/such/program"}, 5); }, "cannot be started");
  refused([] { make_sampler("command", {}); }, "no program");
}

TEST_CASE("arguments are never read by a shell") {
  const TemporaryFolder folder;
  const std::string file = (folder / "touched").string();
  const ProcessResult result = run_process({"echo", "; touch " + file, "$(touch " + file + ")"}, 5);
  CHECK(result.exit_status == 0);
  CHECK(!std::filesystem::exists(file));
}

TEST_CASE("training by file: the problem is written, the same request goes on when the answer is there") {
  const TemporaryFolder folder;
  const auto sampler = make_sampler("file", {{"folder", folder.path().string()}});
  const std::string message = input_error([&] { sampler->sample(pair(), {.reads = 4, .seed = 2}); });
  CHECK(contains(message, "waits for 4 reads"));
  const std::string name = message.substr(message.find(folder.path().string()));
  const std::string problem = name.substr(0, name.find(' '));
  CHECK(problem_from_dimod_json(read_file(problem), problem) == pair());
  const SampleSet answer = make_sampler("exact")->sample(pair(), {.reads = 4, .seed = 6});
  write_file_atomically(problem.substr(0, problem.size() - 5) + ".answer.json", to_dimod_json(answer));
  CHECK(sampler->sample(pair(), {.reads = 4, .seed = 2}) == answer);
  CHECK(contains(input_error([&] { sampler->sample(pair(), {.reads = 4, .seed = 3}); }), "waits"));
}
