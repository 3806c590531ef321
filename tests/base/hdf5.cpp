#include "base/hdf5/hdf5.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/files/file.h"
#include "tests/fuzz/mutate.h"
#include "tests/support/catch.h"

using namespace gonogo;
namespace fs = std::filesystem;

namespace {

const fs::path kSource = GONOGO_SOURCE_DIR;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("gonogo-hdf5-" + std::to_string(::getpid()));
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
};

Hdf5Writer sample() {
  Hdf5Writer out;
  out.array("state/velocity", std::vector<double>{0.1, -0.0, 1e-310, std::nan(""), 5, 6}, {2, 3});
  out.array("state/mass", std::vector<float>{1.5f, std::numeric_limits<float>::denorm_min()});
  out.array("state/pair", std::vector<std::int32_t>{-1, 2147483647});
  out.array("count", std::vector<std::int64_t>{std::numeric_limits<std::int64_t>::min()});
  out.array("seed", std::vector<std::uint64_t>{std::numeric_limits<std::uint64_t>::max()});
  out.array("flags", std::vector<std::uint8_t>{0, 255});
  out.array("key", std::vector<std::uint32_t>{4294967295u});
  out.array("none", std::vector<double>{}, {0, 3});
  out.text("study", std::string(200000, 'x') + " \xC2\xB0");
  out.texts("names", {"go", "", "no_go"});
  out.attribute("", "version", "0.1.0");
  out.attribute("state/velocity", "unit", "m/s");
  out.attribute("state/velocity", "range", std::vector<double>{-1, 1});
  out.attribute("state", "step", std::int64_t(7));
  out.attribute("state", "time", 0.25);
  out.attribute("names", "codes", std::vector<std::int64_t>{1, 2, 3});
  out.attribute("names", "labels", std::vector<std::string>{"a", "b c"});
  return out;
}

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no InputError";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("hdf5: every kind of content comes back bit for bit") {
  const Folder folder;
  const fs::path path = folder.path / "deep" / "a.h5";
  sample().save(path);
  const Hdf5Reader in(path);

  const std::vector<double> velocity = in.array<double>("state/velocity", Shape{2, 3});
  const double expected[] = {0.1, -0.0, 1e-310, std::nan(""), 5, 6};
  CHECK(std::memcmp(velocity.data(), expected, sizeof expected) == 0);
  CHECK(in.array<float>("/state/mass")[1] == std::numeric_limits<float>::denorm_min());
  CHECK(in.array<std::int32_t>("state/pair") == std::vector<std::int32_t>{-1, 2147483647});
  CHECK(in.array<std::int64_t>("count")[0] == std::numeric_limits<std::int64_t>::min());
  CHECK(in.array<std::uint64_t>("seed")[0] == std::numeric_limits<std::uint64_t>::max());
  CHECK(in.array<std::uint8_t>("flags") == std::vector<std::uint8_t>{0, 255});
  CHECK(in.array<std::uint32_t>("key")[0] == 4294967295u);
  CHECK(in.array<double>("none").empty());
  CHECK(in.shape("none") == Shape{0, 3});
  CHECK(in.text("study") == std::string(200000, 'x') + " \xC2\xB0");
  CHECK(in.texts("names") == std::vector<std::string>{"go", "", "no_go"});
  CHECK(in.text_attribute("", "version") == "0.1.0");
  CHECK(in.text_attribute("state/velocity", "unit") == "m/s");
  CHECK(in.numbers_attribute("state/velocity", "range") == std::vector<double>{-1, 1});
  CHECK(in.integer_attribute("state", "step") == 7);
  CHECK(in.number_attribute("state", "time") == 0.25);
  CHECK(in.integers_attribute("names", "codes") == std::vector<std::int64_t>{1, 2, 3});
  CHECK(in.texts_attribute("names", "labels") == std::vector<std::string>{"a", "b c"});
  CHECK(in.members("state") == std::vector<std::string>{"mass", "pair", "velocity"});
  CHECK(in.has("state/mass"));
  CHECK_FALSE(in.has("state/mass/below"));
  CHECK_FALSE(in.has("elsewhere/mass"));
  CHECK_FALSE(in.has_attribute("state", "unit"));
}

TEST_CASE("hdf5: same content gives the same bytes, now and a second later") {
  const std::string first = sample().image();
  ::usleep(1100000);
  CHECK(sample().image() == first);
  Hdf5Writer other = sample();
  other.array("one_more", std::vector<double>{1});
  CHECK(other.image() != first);
}

