// gonogo vehicle new: a vehicle file from a data sheet's numbers, as options or as answers at a terminal.
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/shell.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/trials/vehicle_commands.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/setup/vehicle_study.h"
#include "pipeline/inspect/vehicle_report.h"
#include "vehicle/family/data_sheet.h"

namespace gonogo::app {
namespace {

/// A number that the sheet must have: its option, and the question at a terminal.
struct Needed {
  const char *option, *question;
};
constexpr Needed kNeeded[] = {
    {"mass", "mass, loaded [kg]"},
    {"axles", "axles, 2 to 4"},
    {"wheelbase", "wheelbase [m]; from axle to axle from the front, with commas, if there are more than two"},
    {"track", "track, middle of left tyre to middle of right tyre [m]"},
    {"tyre", "tyre size, such as 37x12.50R16.5, 395/85R20, 16.00R20, or 0.5x0.2 in metres"},
    {"power", "power [kW]"},
    {"top-speed", "top speed [km/h]"},
    {"clearance", "ground clearance [m]"}};
/// Asked for too, but an empty answer leaves them to their rules.
constexpr Needed kAsked[] = {{"inflation", "tyre pressure off the road [kPa]; empty: as for soft ground"},
                             {"centre-height", "height of the centre of mass [m]; empty: by the track"}};

struct NewOptions {
  std::string name, out;
  std::map<std::string, std::string> given;  // option -> text
  std::vector<std::string> sources;
};

[[noreturn]] void refuse_text(const std::string& option, const std::string& text, const std::string& wanted) {
  throw InputError("--" + option + " \"" + text + "\": " + wanted);
}

double number_of(const std::string& option, const std::string& text) {
  const auto value = parsed<double>(text);
  if (!value) refuse_text(option, text, "is no number; write it with a point and without its unit");
  return *value;
}

std::vector<double> numbers_of(const std::string& option, const std::string& text) {
  std::vector<double> list;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    list.push_back(number_of(option, text.substr(at, comma - at)));
    at = comma + 1;
  }
  return list;
}

std::string trimmed(std::string text) {
  text.erase(0, text.find_first_not_of(" \t"));
  text.erase(text.find_last_not_of(" \t\r") + 1);
  return text;
}

/// Asks for what is missing at a terminal; elsewhere throws InputError that lists it.
void ask_for_missing(NewOptions& o) {
  std::vector<std::string> missing;
  for (const Needed& n : kNeeded)
    if (!o.given.count(n.option)) missing.push_back(std::string("--") + n.option);
  if (missing.empty()) return;
  if (!isatty(STDIN_FILENO)) throw InputError("vehicle new: missing: " + join_words(missing));
  const auto ask = [&](const Needed& n, bool needed) {
    if (o.given.count(n.option)) return;
    std::string answer;
    do {
      std::cerr << n.question << ": " << std::flush;
      if (!std::getline(std::cin, answer)) throw InputError(std::string("vehicle new: no answer for --") + n.option);
      answer = trimmed(answer);
    } while (needed && answer.empty());
    if (!answer.empty()) o.given[n.option] = answer;
  };
  for (const Needed& n : kNeeded) ask(n, true);
  for (const Needed& n : kAsked) ask(n, false);
}

template <class Value>
Value choice_of(const std::string& option, const std::string& text, const std::map<std::string, Value>& values) {
  const auto found = values.find(text);
  if (found != values.end()) return found->second;
  std::vector<std::string> words;
  for (const auto& [word, value] : values) words.push_back(word);
  refuse_text(option, text, "is not one of: " + join_words(words));
}

vehicle::DataSheet sheet_of(const NewOptions& o) {
  vehicle::DataSheet s;
  s.name = o.name;
  const auto text = [&](const char* option) -> const std::string& { return o.given.at(option); };
  const auto number = [&](const char* option) { return number_of(option, text(option)); };
  const auto optional = [&](const char* option, double unit, std::optional<double>& value) {
    if (o.given.count(option)) value = unit * number(option);
  };
  const auto whole = [&](const char* option) {
    const double x = number(option);
    if (x != double(int(x))) refuse_text(option, text(option), "is no whole number");
    return int(x);
  };
  s.mass = number("mass");
  s.axles = whole("axles");
  s.wheelbase = numbers_of("wheelbase", text("wheelbase"));
  s.track = number("track");
  s.tyre = vehicle::read_tyre_size(text("tyre"));
  s.power = 1e3 * number("power");
  s.top_speed = number("top-speed") / kKmPerHour;
  s.clearance = number("clearance");
  optional("inflation", 1e3, s.inflation);
  optional("deflection", 1, s.deflection);
  optional("centre-height", 1, s.centre_height);
  optional("centre-behind", 1, s.centre_behind);
  optional("tread-width", 1, s.tread_width);
  optional("lug-height", 1, s.lug_height);
  optional("lug-thickness", 1, s.lug_thickness);
  optional("tractive-force", 1, s.tractive_force);
  optional("friction", 1, s.friction);
  if (o.given.count("lug-count")) s.lug_count = whole("lug-count");
  if (o.given.count("load-index")) s.load_index = whole("load-index");
  if (o.given.count("driven-axles")) s.driven_axles = whole("driven-axles");
  if (o.given.count("gravity")) s.gravity = number("gravity");
  if (o.given.count("suspension"))
    s.build = choice_of<vehicle::Build>("suspension", text("suspension"),
                                        {{"rigid", vehicle::Build::rigid}, {"wishbones", vehicle::Build::sprung}});
  if (o.given.count("drive"))
    s.drive = choice_of<vehicle::Power>("drive", text("drive"),
                                        {{"motors", vehicle::Power::wheel_motors}, {"engine", vehicle::Power::engine}});
  if (o.given.count("differential"))
    s.differential =
        choice_of<std::string>("differential", text("differential"), {{"open", "open"}, {"locked", "locked"}});
  std::string sheet = "Given to gonogo vehicle new:";
  for (const auto& [option, value] : o.given) sheet += " --" + option + " " + value;
  s.sources = o.sources;
  s.sources.push_back(sheet);
  return s;
}

/// The steps from here to a map, as docs/vehicles.md explains them. `file`: as a shell takes it.
std::string next_steps(const vehicle::Vehicle& v, const std::string& file) {
  constexpr double grains = 2.5;  // across a tread, for a first look
  const std::string table = campaign::coarsest_table(vehicle::tread_width(v), grains).stem().string();
  return "next\n  gonogo vehicle show " + file + "\n  gonogo vehicle feasible " + file +
         " --slope 15 --mu 0.6\n  gonogo simulate --vehicle " + file + " --soil " + table +
         (campaign::is_foldable(v) ? " --folded" : "") + " --slope 5\n  gonogo map --vehicle " + file +
         " --dem elevation.tif --soil sand --out out/map\n";
}

void make(const Globals& globals, NewOptions options) {
  const std::filesystem::path out = options.out.empty() ? options.name + ".json" : options.out;
  if (std::filesystem::exists(out))
    throw InputError(out.string() + ": exists already, and is kept; give another file with --out, or remove it");
  ask_for_missing(options);
  const vehicle::DataSheet sheet = sheet_of(options);
  const vehicle::VehicleFile file = vehicle::vehicle_file(sheet);
  const std::string text = file.json.dump(2) + "\n";
  const vehicle::Vehicle made = vehicle::read_vehicle(Config::parse(text, out.string()));
  const inspect::Report shown = inspect::show_vehicle(made);
  write_file_atomically(out, text);
  Json result = Json::object();
  result["file"] = out.string();
  result["tyre_diameter_m"] = sheet.tyre.diameter;
  result["assumed"] = file.assumed;
  result["vehicle"] = shown.json;
  std::string told = "tyre " + sheet.tyre.text +
                     line(": %.3f m high, %.3f m wide: ", sheet.tyre.diameter, sheet.tyre.section_width) +
                     sheet.tyre.rule + "\nassumed, and changed by an option or in the file\n";
  for (const std::string& a : file.assumed) told += "  " + a + "\n";
  print_result(globals, result,
               told + "\nwritten to " + out.string() + "\n" + next_steps(made, shell_word(out.string())));
}

}  // namespace

