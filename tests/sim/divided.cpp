// Worlds divided over ranks in threads of this process; divided_mpi.cpp does the same with processes.
#include "sim/simulation/parts/divided.h"

#include <atomic>
#include <filesystem>

#include "base/files/file.h"
#include "base/ranks/ranks.h"
#include "sim/io/checkpoint.h"
#include "sim/io/part_files.h"
#include "sim/simulation/layout/memory.h"
#include "sim/simulation/layout/part.h"
#include "sim/simulation/parts/part_lists.h"
#include "tests/sim/divided_scenes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

namespace fs = std::filesystem;

constexpr Index kSteps = 200;

std::string in_one_piece(const DividedScene& scene, Index steps, Backend backend = Backend::cpu) {
  const auto simulation = make_simulation(backend, {scene.world}, scene.settings, 1);
  take_steps(*simulation, scene, 0, steps);
  CHECK(simulation->report(0).flags == 0);
  return all_bytes(*simulation, scene);
}

/// What each rank says. Ranks beyond the number of GPUs share them.
std::vector<std::string> divided(const DividedScene& scene, Index steps, int count, Backend backend = Backend::cpu) {
  std::vector<std::string> bytes(static_cast<std::size_t>(count));
  run_in_threads(count, [&](Ranks& ranks) {
    if (backend == Backend::cuda) use_cuda_device(ranks.rank() % int(cuda_device_names().size()));
    const auto simulation = make_divided_simulation(backend, scene.world, scene.settings, 1, ranks);
    take_steps(*simulation, scene, 0, steps);
    bytes[std::size_t(ranks.rank())] = all_bytes(*simulation, scene);
  });
  return bytes;
}

}  // namespace

TEST_CASE("a world divided over one to four ranks has the bits of one in one piece") {
  for (const char* name : {"tank", "wheel", "wheel-substeps", "mixing"}) {
    const DividedScene scene = divided_scene(name);
    for (const Backend backend : backends()) {
      const std::string whole = in_one_piece(scene, kSteps, backend);
      for (const int count : {1, 2, 3, 4})
        for (const std::string& part : divided(scene, kSteps, count, backend)) {
          INFO(name << " over " << count << " on " << name_of(backend));
          CHECK(part == whole);
        }
    }
  }
}

TEST_CASE("a snapshot of a divided world is that of one in one piece, and continues over any number of ranks") {
  const DividedScene scene = divided_scene("wheel");
  constexpr Index kHalf = 40;
  const auto through = make_simulation(Backend::cpu, {scene.world}, scene.settings, 1);
  take_steps(*through, scene, 0, kHalf);
  const Snapshot half = through->snapshot(0);
  take_steps(*through, scene, kHalf, kHalf);
  const std::string expected = all_bytes(*through, scene);
  run_in_threads(3, [&](Ranks& ranks) {
    const auto simulation = make_divided_simulation(Backend::cpu, scene.world, scene.settings, 1, ranks);
    take_steps(*simulation, scene, 0, 7);
    simulation->restore(0, half);
    take_steps(*simulation, scene, kHalf, kHalf);
    const std::string bytes = all_bytes(*simulation, scene);
    if (ranks.rank() == 1 && bytes != expected) throw DeviceError("other bits");
  });
}

TEST_CASE("a checkpoint by parts continues over any number of ranks with the bits of a world in one piece") {
  const DividedScene scene = divided_scene("wheel");
  constexpr Index kHalf = 40;
  const std::string hash = scene_hash(scene.world, scene.settings), expected = in_one_piece(scene, 2 * kHalf);
  const auto rest = [&](Simulation& simulation, const Snapshot& half) {
    simulation.restore(0, half);
    take_steps(simulation, scene, kHalf, kHalf);
    return all_bytes(simulation, scene);
  };
  for (const int writers : {1, 2, 3}) {
    const TemporaryFolder folder;
    run_in_threads(writers, [&](Ranks& ranks) {
      const auto simulation = make_divided_simulation(Backend::cpu, scene.world, scene.settings, 1, ranks);
      for (const Index steps : {kHalf / 2, kHalf / 2}) {
        take_steps(*simulation, scene, simulation->snapshot(0).steps, steps);
        save_checkpoint_by_parts(folder / "half.h5", *in_parts(*simulation), hash, ranks.rank() == 0);
      }
    });
    CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1 + writers);
    const Snapshot half = read_parts(Hdf5Reader(folder / "half.h5"), hash);
    CHECK(half.steps == kHalf);
    CHECK(rest(*make_simulation(Backend::cpu, {scene.world}, scene.settings, 1), half) == expected);
    for (const int readers : {2, 3}) {
      CAPTURE(writers, readers);
      CHECK(rest(*make_team_simulation(Backend::cpu, scene.world, scene.settings, readers), half) == expected);
    }
  }
}

