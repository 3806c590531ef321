#include "pipeline/campaign/engine/cluster/slurm.h"

#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/shell.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMaxTasks = 1000;  // below Slurm's usual MaxArraySize of 1001

fs::path slurm_folder(const fs::path& folder) { return folder / "slurm"; }
fs::path jobs_file(const fs::path& folder) { return slurm_folder(folder) / "jobs.txt"; }

/// Throws InputError for text that would end a line of job.sh and so become a command of its own.
void require_one_line(const std::string& text, const std::string& what) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127)
      throw InputError("campaign submit: " + what + " holds a line break or another control character; leave it out");
}

/// A folder of an #SBATCH line that names a file, to stand in double quotes. "%" is doubled, since it begins a
/// replacement symbol (manual page of sbatch, "filename pattern").
std::string sbatch_folder(const fs::path& folder) {
  std::string text;
  for (const char c : folder.string()) {
    if (c == '"' || c == '\\') text += '\\';
    if (c == '%') text += '%';
    text += c;
  }
  return text;
}

struct Answer {
  int status = -1;
  std::string text;
};

/// Standard output and error of a command line.
Answer ask(const std::string& command) {
  Answer answer;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "re");
  if (!pipe) return answer;
  char bytes[4096];
  for (std::size_t count; (count = std::fread(bytes, 1, sizeof bytes, pipe)) > 0;) answer.text.append(bytes, count);
  const int status = ::pclose(pipe);
  answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  while (!answer.text.empty() && answer.text.back() == '\n') answer.text.pop_back();
  return answer;
}

/// Numbers of the tasks that have something to do: shard k belongs to task k % tasks.
std::set<std::uint64_t> tasks_of(const std::vector<std::uint64_t>& shards, std::uint64_t tasks) {
  std::set<std::uint64_t> numbers;
  for (const std::uint64_t shard : shards) numbers.insert(shard % tasks);
  return numbers;
}

std::string array_text(const std::set<std::uint64_t>& numbers) {
  std::string text;
  for (auto at = numbers.begin(); at != numbers.end();) {
    const std::uint64_t first = *at;
    std::uint64_t last = first;
    while (++at != numbers.end() && *at == last + 1) last = *at;
    text += (text.empty() ? "" : ",") + std::to_string(first);
    if (last > first) text += "-" + std::to_string(last);
  }
  return text;
}

std::string script_text(const CampaignRequest& campaign, const SlurmRequest& slurm,
                        const std::set<std::uint64_t>& tasks, std::uint64_t count) {
  std::string text = "#!/bin/sh\n#SBATCH --job-name=gonogo\n#SBATCH --array=" + array_text(tasks) + "\n";
  text += "#SBATCH --output=\"" + sbatch_folder(slurm_folder(fs::absolute(campaign.folder))) + "/task-%a.log\"\n";
  text += "#SBATCH --open-mode=append\n";
  for (const std::string& option : slurm.options) text += "#SBATCH " + option + "\n";
  text += "exec";
  for (const std::string& word : slurm.task_command) text += " " + shell_word(word);
  return text + " --task \"$SLURM_ARRAY_TASK_ID\" --tasks " + std::to_string(count) + "\n";
}

}  // namespace

Submission submit_campaign(const CampaignRequest& campaign, const SlurmRequest& slurm) {
  Submission result;
  require_one_line(fs::absolute(campaign.folder).string(), "the folder");
  for (const std::string& option : slurm.options) require_one_line(option, "an option for sbatch");
  for (const std::string& word : slurm.task_command) require_one_line(word, "the command line");
  if (const std::string state = slurm_state(campaign.folder); !state.empty())
    throw InputError(campaign.folder.string() + ": was submitted already (" + state +
                     "); wait for the end, or scancel it and submit again");
  const std::vector<std::uint64_t> shards = open_campaign(campaign);
  result.shards = shards.size();
  if (shards.empty()) return result;
  const std::uint64_t all = read_claim(campaign.folder).count();
  const std::uint64_t count =
      std::min(slurm.tasks > 0 ? std::uint64_t(slurm.tasks) : kMaxTasks, std::min(all, kMaxTasks));
  const std::set<std::uint64_t> tasks = tasks_of(shards, count);
  result.tasks = tasks.size();
  result.script = slurm_folder(campaign.folder) / "job.sh";
  write_file_atomically(result.script, script_text(campaign, slurm, tasks, count));
  const Answer answer = ask("sbatch --parsable " + shell_word(result.script.string()));
  if (answer.status != 0)
    throw DeviceError("sbatch refused the job (" + (answer.text.empty() ? "no answer" : answer.text) +
                      "); the script is " + result.script.string());
  result.job = answer.text.substr(0, answer.text.find(';'));
  std::ofstream(jobs_file(campaign.folder), std::ios::app) << result.job << "\n";
  return result;
}

std::string slurm_state(const fs::path& folder) {
  std::ifstream in(jobs_file(folder));
  std::string text;
  for (std::string job; std::getline(in, job);) {
    if (job.empty() || job.find_first_not_of("0123456789") != std::string::npos) continue;
    const Answer answer =
        ask("squeue --noheader --array --states=PENDING,RUNNING,COMPLETING,SUSPENDED --format=%T --jobs=" + job);
    if (answer.status != 0) continue;  // Slurm has forgotten it, or is not here
    std::map<std::string, std::size_t> states;
    std::istringstream lines(answer.text);
    for (std::string state; std::getline(lines, state);) {
      for (char& c : state) c = char(std::tolower(static_cast<unsigned char>(c)));
      if (!state.empty()) ++states[state];
    }
    if (states.empty()) continue;
    std::vector<std::string> counts;
    for (const auto& [state, number] : states) counts.push_back(std::to_string(number) + " " + state);
    text += line("%sjob %s: ", text.empty() ? "" : "; ", job.c_str()) + join_words(counts);
  }
  return text;
}

}  // namespace gonogo::campaign