TEST_CASE("hdf5: messages name file, place and what is wrong") {
  const Folder folder;
  const fs::path path = folder.path / "a.h5";
  sample().save(path);
  const Hdf5Reader in(path);
  const auto names_place = [&](const std::string& text, const std::string& place) {
    return contains(text, path.string()) && contains(text, place);
  };
  CHECK(names_place(message_of([&] { in.array<double>("state/speed"); }), "state/speed"));
  const std::string type = message_of([&] { in.array<float>("state/velocity"); });
  CHECK(names_place(type, "state/velocity"));
  CHECK(contains(type, "64-bit numbers, 32-bit numbers are needed"));
  CHECK(contains(message_of([&] { in.array<std::int64_t>("seed"); }), "unsigned integers"));
  CHECK(contains(message_of([&] { in.array<double>("state/velocity", Shape{3, 2}); }), "2 x 3, 3 x 2 is needed"));
  CHECK(contains(message_of([&] { in.array<double>("state"); }), "not a readable array"));
  CHECK(contains(message_of([&] { in.text("names"); }), "scalar is needed"));
  CHECK(contains(message_of([&] { in.text("seed"); }), "text of variable length is needed"));
  CHECK(contains(message_of([&] { in.text_attribute("state", "unit"); }), "state:unit"));
  CHECK(contains(message_of([&] { in.members("flow"); }), "missing"));
}

TEST_CASE("hdf5: files that are missing, foreign or cut short at any length are refused") {
  const Folder folder;
  CHECK(contains(message_of([&] { Hdf5Reader(folder.path / "no.h5"); }), "no such file"));
  CHECK(contains(message_of([&] { Hdf5Reader{folder.path}; }), "is a folder"));
  const fs::path path = folder.path / "cut.h5";
  write_file_atomically(path, "distance,speed\n1,2\n");
  CHECK(contains(message_of([&] { Hdf5Reader{path}; }), path.string()));

  Hdf5Writer small;
  small.array("a", std::vector<double>{1, 2, 3});
  const std::string whole = small.image();
  REQUIRE(whole.size() < 10000);
  for (std::size_t length = 0; length < whole.rfind("\ngonogo seal"); length += 7) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, length);
    CAPTURE(length);
    CHECK(contains(message_of([&] { Hdf5Reader{path}; }), "cut short"));
  }
}

TEST_CASE("hdf5: one changed byte anywhere in the content is noticed") {
  const Folder folder;
  const fs::path path = folder.path / "damaged.h5";
  Hdf5Writer small;
  small.array("group/a", std::vector<double>{1, 2, 3});
  const std::string whole = small.image();
  const std::size_t seal = whole.rfind("\ngonogo seal");
  REQUIRE(seal != std::string::npos);
  for (std::size_t at = 0; at < seal; ++at) {
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ 1);
    std::ofstream(path, std::ios::binary) << bytes;
    CAPTURE(at);
    CHECK(contains(message_of([&] { Hdf5Reader{path}; }), "is damaged"));
  }
}

TEST_CASE("hdf5: a seal that is itself damaged or cut off in part does not make a file one of another program") {
  const Folder folder;
  const fs::path path = folder.path / "damaged.h5";
  Hdf5Writer small;
  small.array("a", std::vector<double>{1, 2, 3});
  const std::string whole = small.image();
  const std::size_t seal = whole.rfind("\ngonogo seal");
  for (std::size_t at = seal; at < whole.size(); ++at) {
    CAPTURE(at);
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ 1);
    write_file_atomically(path, bytes);
    CHECK(contains(message_of([&] { Hdf5Reader{path}; }), "is damaged"));
    if (at == seal) continue;
    write_file_atomically(path, std::string_view(whole).substr(0, at));
    CHECK(contains(message_of([&] { Hdf5Reader{path}; }), "is damaged"));
  }
}

TEST_CASE("hdf5: files of other programs, without a seal, are read") {
  const Folder folder;
  const std::string whole = sample().image();
  write_file_atomically(folder.path / "b.h5", std::string_view(whole).substr(0, whole.rfind("\ngonogo seal")));
  CHECK(Hdf5Reader(folder.path / "b.h5").array<float>("state/mass")[0] == 1.5f);
}

