#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/app/learning/qubo_options.h"
#include "pipeline/lab/contact_qubo.h"
#include "sim/local_problem/read.h"

namespace gonogo::app {
namespace {

struct ContactRequest {
  std::string problem, out, csv;
  outcome::FileChoice to;
  int facets = 4;
  lab::ContactEncoding encoding;
  std::vector<std::string> samplers;
  learning::SampleRequest sampling{.reads = 200, .seed = 1, .sweeps = 2000};
};

struct ContactRow {
  std::string sampler;
  int bits = 0;
  std::size_t variables = 0;
  lab::ContactAnswer answer;
};

/// The best row of every sampler for 1, 2, ... bits.
std::vector<ContactRow> sample_contacts(const sim::LocalProblem& problem, const ContactRequest& request) {
  std::vector<ContactRow> rows;
  for (const std::string& name : request.samplers)
    for (int bits = 1; bits <= request.encoding.bits; ++bits) {
      stop_if_cancelled();
      lab::ContactEncoding encoding = request.encoding;
      encoding.bits = bits;
      const lab::ContactQubo qubo = lab::contact_qubo(problem, request.facets, encoding);
      const auto answer = learning::make_sampler(name)->sample(qubo.problem, request.sampling);
      rows.push_back({name, bits, qubo.problem.variable_count(), lab::judge(qubo, problem, answer)});
    }
  return rows;
}

void print_contacts(const Globals& globals, const ContactRequest& request, const std::vector<ContactRow>& rows) {
  std::string text = "sampler      bits variables   energy gap impulse error    ccp error  hits\n";
  std::string csv = "sampler,bits,variables,energy_gap,impulse_error,ccp_error,hit_share\n";
  Json list = Json::array();
  for (const ContactRow& r : rows) {
    const lab::ContactAnswer& a = r.answer;
    text += line("%-12s %4d %9zu %12.3e  %12.3e %12.3e %5.2f\n", r.sampler.c_str(), r.bits, r.variables, a.energy_gap,
                 a.impulse_error, a.ccp_error, a.hit_share);
    csv += line("%s,%d,%zu,%.9g,%.9g,%.9g,%.9g\n", r.sampler.c_str(), r.bits, r.variables, a.energy_gap,
                a.impulse_error, a.ccp_error, a.hit_share);
    Json one;
    one["sampler"] = r.sampler;
    one["bits"] = r.bits;
    one["variables"] = Json(std::uint64_t(r.variables));
    one["energy_gap"] = a.energy_gap;
    one["impulse_error"] = a.impulse_error;
    one["ccp_error"] = a.ccp_error;
    one["hit_share"] = a.hit_share;
    list.push_back(one);
  }
  if (!request.csv.empty()) write_file_atomically(request.csv, csv);
  Json json;
  json["problem"] = request.problem;
  json["facets"] = request.facets;
  json["rows"] = list;
  print_result(globals, json, text);
}

void run_contact(const Globals& globals, const ContactRequest& request) {
  if (request.out.empty() && request.samplers.empty())
    throw InputError("nothing to do: give --out for a problem file, or --sampler to solve it here");
  const sim::LocalProblem problem = sim::read_problem(request.problem);
  if (!request.out.empty()) {
    const lab::ContactQubo qubo = lab::contact_qubo(problem, request.facets, request.encoding);
    outcome::Exported exported = outcome::convert_problem({qubo.problem, std::nullopt}, request.out, request.to);
    exported.notes.push_back(line("%d multipliers of %d bits up to %g, energies times %g; exact minimum %.9g",
                                  qubo.program.unknowns, qubo.encoding.bits, qubo.encoding.range, qubo.encoding.scale,
                                  qubo.program.minimum * qubo.encoding.scale));
    print_export(globals, request.out, exported);
  }
  if (!request.samplers.empty()) print_contacts(globals, request, sample_contacts(problem, request));
}

}  // namespace

void add_qubo_contact(CLI::App& qubo, const Globals& globals) {
  CLI::App* command =
      qubo.add_subcommand("contact", "Write a small contact problem as an annealing problem, and solve it by samplers");
  const std::vector<std::string> samplers = learning::sampler_names(
      [](const learning::SamplerKind& kind) { return kind.any_problem && kind.origin == learning::RowOrigin::here; });
  const auto request = std::make_shared<ContactRequest>();
  add_named(*command, "problem", request->problem, kFile, "Contact problem in a format of FCLib or Siconos")
      ->required();
  add_number(*command, "--facets", request->facets, {4, 256}, "Facets of a friction cone, even");
  add_number(*command, "--bits", request->encoding.bits, {1, 16},
             "Bits of a multiplier; samplers solve for 1 up to these");
  command->add_option("--range", request->encoding.range, "Largest multiplier; 0: a power of 2 above the exact ones")
      ->capture_default_str();
  command->add_option("--scale", request->encoding.scale, "Energy per unit of the objective; 0: the minimum is -20")
      ->capture_default_str();
  CLI::Option* out =
      add_named(*command, "--out", request->out, kFile, "Problem file to write; the sidecar goes beside it");
  add_named(*command, "--format", request->to.format, one_of(format_names()),
            "Format to write; default: by extension, .json being dimod_json");
  add_list(*command, "--sampler", request->samplers, "Samplers that solve it (" + join_words(samplers) + ")")
      ->check(CLI::IsMember(samplers))
      ->excludes(out);
  add_number(*command, "--reads", request->sampling.reads, {1, 100000000}, "Rows of a sampler");
  add_number(*command, "--sweeps", request->sampling.sweeps, {1, 1000000000}, "Sweeps of every chain");
  command->add_option("--seed", request->sampling.seed, "Seed")->check(kSeed)->capture_default_str();
  add_named(*command, "--csv", request->csv, kFile, "Table of the samplers' errors to write");
  add_examples(*command, {"gonogo qubo contact tests/data/fclib/FC3D_Example1.dat --bits 4 --out contact.json",
                          "gonogo qubo contact tests/data/fclib/FC3D_Example1.dat --bits 8 --sampler anneal"});
  request->to.option = "--format";
  calls<run_contact>(*command, globals, request);
}

}  // namespace gonogo::app
