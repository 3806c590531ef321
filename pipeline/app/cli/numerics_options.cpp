#include "pipeline/app/cli/numerics_options.h"

#include <functional>

#include "sim/scene/contact_name.h"
#include "sim/scene/target_name.h"

namespace gonogo::app {
namespace {

/// `Overlap`: a number, or an optional one.
template <class Overlap>
void add_contact_options(CLI::App& command, const std::function<void(const std::string&)>& choose, Overlap& overlap,
                         const std::string& whose, const std::string& from) {
  command
      .add_option_function<std::string>(
          "--contact", choose,
          whose + ": cone program, or springs between overlapping grains, which need far shorter steps" + from)
      ->check(CLI::IsMember(sim::contact_names()));
  command
      .add_option("--overlap", overlap,
                  whose + ": largest overlap of springs over the radius, in an impact at 2 m/s; 0.02 unless told")
      ->check(CLI::Range(1e-5, 0.2));
}

}  // namespace

void add_numerics_options(CLI::App& command, terrain::Numerics& n, const std::string& whose) {
  command.add_option("--step", n.step, whose + ": step [s]")->check(CLI::Range(1e-5, 5e-3))->capture_default_str();
  command.add_option("--substeps", n.substeps, whose + ": substeps of a step")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--iterations", n.iterations, whose + ": max iterations of a substep")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command.add_option("--tolerance", n.tolerance, whose + ": residual at which the solver stops [m/s]; 0: never")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  const auto set = [&n](const std::string& name) { n.target = sim::target_named(name); };
  command
      .add_option_function<std::string>(
          "--target", set, whose + ": cone program of the contacts; with ccp they open as they slide or roll")
      ->check(CLI::IsMember(sim::target_names()))
      ->default_str(sim::name_of(n.target));
  const auto choose = [&n](const std::string& name) { n.contact = sim::contact_named(name); };
  add_contact_options(command, choose, n.overlap, whose, "");
}

void add_asked_numerics_options(CLI::App& command, terrain::AskedNumerics& asked, const std::string& whose,
                                bool tolerance) {
  const std::string from = "; default: the soil table's";
  command.add_option("--step", asked.step, whose + ": step [s]" + from)->check(CLI::Range(1e-5, 5e-3));
  command.add_option("--substeps", asked.substeps, whose + ": substeps of a step" + from)->check(CLI::Range(1, 1000));
  command.add_option("--iterations", asked.iterations, whose + ": max iterations of a substep" + from)
      ->check(CLI::Range(1, 100000));
  if (tolerance)
    command
        .add_option("--tolerance", asked.tolerance,
                    whose + ": residual at which the solver stops [m/s]; 0: never" + from)
        ->check(CLI::Range(0.0, 1.0));
  const auto set = [&asked](const std::string& name) { asked.target = sim::target_named(name); };
  command
      .add_option_function<std::string>(
          "--target", set, whose + ": cone program of the contacts; with ccp they open as they slide or roll" + from)
      ->check(CLI::IsMember(sim::target_names()));
  const auto choose = [&asked](const std::string& name) { asked.contact = sim::contact_named(name); };
  add_contact_options(command, choose, asked.overlap, whose, from);
}

void add_wheel_rolling_option(CLI::App& command, double& rolling) {
  command
      .add_option(
          "--wheel-rolling", rolling,
          "Rolling friction of grains on the rims of wheels, over that between grains [-]; on lugs they roll freely")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
}

bool numerics_given(const CLI::App& command) {
  for (const char* name : {"--step", "--substeps", "--iterations", "--tolerance", "--target", "--contact", "--overlap"})
    if (command.get_option_no_throw(name) && command.count(name) > 0) return true;
  return false;
}

}  // namespace gonogo::app
