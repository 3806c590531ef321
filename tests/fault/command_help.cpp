// What the program says of itself: help, man page, completions; and what it loads for that.
#include <cstdlib>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/fault/shell.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

using Words = std::vector<std::string>;

Words lines_of(const std::string& text) {
  Words lines(1);
  for (const char c : text) {
    if (c == '\n')
      lines.emplace_back();
    else
      lines.back() += c;
  }
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Candidates for the last of `words`, without their descriptions; the last one says which files fit.
Words candidates(const Words& words) {
  const Ending ending = run_gonogo(with({"complete", "--"}, words));
  REQUIRE(ending.exit_code == 0);
  Words result;
  for (const std::string& line : lines_of(ending.out)) result.push_back(line.substr(0, line.find('\t')));
  return result;
}

/// Every command of the program, with all that are below.
std::vector<Words> all_commands(const Words& above = {}) {
  std::vector<Words> result;
  if (!above.empty() && !contains(run_gonogo(with({"help"}, above)).out, "Subcommands:")) return result;
  Words names = candidates(with(above, {""}));
  names.pop_back();
  for (const std::string& name : names) {
    const Words command = with(above, {name});
    result.push_back(command);
    for (const Words& below : all_commands(command)) result.push_back(below);
  }
  return result;
}

std::string joined(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// The command lines at the end of a help, each as one line without its remark.
Words examples_of(const std::string& help) {
  Words examples;
  bool inside = false, open = false;
  for (const std::string& line : lines_of(help)) {
    if (line == "Example:" || line == "Examples:") {
      inside = true;
      continue;
    }
    if (!inside) continue;
    INFO(line);
    CHECK(line.rfind(open ? "      " : "  ", 0) == 0);
    CHECK((open || line.rfind("  gonogo ", 0) == 0 || line.rfind("  mpirun ", 0) == 0));
    std::string part = line.substr(0, line.find("  # "));
    const bool goes_on = part.back() == '\\';
    if (goes_on) part.pop_back();
    if (open)
      examples.back() += part;
    else
      examples.push_back(part);
    open = goes_on;
  }
  CHECK_FALSE(open);
  return examples;
}

/// The words of the program's part of a line: after its name, before a redirection or a pipe.
Words words_of(const std::string& line) {
  Words words(1);
  for (const char c : line.substr(line.find("gonogo ") + 7)) {
    if (c == '>' || c == '|') break;
    if (c == ' ')
      words.emplace_back();
    else
      words.back() += c;
  }
  std::erase(words, "");
  return words;
}

TEST_CASE("every command explains itself with examples that parse") {
  const std::vector<Words> commands = all_commands();
  CHECK(commands.size() > 60);
  for (const Words& command : commands) {
    INFO(joined(command));
    const Ending help = run_gonogo(with(command, {"--help"}));
    CHECK(help.exit_code == 0);
    CHECK(help.err == "");
    CHECK(run_gonogo(with({"help"}, command)).out == help.out);
    const Words examples = examples_of(help.out);
    REQUIRE_FALSE(examples.empty());
    CHECK(contains(examples.front(), "gonogo " + joined(command)));
    for (const std::string& example : examples) {
      const Ending ending = run_gonogo(with({"parse", "--"}, words_of(example)));
      INFO(example << ": " << ending.err);
      CHECK(ending.exit_code == 0);
    }
  }
}

TEST_CASE("a line that does not parse is refused by the question that checks lines, and nothing is done") {
  check_refusal(run_gonogo({"parse", "--", "doctor", "--ot", "x"}), 2, {"\"--ot\" is no option", "\"--out\""});
  const Ending fine = run_gonogo({"parse", "--", "run", "/none.json", "--out", "/none"});
  CHECK(fine.exit_code == 0);
  CHECK(fine.out + fine.err == "");
}

TEST_CASE("help of what is no command names the nearest") {
  CHECK(run_gonogo({"help"}).out == run_gonogo({"--help"}).out);
  check_refusal(run_gonogo({"help", "soil", "tst"}), 2, {"\"tst\" is no command of gonogo soil", "\"test\""});
  check_refusal(run_gonogo({"help", "doctor", "x"}), 2, {"\"x\" is no command of gonogo doctor", "has none"});
}

TEST_CASE("commands, options and values complete") {
  CHECK(candidates({"soi"}) == Words{"soil", ":none"});
  CHECK(candidates({"--json", "soil", "te"}) == Words{"test", ":none"});
  CHECK(candidates({"soil", "test", "shear", "--grain-"}) == Words{"--grain-density", ":none"});
  CHECK(candidates({"soil", "test", "shear", "--grain", "0.1", "--thr"}) == Words{"--threads", ":none"});
  CHECK(candidates({"bench", "bed", "--backend", ""}) == Words{"cpu", "cuda", ":none"});
  CHECK(candidates({"bench", "bed", "--backend=cu"}) == Words{"--backend=cuda", ":none"});
  CHECK(candidates({"bench", "bed", "--backend", "=", "cu"}) == Words{"cuda", ":none"});
  CHECK(candidates({"validate", "soils", "trip"}) == Words{":none"});
  CHECK(candidates({"validate", "wheels", "--nomi"}) == Words{"--nominal", ":none"});
  CHECK(candidates({"validate", "soils", "shear", "tri"}) == Words{"triaxial", ":none"});
  CHECK(candidates({"help", "soil", "cal"}) == Words{"calibrate", ":none"});
  CHECK(candidates({"completion", ""}) == Words{"bash", "zsh", "fish", ":none"});
  CHECK(candidates({"vehicle", "show", "hmmwv_q"}) == Words{"hmmwv_quarter", ":file"});
  CHECK(candidates({"soil", "show", "sandy"}) == Words{"sandy_loam", ":file"});
  CHECK(candidates({"simulate", "--soil", "calibration_9"}) == Words{"calibration_90mm", ":file"});
  CHECK(candidates({"run", "configs/"}) == Words{":file"});
  CHECK(candidates({"run", "--out", ""}) == Words{":folder"});
  CHECK(candidates({"infer", "--set", "slope_al"}) == Words{"slope_along=", ":none"});
  CHECK(candidates({"dataset", "merge", "a.h5", "b.h5", ""}) == Words{":file"});
  CHECK(candidates({"doctor", "x", ""}) == Words{":none"});
  CHECK(candidates({"campaign", "wor"}) == Words{":none"});  // hidden
}

/// What bash offers at the end of `line` after the completion of `program` was loaded, in `folder`.
Words bash_offers(const std::filesystem::path& folder, const std::string& line) {
  const std::string program = gonogo_program().string();
  const std::string script = "cd " + folder.string() + " && source <(" + program +
                             " completion bash) && complete -p gonogo > /dev/null && COMP_WORDS=(" + program + " " +
                             line +
                             ") && COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) && _gonogo && "
                             "printf '%s\\n' \"${COMPREPLY[@]}\"";
  write_file_atomically(folder / "script.bash", script);
  const ShellEnding ending = shell("bash --norc " + (folder / "script.bash").string());
  INFO(ending.output);
  REQUIRE(ending.status == 0);
  Words words = lines_of(ending.output);
  std::erase(words, "");
  return words;
}

TEST_CASE("bash completes by the program's script") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "my study.json", "{}");
  write_file_atomically(folder / "runs/out.txt", "");
  std::filesystem::create_directory(folder / "configs");
  std::filesystem::create_directory_symlink(GONOGO_SOURCE_DIR "/configs/vehicles", folder / "configs/vehicles");
  CHECK(bash_offers(folder.path(), "camp") == Words{"campaign"});
  CHECK(bash_offers(folder.path(), "campaign st") == Words{"status"});
  CHECK(bash_offers(folder.path(), "campaign run --eng") == Words{"--engine"});
  CHECK(bash_offers(folder.path(), "campaign run --engine ''") == Words{"local", "mpi"});
  CHECK(bash_offers(folder.path(), "campaign run --engine = m") == Words{"mpi"});
  CHECK(bash_offers(folder.path(), "vehicle show hmmwv_q") == Words{"hmmwv_quarter"});
  CHECK(bash_offers(folder.path(), "run my") == Words{"my study.json"});
  CHECK(bash_offers(folder.path(), "run a.json --out r") == Words{"runs"});
  CHECK(bash_offers(folder.path(), "doctor --thread") == Words{"--threads"});
  CHECK(bash_offers(folder.path(), "docterr") == Words{});
}

