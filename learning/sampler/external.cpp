#include "learning/sampler/external.h"

#include <unistd.h>

#include "base/error.h"
#include "base/file.h"
#include "base/format.h"
#include "base/hash.h"
#include "learning/qubo/dimod.h"
#include "learning/qubo/sidecar.h"
#include "learning/sampler/process.h"

namespace gonogo::learning {
namespace {

namespace fs = std::filesystem;

void write_with_sidecar(const Problem& problem, const fs::path& path) {
  const WrittenProblem written = write_problem(problem, ProblemFormat::dimod_json);
  write_file_atomically(sidecar_path(path), to_json(sidecar_of(written, ProblemFormat::dimod_json)).dump(1) + "\n");
  write_file_atomically(path, written.text);
}

SampleSet read_rows(const Problem& problem, const fs::path& path, std::size_t reads) {
  const SampleSet answer = samples_from_dimod_json(read_file(path), path.string());
  return spread_reads(check_answer(problem, answer, path.string()), reads, path.string());
}

/// A folder that goes with everything in it.
struct Scratch {
  fs::path path;
  Scratch() {
    std::string name = (fs::temp_directory_path() / "gonogo-command-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw DeviceError(name + ": cannot make a temporary folder");
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

std::string filled(std::string argument, const std::vector<std::pair<std::string, std::string>>& values) {
  for (const auto& [key, value] : values)
    for (std::size_t at = argument.find(key); at != std::string::npos; at = argument.find(key, at + value.size()))
      argument.replace(at, key.size(), value);
  return argument;
}

[[noreturn]] void fail(const std::vector<std::string>& command, const std::string& what, const ProcessResult& result) {
  const std::string text =
      result.error_text.empty() ? "; it wrote nothing to stderr" : "; its stderr ends:\n" + result.error_text;
  throw InputError("command \"" + command[0] + "\" " + what + text);
}

}  // namespace

SampleSet spread_reads(const SampleSet& answer, std::size_t reads, const std::string& source) {
  std::int64_t count = 0;
  for (std::int64_t occurrences : answer.occurrences) {
    count += occurrences;
    if (count > std::int64_t(reads)) break;
  }
  if (count != std::int64_t(reads))
    throw InputError(source + ": holds " +
                     (count > std::int64_t(reads) ? "more than " : std::to_string(count) + " of ") +
                     std::to_string(reads) + " reads that were asked for");
  SampleSet rows = answer;
  rows.values.clear();
  rows.energies.clear();
  rows.occurrences.assign(reads, 1);
  for (std::size_t r = 0; r < answer.row_count(); ++r)
    for (std::int64_t k = 0; k < answer.occurrences[r]; ++k) {
      rows.values.insert(rows.values.end(), answer.row(r).begin(), answer.row(r).end());
      rows.energies.push_back(answer.energies[r]);
    }
  return rows;
}

SampleSet FileSampler::sample(const Problem& problem, const SampleRequest& request) const {
  if (settings_.folder.empty()) throw InputError("sampler file: no folder is given");
  const std::string hash = content_hash(problem_hash(problem) + " " + std::to_string(request.reads) + " " +
                                        std::to_string(request.seed) + " " + std::to_string(request.first_sweep));
  const fs::path file = settings_.folder / (hash + ".json"), answer = settings_.folder / (hash + ".answer.json");
  if (fs::exists(answer)) return read_rows(problem, answer, request.reads);
  write_with_sidecar(problem, file);
  throw InputError("sampler file: " + file.string() + " waits for " + std::to_string(request.reads) +
                   " reads; put them into " + answer.string() + " (dimod's SampleSet) and give the same command again");
}

CommandSampler::CommandSampler(const SamplerSettings& settings) : settings_(settings) {
  if (settings.command.empty()) throw InputError("sampler command: no program is given");
  if (!(settings.time_limit_s > 0)) throw InputError("sampler command: the time limit must be above 0 s");
}

SampleSet CommandSampler::sample(const Problem& problem, const SampleRequest& request) const {
  const Scratch scratch;
  const fs::path file = scratch.path / "problem.json", answer = scratch.path / "answer.json";
  write_with_sidecar(problem, file);
  std::vector<std::string> arguments;
  for (const std::string& argument : settings_.command)
    arguments.push_back(filled(argument, {{"{problem}", file.string()},
                                          {"{answer}", answer.string()},
                                          {"{reads}", std::to_string(request.reads)},
                                          {"{seed}", std::to_string(request.seed)}}));
  const ProcessResult result = run_process(arguments, settings_.time_limit_s);
  if (result.timed_out)
    fail(arguments, "did not end within " + number_text(settings_.time_limit_s) + " s and was killed", result);
  if (result.signal != 0) fail(arguments, "was ended by signal " + std::to_string(result.signal), result);
  if (result.exit_status != 0) fail(arguments, "failed with exit status " + std::to_string(result.exit_status), result);
  if (!fs::exists(answer)) fail(arguments, "ended well but wrote no answer", result);
  return read_rows(problem, answer, request.reads);
}

}  // namespace gonogo::learning