TEST_CASE("hdf5: content that makes no sense is refused while writing") {
  Hdf5Writer out;
  out.array("a", std::vector<double>{1, 2});
  CHECK_THROWS_AS(out.array("a", std::vector<double>{1}), InputError);
  CHECK_THROWS_AS(out.array("b", std::vector<double>{1, 2, 3}, {2, 2}), InputError);
  CHECK_THROWS_AS(out.array("a/b", std::vector<double>{1}), InputError);
  CHECK_THROWS_AS(out.attribute("missing", "unit", "m"), InputError);
  CHECK_THROWS_AS(out.text("t", std::string("a\0b", 3)), InputError);
}

TEST_CASE("hdf5: what h5py writes is read where this program knows the kind, and refused by name elsewhere") {
  const fs::path path = kSource / "tests/data/hdf5/by_h5py.h5";  // made by make.py beside it
  const Hdf5Reader in(path);
  CHECK(in.path() == path);
  CHECK(in.array<double>("plain", Shape{2, 3}) == std::vector<double>{0, 1, 2, 3, 4, 5});
  CHECK(in.array<double>("alias") == in.array<double>("plain"));
  CHECK(in.array<double>("soft") == in.array<double>("plain"));
  CHECK(in.array<double>("big_endian") == std::vector<double>{0, 1, 2, 3});
  const auto packed = in.array<double>("packed", Shape{1000});
  for (std::size_t k = 0; k < packed.size(); ++k) REQUIRE(packed[k] == double(k));
  CHECK(in.texts("words") == std::vector<std::string>{"a", "", "\u00b0"});
  CHECK(in.text("word") == "one");
  CHECK(in.shape("empty") == Shape{0, 3});
  CHECK(in.array<std::int32_t>("group/inner") == std::vector<std::int32_t>{7});
  CHECK(in.number_attribute("group", "time") == 0.25);
  CHECK(in.text_attribute("plain", "unit") == "m/s");
  CHECK(in.integer_attribute("plain", "count") == 5);
  CHECK(in.numbers_attribute("plain", "range") == std::vector<double>{-1, 1});
  CHECK(in.texts_attribute("", "names") == std::vector<std::string>{"x", "y"});

  const auto refusal = [&](const std::string& name) {
    CHECK(in.has(name));
    const std::string message = message_of([&] { in.array<double>(name); });
    CHECK(contains(message, path.string() + ": "));
    CHECK(contains(message, name));
    return message;
  };
  CHECK(contains(refusal("short"), "16-bit signed integers"));
  CHECK(contains(refusal("flag"), "another kind"));
  CHECK(contains(refusal("complex"), "another kind"));
  CHECK(contains(refusal("fixed"), "holds text"));
  CHECK(contains(refusal("nothing"), "holds no value"));
  CHECK(contains(refusal("outside"), "another file, which is not opened"));
  for (const char* link : {"dangling", "elsewhere", "through"}) CHECK(contains(refusal(link), "lies in another file"));
  CHECK(contains(refusal("huge"), "no memory holds"));
  CHECK(contains(message_of([&] { in.integer_attribute("plain", "small"); }), "16-bit signed integers"));
  CHECK(contains(message_of([&] { in.text_attribute("plain", "fixed"); }), "holds text"));
  CHECK(contains(message_of([&] { in.numbers_attribute("plain", "matrix"); }), "2 x 2"));
}

TEST_CASE("hdf5: a group within itself ends in a sentence") {
  const fs::path path = kSource / "tests/data/hdf5/group_in_itself.h5";
  CHECK(contains(message_of([&] { Hdf5Reader{path}; }), "a group lies in itself"));
}

TEST_CASE("hdf5: files of other programs that crash the library or never end are refused") {
  const Folder folder;
  const fs::path path = folder.path / "a.h5";
  const std::string sealed = sample().image(), whole = sealed.substr(0, sealed.rfind("\ngonogo seal"));
  set_foreign_time(std::chrono::milliseconds(300));
  int refused = 0;
  for (std::uint64_t number = 0; number < 100; ++number) {
    write_file_atomically(path, fuzz::mutated(whole, number).bytes);
    CAPTURE(number);
    const auto start = std::chrono::steady_clock::now();
    const std::string message = message_of([&] { Hdf5Reader{path}; });
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
    refused += message != "no InputError";
    CHECK(message.find('\n') == std::string::npos);
  }
  CHECK(refused > 30);
  set_foreign_time(std::chrono::seconds(10));
}