TEST_CASE("parts that no checkpoint names do not count and those that are missing or of another time are refused") {
  const TemporaryFolder folder;
  const fs::path file = folder / "trial.h5";
  const DividedScene scene = divided_scene("tank");
  const std::string hash = scene_hash(scene.world, scene.settings);
  const auto team = make_team_simulation(Backend::cpu, scene.world, scene.settings, 2);
  InParts& parts = *in_parts(*team);
  CHECK(in_parts(*make_simulation(Backend::cpu, {scene.world}, scene.settings, 1)) == nullptr);
  team->advance(10);
  save_checkpoint_by_parts(file, parts, hash, true);
  team->advance(10);
  const std::vector<std::string> later = write_parts(file, parts, hash);  // and here it was killed
  CHECK(read_parts(Hdf5Reader(file), hash).steps == 10);
  for (const char* other : {"trial.h5.part0", "trial.h5.notes.part1", "other.h5"})
    write_file_atomically(folder / other, "kept");
  CHECK(contains(input_error([&] { read_parts(Hdf5Reader(file), "another"); }), "belongs to another scene"));
  const std::vector<std::string> named = Hdf5Reader(file).texts("parts/file");
  REQUIRE((named.size() == 2 && later.size() == 2 && named[1] != later[1]));
  fs::copy_file(folder / later[1], folder / named[1], fs::copy_options::overwrite_existing);
  CHECK(contains(input_error([&] { read_parts(Hdf5Reader(file), hash); }), "is another part than "));
  remove_parts_but(named, file);
  for (const std::string& name : later) CHECK_FALSE(fs::exists(folder / name));
  for (const char* other : {"trial.h5", "trial.h5.part0", "trial.h5.notes.part1", "other.h5"})
    CHECK(fs::exists(folder / other));
  CHECK((fs::exists(folder / named[0]) && fs::exists(folder / named[1])));
  fs::remove(folder / named[1]);
  CHECK(contains(input_error([&] { read_parts(Hdf5Reader(file), hash); }), named[1]));
}

TEST_CASE("bodies that are set, laws and motors that change act in all parts") {
  DividedScene scene = divided_scene("wheel");
  const auto change = [](Simulation& simulation, Index step) {
    if (step == 10) simulation.set_motor(0, 0, 6, 50);
    if (step == 12) simulation.set_law(0, 0, 1, {Real(0.3), Real(0.05), 0});
    if (step != 15) return;
    BodyState far = simulation.body(0, 30);
    far.position = {0.05, 0.3, 0.6};
    simulation.set_bodies(0, {30, 31}, {far, simulation.body(0, 31)});
  };
  scene.drive = change;
  const std::string whole = in_one_piece(scene, 40);
  for (const std::string& part : divided(scene, 40, 3)) CHECK(part == whole);
}

TEST_CASE("what a divided world cannot do is refused in one sentence") {
  const DividedScene scene = divided_scene("wheel");
  LoneRank ranks;
  StepSettings settings = scene.settings;
  settings.iteration = Iteration::gauss_seidel;
  CHECK(input_error([&] { make_divided_simulation(Backend::cpu, scene.world, settings, 1, ranks); }) ==
        "a world cannot be divided for the method gauss_seidel; use apgd or jacobi, or one rank");
}

TEST_CASE("a rank that fails ends the others, and its own trouble is reported") {
  const auto work = [](Ranks& ranks) {
    if (ranks.rank() == 2) throw DeviceError("the third is lost");
    joined(ranks, std::vector<int>{1});
  };
  CHECK_THROWS_WITH(run_in_threads(3, work), "the third is lost");
}

TEST_CASE("a part that fails in the middle of a step ends the others with its sentence") {
  /// Ranks of which the second loses its device.
  struct Losing final : Ranks {
    explicit Losing(Ranks& of) : all(of) {}
    int rank() const override { return all.rank(); }
    int count() const override { return all.count(); }
    bool share_memory() const override { return all.share_memory(); }
    void exchange(std::span<const Letter> sent, std::span<const Letter> received) override {
      if (rank() == 1 && --left == 0) throw DeviceError("CUDA solver: the device fell off the bus");
      all.exchange(sent, received);
    }
    Ranks& all;
    int left = 400;
  };
  const DividedScene scene = divided_scene("tank");
  std::atomic<int> taken{0};
  const auto work = [&](Ranks& of) {
    Losing ranks(of);
    const auto simulation = make_divided_simulation(Backend::cpu, scene.world, scene.settings, 1, ranks);
    for (int k = 0; k < 100; ++k) {
      simulation->advance(1);
      if (ranks.rank() == 0) ++taken;
    }
  };
  CHECK_THROWS_WITH(run_in_threads(3, work), "CUDA solver: the device fell off the bus");
  CHECK(taken > 0);
  CHECK(taken < 100);
}

TEST_CASE("a team whose parts fail is over and says so again") {
  DividedScene scene = divided_scene("tank");
  scene.settings.sort_every = 10;  // then the world is divided anew
  const auto team = make_team_simulation(Backend::cpu, scene.world, scene.settings, 3);
  team->advance(5);
  {
    const PlantedMemory small(1e4);
    CHECK_THROWS_AS(team->advance(10), OutOfMemory);
  }
  CHECK_THROWS_AS(team->advance(1), OutOfMemory);
}

