#include "learning/qubo/foreign_file.h"

#include <algorithm>
#include <cctype>

#include "base/error.h"

namespace gonogo::learning {
namespace {

struct Kind {
  std::string_view magic, name, remedy;
};

constexpr Kind kKinds[] = {
    {"DIMODCQM", "a constrained quadratic model (CQM) of dimod", "convert it with dimod.cqm_to_bqm and write that"},
    {"DIMODDQM", "a discrete quadratic model (DQM) of dimod", "give each case a binary variable and write a BQM"},
    {"DIMODQM", "a quadratic model (QM) of dimod", "write it as a BQM, of variables that are all BINARY or all SPIN"},
    {"PK\x03\x04", "a ZIP archive", "unpack it and give the problem inside"},
    {"\x89HDF\r\n", "an HDF5 file", "give a problem file, as gonogo qubo export writes it"},
};

/// Python's pickle: protocols 2 to 5 begin with 0x80 and their number, and end with a full stop.
bool is_pickle(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == '\x80' && bytes[1] >= 2 && bytes[1] <= 5 && bytes.back() == '.';
}

/// The first word that is not in a comment (LP comments begin with a backslash).
std::string first_word(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    if (std::isspace(static_cast<unsigned char>(text[at])))
      ++at;
    else if (text[at] == '\\')
      at = std::min(text.find('\n', at), text.size());
    else
      break;
  }
  std::string word;
  for (; at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])) && word.size() < 16; ++at)
    word += char(std::tolower(static_cast<unsigned char>(text[at])));
  return word;
}

bool is_lp(std::string_view text) {
  const std::string word = first_word(text);
  return word == "minimize" || word == "maximize" || word == "minimise" || word == "maximise" || word == "minimum" ||
         word == "maximum";
}

}  // namespace

void refuse_foreign_file(std::string_view bytes, const std::string& source) {
  const auto refuse = [&](std::string_view name, std::string_view remedy) {
    throw InputError(source + ": is " + std::string(name) + ", not a binary quadratic problem; " + std::string(remedy));
  };
  for (const Kind& kind : kKinds)
    if (bytes.starts_with(kind.magic)) refuse(kind.name, kind.remedy);
  if (is_pickle(bytes)) refuse("a pickle of Python", "write it with to_file() or to_serializable() of dimod instead");
  if (is_lp(bytes))
    refuse("a linear program (LP file)", "read it with dimod.lp.load and convert it with dimod.cqm_to_bqm");
}

}  // namespace gonogo::learning