void add_vehicle_new(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command =
      vehicle.add_subcommand("new", "Write a vehicle file from the numbers of a data sheet; asks at a terminal");
  const auto options = std::make_shared<NewOptions>();
  command->add_option("name", options->name, "Name of the vehicle")->required();
  const auto add = [&](const std::string& name, const std::string& kind, const std::string& about) {
    command
        ->add_option_function<std::string>(
            "--" + name, [options, name](const std::string& text) { options->given[name] = trimmed(text); }, about)
        ->type_name(kind);
  };
  for (const Needed& n : kNeeded) add(n.option, "VALUE", std::string(n.question));
  add("inflation", "kPa", "Tyre pressure off the road; or give --deflection");
  add("deflection", "m", "Static deflection of a tyre on hard ground, 0 for a rigid wheel");
  add("centre-height", "m", "Height of the centre of mass over the ground");
  add("centre-behind", "m", "Distance of the centre of mass behind the front axle");
  add("load-index", "INDEX",
      "Load index of the tyre, 0 to 200; by default the load formula of the Tire and Rim Association");
  add("tread-width", "m", "Width of the tread");
  add("lug-height", "m", "Height of lugs or grousers, 0 for smooth wheels");
  add("lug-count", "COUNT", "Lugs around a wheel");
  add("lug-thickness", "m", "Thickness of a lug along the tread");
  add("driven-axles", "COUNT", "Driven axles, counted from the rear; by default all");
  add("tractive-force", "SHARE", "Largest tractive force of the lowest gear, over the weight");
  add("friction", "SHARE", "Friction coefficient of the tread on hard ground");
  add("suspension", one_of({"rigid", "wishbones"}), "Wheels fixed to the chassis, or sprung");
  add("drive", one_of({"motors", "engine"}), "A motor in every driven wheel, or an engine with differentials");
  add("differential", one_of({"open", "locked"}), "Of the axles, with an engine");
  add("gravity", "m/s2", "Where its springs carry it; the Earth's by default");
  command->add_option("--source", options->sources, "Where the numbers come from; may be repeated")->type_name("TEXT");
  add_named(*command, "--out", options->out, kFile, "Vehicle file; by default NAME.json");
  add_examples(
      *command,
      {"gonogo vehicle new buggy --mass 700 --axles 2 --wheelbase 2.1 --track 1.3 --tyre 26x9-12 --power 50 \\\n"
       "      --top-speed 95 --clearance 0.3",
       "gonogo vehicle new my_truck   # asks at a terminal"});
  command->callback([&globals, options] { make(globals, *options); });
}

}  // namespace gonogo::app