TEST_CASE("tiles cut by parts add up as those of one piece") {
  // Sums in floating point, so that another order would show.
  Draw draw(9);
  for (int trial = 0; trial < 200; ++trial) {
    const Index contacts = Index(draw.between(0, 2000)), parts = 1 + Index(draw.between(0, 5));
    std::vector<WorldSums> contact(static_cast<std::size_t>(contacts));
    for (WorldSums& c : contact) c.residual_square = draw.between(0, 1);
    const auto of_tile = [](const std::vector<WorldSums>& of) {
      WorldSums sum;
      for (const WorldSums& c : of) sum += c;
      return sum;
    };
    const auto add = [](WorldSums& a, const WorldSums& b) { a += b; };
    WorldSums expected;
    for (Index t = 0; t < contacts; t += kTileSize)
      add(expected, of_tile({contact.begin() + t, contact.begin() + std::min(t + kTileSize, contacts)}));
    std::vector<TileCut> cut;
    std::vector<std::vector<WorldSums>> given;
    for (Index p = 0, begin = 0; p < parts; ++p) {
      const Index end = p + 1 == parts ? contacts : begin + Index(draw.between(0, double(contacts - begin)));
      const TileCut own = cut.emplace_back(tile_cut(begin, end - begin));
      auto& list = given.emplace_back(contact.begin() + begin, contact.begin() + begin + own.head);
      for (Index t = begin + own.head; t + kTileSize <= end; t += kTileSize)
        list.push_back(of_tile({contact.begin() + t, contact.begin() + t + kTileSize}));
      list.insert(list.end(), contact.begin() + end - own.tail, contact.begin() + end);
      begin = end;
    }
    CHECK(sum_of_parts(cut, given, of_tile, add).residual_square == expected.residual_square);
  }
}

TEST_CASE("a team of threads answers as a world in one piece") {
  const DividedScene scene = divided_scene("tank");
  constexpr Index kFew = 30;
  const std::string whole = in_one_piece(scene, kFew);
  const auto team = make_team_simulation(Backend::cpu, scene.world, scene.settings, 3);
  take_steps(*team, scene, 0, kFew);
  CHECK(all_bytes(*team, scene) == whole);
  // A refusal leaves it as it was.
  CHECK(contains(input_error([&] { team->samples(0, 0, 0, 1000); }), "samples 0 to 1000 of a monitor"));
  CHECK(all_bytes(*team, scene) == whole);
}

TEST_CASE("the shares of a divided world are all of its bodies and contacts in about equal loads") {
  const DividedScene scene = divided_scene("tank");
  const auto whole = make_simulation(Backend::cpu, {scene.world}, scene.settings, 1);
  CHECK(whole->shares().empty());
  const auto team = make_team_simulation(Backend::cpu, scene.world, scene.settings, 3);
  take_steps(*team, scene, 0, 30);
  const std::vector<PartShare> shares = team->shares();
  REQUIRE(shares.size() == 3);
  Index bodies = 0, contacts = 0;
  double load = 0;
  for (const PartShare& s : shares) {
    bodies += s.bodies;
    contacts += s.contacts;
    load += s.load;
    CHECK(s.load > 0.1);
    CHECK(s.load < 0.6);
  }
  CHECK(bodies == Index(scene.world.body.size()));
  CHECK(contacts == team->report(0).contact_count);
  CHECK(load == Approx(1));
  CHECK(loads_text({{10, 30, 0.4}, {20, 40, 0.6}}) == "load of the GPUs 40 60 %");
  CHECK(shares_text({{10, 30, 0.4}, {20, 40, 0.6}}) ==
        "GPU 0: 10 bodies, 30 contacts, 40.0 % of the load; GPU 1: 20 bodies, 40 contacts, 60.0 % of the load");
}

TEST_CASE("a world takes as many GPUs as have enough bodies and are there") {
  StepSettings settings;
  CHECK(gpus_that_pay(100, settings, 8) == 1);
  CHECK(gpus_that_pay(499'999, settings, 8) == 1);
  CHECK(gpus_that_pay(1'000'000, settings, 8) == 4);
  CHECK(gpus_that_pay(1'000'000, settings, 2) == 2);
  CHECK(gpus_that_pay(50'000'000, settings, 16) == 8);
  CHECK(gpus_that_pay(50'000'000, settings, 0) == 1);
  settings.iteration = Iteration::bb;
  CHECK(gpus_that_pay(50'000'000, settings, 8) == 1);
}

TEST_CASE("a team that cannot be made says why") {
  DividedScene scene = divided_scene("tank");
  scene.settings.iteration = Iteration::bb;
  const auto make = [&] { make_team_simulation(Backend::cpu, scene.world, scene.settings, 2); };
  CHECK(contains(input_error(make), "for the method bb"));
}
