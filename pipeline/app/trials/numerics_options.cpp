#include "pipeline/app/trials/numerics_options.h"

#include <type_traits>

#include "sim/law/contact_law.h"

namespace gonogo::app {
namespace {

/// `Values`: terrain::Numerics, whose values are the defaults, or terrain::AskedNumerics, whose are told by `from`.
template <class Values>
void add_options(CLI::App& command, Values& n, const std::string& whose, const std::string& from, bool tolerance) {
  const auto add = [&](const char* name, auto& value, const char* about, auto low, auto high) {
    CLI::Option* option = command.add_option(name, value, whose + about + from)->check(CLI::Range(low, high));
    if (from.empty()) option->capture_default_str();
  };
  add("--step", n.step, ": step [s]", 1e-5, 5e-3);
  add("--substeps", n.substeps, ": substeps of a step", 1, 1000);
  add("--iterations", n.iterations, ": max iterations of a substep", 1, 100000);
  if (tolerance) add("--tolerance", n.tolerance, ": residual at which the solver stops [m/s]; 0: never", 0.0, 1.0);
  add("--give", n.give,
      ": compliance of contacts; 0.6 keeps beds from creeping with few iterations in many substeps, 0: rigid", 0.0,
      10.0);
  const auto set_target = [&n](const std::string& name) { n.target = sim::target_named(name); };
  CLI::Option* target = command.add_option_function<std::string>(
      "--target", set_target,
      whose + ": cone program of the contacts; with ccp they open as they slide or roll" + from);
  target->check(CLI::IsMember(sim::target_names()));
  if constexpr (std::is_same_v<Values, terrain::Numerics>) target->default_str(sim::name_of(n.target));
  const auto set_contact = [&n](const std::string& name) { n.contact = sim::contact_named(name); };
  command
      .add_option_function<std::string>(
          "--contact", set_contact,
          whose + ": cone program, or springs between overlapping grains, which need far shorter steps" + from)
      ->check(CLI::IsMember(sim::contact_names()));
  command
      .add_option("--overlap", n.overlap,
                  whose + ": largest overlap of springs over the radius, in an impact at 2 m/s; 0.02 unless told")
      ->check(CLI::Range(1e-5, 0.2));
}

}  // namespace

void add_numerics_options(CLI::App& command, terrain::Numerics& numerics, const std::string& whose) {
  add_options(command, numerics, whose, "", true);
}

void add_asked_numerics_options(CLI::App& command, terrain::AskedNumerics& asked, const std::string& whose,
                                bool tolerance) {
  add_options(command, asked, whose, "; default: the soil table's", tolerance);
}

void add_wheel_rolling_option(CLI::App& command, double& rolling) {
  add_number(
      command, "--wheel-rolling", rolling, {0.0, 10.0},
      "Rolling friction of grains on the rims of wheels, over that between grains [-]; on lugs they roll freely");
}

bool numerics_given(const CLI::App& command) {
  for (const char* name :
       {"--step", "--substeps", "--iterations", "--tolerance", "--target", "--give", "--contact", "--overlap"})
    if (command.get_option_no_throw(name) && command.count(name) > 0) return true;
  return false;
}

}  // namespace gonogo::app