TEST_CASE("the other shells take their scripts, where they are here") {
  const TemporaryFolder folder;
  for (const char* name : {"bash", "zsh", "fish"}) {
    const Ending ending = run_gonogo({"completion", name});
    CHECK(ending.exit_code == 0);
    write_file_atomically(folder / name, ending.out);
    if (shell(std::string("command -v ") + name).status != 0) continue;
    const ShellEnding syntax = shell(std::string(name) + " -n " + (folder / name).string());
    INFO(name << ": " << syntax.output);
    CHECK(syntax.status == 0);
  }
  check_refusal(run_gonogo({"completion", "tcsh"}), 2, {"tcsh", "bash", "zsh", "fish"});
}

TEST_CASE("the man page holds every command and formats without a warning") {
  const TemporaryFolder folder;
  const Ending ending = run_gonogo({"man"});
  REQUIRE(ending.exit_code == 0);
  const std::string page = folder / "gonogo.1";
  write_file_atomically(page, ending.out);
  for (const Words& command : all_commands()) {
    INFO(joined(command));
    std::string name = joined(command);
    for (std::size_t at = 0; (at = name.find('-', at)) != std::string::npos; at += 2) name.insert(at, "\\");
    CHECK(contains(ending.out, ".SS gonogo " + name + "\n"));
  }
  if (shell("command -v man").status == 0) {
    const ShellEnding formatted =
        shell("MANWIDTH=100 LC_ALL=C.UTF-8 man --warnings -l -Tutf8 " + page + " > /dev/null");
    INFO(formatted.output);
    CHECK(formatted.status == 0);
    CHECK(formatted.output == "");
  }
  if (shell("command -v mandoc").status == 0) {
    const ShellEnding lint = shell("mandoc -Tlint -Werror " + page);
    INFO(lint.output);
    CHECK(lint.status == 0);
  }
}

