#include <gonogo/qubo.h>

#include <charconv>
#include <limits>
#include <utility>

#include "learning/formats/format.h"
#include "learning/sampler/sampler.h"
#include "pipeline/face/inside.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"

namespace gonogo::api {
namespace {

learning::Vartype vartype_of(Vartype vartype) {
  return vartype == Vartype::spin ? learning::Vartype::spin : learning::Vartype::binary;
}
Vartype vartype_of(learning::Vartype vartype) {
  return vartype == learning::Vartype::spin ? Vartype::spin : Vartype::binary;
}

/// A number where the text is one as to_string() writes it.
learning::Label label_of(const std::string& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc() && end == text.data() + text.size() && std::to_string(number) == text) return number;
  return text;
}

learning::Problem problem_of(const Problem& p) {
  learning::Problem result;
  result.vartype = vartype_of(p.vartype);
  for (const std::string& label : p.labels) result.labels.push_back(label_of(label));
  for (std::size_t v = 0; p.labels.empty() && v < p.linear.size(); ++v) result.labels.emplace_back(std::int64_t(v));
  result.linear = p.linear;
  for (const Coupling& c : p.couplings) result.couplings.push_back({c.a, c.b, c.value});
  learning::sort_couplings(result.couplings);
  result.offset = p.offset;
  learning::check_problem(result, "problem");
  return result;
}

std::vector<std::string> texts_of(const std::vector<learning::Label>& labels) {
  std::vector<std::string> result;
  for (const learning::Label& label : labels) result.push_back(learning::label_text(label));
  return result;
}

Problem problem_of(const learning::Problem& p) {
  Problem result{vartype_of(p.vartype), texts_of(p.labels), p.linear, {}, p.offset};
  for (const learning::Coupling& c : p.couplings) result.couplings.push_back({c.a, c.b, c.value});
  return result;
}

outcome::FileChoice choice_of(const std::string& format) {
  outcome::FileChoice choice;
  choice.format = format;
  choice.option = "format";
  return choice;
}

learning::SampleRequest request_of(const Reads& reads) {
  return {.reads = reads.count, .seed = reads.seed, .sweeps = reads.sweeps};
}

SampleReport report_of(const outcome::SampleReport& r) {
  return {r.reads, r.variables, r.energy_mean, r.energy_lowest};
}

outcome::Decoding decoding_named(const std::string& name) {
  for (const auto decoding : {outcome::Decoding::weigh, outcome::Decoding::discard, outcome::Decoding::repair})
    if (outcome::decoding_name(decoding) == name) return decoding;
  throw gonogo::InputError("decoding " + name + ": there are weigh, discard and repair");
}

}  // namespace

double energy(const Problem& problem, const std::vector<std::int8_t>& row) {
  return guarded([&] {
    const learning::Problem p = problem_of(problem);
    if (row.size() != p.variable_count())
      throw gonogo::InputError("energy: a row of " + std::to_string(row.size()) + " values; the problem has " +
                               std::to_string(p.variable_count()) + " variables");
    return learning::energy(p, row);
  });
}

Problem to_vartype(const Problem& problem, Vartype vartype) {
  return guarded([&] { return problem_of(learning::to_vartype(problem_of(problem), vartype_of(vartype))); });
}

std::vector<std::string> problem_formats() { return learning::names_of(learning::problem_formats()); }

Problem read_problem(const std::filesystem::path& file, const std::string& format) {
  return guarded([&] { return problem_of(outcome::load_problem(file, choice_of(format)).problem); });
}

std::vector<std::string> write_problem(const Problem& problem, const std::filesystem::path& file,
                                       const std::string& format) {
  return guarded([&] { return outcome::write_problem_file(problem_of(problem), {}, file, choice_of(format)).notes; });
}

std::vector<SamplerInfo> samplers() {
  std::vector<SamplerInfo> result;
  for (const learning::SamplerKind* kind : learning::samplers()) {
    SamplerInfo info{kind->name, kind->about, {}, kind->any_problem, kind->follows_energies};
    for (const learning::SamplerParameter& p : kind->parameters)
      info.parameters.push_back({p.name, p.help, p.fallback});
    result.push_back(std::move(info));
  }
  return result;
}

SampleSet sample(const Problem& problem, const Sampler& sampler, const Reads& reads) {
  return guarded([&] {
    learning::SampleSet rows =
        learning::make_sampler(sampler.name, sampler.settings)->sample(problem_of(problem), request_of(reads));
    return SampleSet{vartype_of(rows.vartype), texts_of(rows.labels), std::move(rows.values), std::move(rows.energies),
                     std::move(rows.occurrences)};
  });
}

std::vector<std::string> export_problem(const ExportRequest& r) {
  return guarded([&] {
    return outcome::export_problem(map::find_model(r.model), r.problem, r.clamped, vartype_of(r.vartype),
                                   choice_of(r.format), r.code_penalty)
        .notes;
  });
}

SampleReport sample_file(const std::filesystem::path& problem, const std::filesystem::path& answer,
                         const Sampler& sampler, const Reads& reads) {
  return guarded([&] {
    return report_of(outcome::sample_problem(
        problem, answer, *outcome::sampler_for(problem, sampler.name, sampler.settings), request_of(reads)));
  });
}

SampleReport sample_emulated(const std::filesystem::path& problem, const std::filesystem::path& answer,
                             const EmulatedAnnealer& annealer, const Reads& reads) {
  return guarded([&] {
    outcome::DeviceChoice device;
    device.graph.name = annealer.graph;
    device.graph.dead_share = annealer.dead_share;
    device.temperature = annealer.temperature;
    return report_of(outcome::sample_emulated(problem, answer, device, request_of(reads)));
  });
}

ImportedAnswer import_answer(const ImportRequest& r) {
  return guarded([&] {
    outcome::ImportRequest request;
    request.problem = r.problem;
    request.answer = r.answer;
    request.answer_format = r.answer_format;
    request.model = r.model;
    request.rows = r.rows;
    request.decoding = decoding_named(r.decoding);
    request.limits = {r.min_reads, r.min_share};
    const outcome::ImportedAnswer answer = outcome::import_answer(request);
    ImportedAnswer result;
    result.reads = answer.reads;
    if (answer.chains) result.broken_chains = answer.chains->break_fraction;
    if (!answer.summary) return result;
    const outcome::AnswerSummary& s = *answer.summary;
    result.reads = s.reads;
    result.valid = s.valid;
    result.independent_reads = s.independent_reads;
    result.bias = s.bias.verdict;
    for (const auto& o : s.outcomes)
      result.outcomes.push_back({o.name, o.frequency.mean, o.frequency.standard_error, o.machine});
    return result;
  });
}

EmbedResult embed(const EmbedRequest& r) {
  return guarded([&] {
    outcome::EmbedRequest request;
    request.problem = r.problem;
    request.out = r.out;
    request.graph.name = r.graph;
    request.graph.dead_share = r.dead_share;
    request.method = r.method;
    request.chain_strength = r.chain_strength;
    request.gauge = r.gauge;
    request.auto_scale = r.auto_scale;
    request.time_limit_s = r.time_limit;
    const outcome::EmbedResult e = outcome::embed_problem_file(request);
    return EmbedResult{.variables = e.variables,
                       .qubits = e.qubits,
                       .longest_chain = e.longest_chain,
                       .chain_strength = e.chain_strength,
                       .scale = e.scale,
                       .notes = e.exported.notes};
  });
}

}  // namespace gonogo::api