TEST_CASE("short commands load neither LibTorch nor GDAL") {
  RunOptions trace;
  trace.before = [] { ::setenv("LD_TRACE_LOADED_OBJECTS", "1", 1); };
  const std::string libraries = run_gonogo({"--version"}, trace).out;
  CHECK(contains(libraries, "libc.so"));
  CHECK_FALSE(contains(libraries, "libtorch"));
  CHECK_FALSE(contains(libraries, "libgdal"));
  CHECK(lines_of(libraries).size() < 100);
}

#ifdef GONOGO_WITH_TORCH
TEST_CASE("a program without the one beside it that does a command's work says so") {
  const TemporaryFolder folder;
  std::filesystem::copy_file(gonogo_program(), folder / "gonogo");
  const std::string lonely = folder / "gonogo";
  CHECK(shell(lonely + " --version").status == 0);
  const ShellEnding ending = shell(lonely + " train --dataset a.h5 --out b.h5");
  CHECK(ending.status == 1);
  CHECK(contains(ending.output, "gonogo-learn: cannot be started: No such file or directory"));
}

TEST_CASE("work in another program keeps the name, the process and the streams") {
  const ShellEnding ending = shell("bash -c 'exec -a nickname " + gonogo_program().string() +
                                   " train --dataset /none.h5 --out b.h5 --json 2> /dev/null'");
  CHECK(ending.status == 2);
  CHECK(contains(ending.output, "\"kind\":\"bad_input\""));
  CHECK(contains(ending.output, "/none.h5"));
}
#endif

}  // namespace
}  // namespace gonogo
