#include "doublet/files/npz.h"

#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "support/error_of.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <climits>
#include <cstdint>
#include <cstring>
#include <functional>

namespace doublet {

namespace {

using testing::error_of;
using testing::TempFolder;

/// A stored (not deflated) zip with one .npy member, made by hand: header text, then data.
std::string stored_npz(const std::string &name, const std::string &dictionary, const std::string &data) {
  std::string header = dictionary;
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  const std::string npy = std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size() & 255) +
                          static_cast<char>(header.size() >> 8) + header + data;
  std::uint32_t crc = ~0u;
  for (const unsigned char byte : npy) {
    crc ^= byte;
    for (int k = 0; k < 8; ++k)
      crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
  }
  crc = ~crc;
  const auto le = [](std::uint64_t v, int bytes) {
    std::string s;
    for (int k = 0; k < bytes; ++k)
      s += static_cast<char>(v >> (8 * k) & 255);
    return s;
  };
  const std::string common = le(20, 2) + le(0, 2) + le(0, 2) + le(0, 2) + le(0x21, 2) + le(crc, 4) + le(npy.size(), 4) +
                             le(npy.size(), 4) + le(name.size(), 2) + le(0, 2);
  const std::string local = "PK\x03\x04" + common + name + npy;
  const std::string central = "PK\x01\x02" + le(20, 2) + common + le(0, 2) + le(0, 2) + le(0, 2) + le(0, 4) + le(0, 4) + name;
  return local + central + "PK\x05\x06" + le(0, 4) + le(1, 2) + le(1, 2) + le(central.size(), 4) + le(local.size(), 4) + le(0, 2);
}

template <class T> std::string raw(const std::vector<T> &values) {
  return {reinterpret_cast<const char *>(values.data()), values.size() * sizeof(T)};
}

Npz read_text_as_npz(const TempFolder &folder, const std::string &text) {
  write_text(folder / "x.npz", text);
  return Npz::read(folder / "x.npz");
}

} // namespace

TEST(Npz, RoundTrip) {
  const TempFolder folder;
  Npz out;
  out.set_f4("f", {2, 3}, {1, 2, 3, 4, 5, 6.5});
  out.set_f8("cube", {2, 1, 2}, {0.1, 0.2, 0.3, 0.4});
  out.set_i4("i", {3}, {-1, 0, INT_MAX});
  out.set_b1("mask", {0, 1, 7});
  out.set_text("names", {"pelvis", "", "Fu\xC3\x9F", "\xE8\x86\x9D", "\xF0\x9F\xA6\xB5"});
  out.set_f4("empty", {0, 3}, {});
  out.set_text("no_names", {});
  out.write(folder / "sub/x.npz");
  const Npz in = Npz::read(folder / "sub/x.npz");
  EXPECT_EQ(in.matrix("f"), (MatrixRM(2, 3) << 1, 2, 3, 4, 5, 6.5).finished());
  EXPECT_EQ(in.values("cube"), (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(in.shape("cube"), (std::vector<std::int64_t>{2, 1, 2}));
  EXPECT_EQ(in.integers("i"), (std::vector<int>{-1, 0, INT_MAX}));
  EXPECT_EQ(in.matrix("i").cols(), 1);
  EXPECT_EQ(in.integers("mask"), (std::vector<int>{0, 1, 1}));
  EXPECT_EQ(in.text("names"), out.arrays["names"].strings);
  EXPECT_EQ(in.matrix("empty").rows(), 0);
  EXPECT_TRUE(in.text("no_names").empty());
  EXPECT_EQ(in.arrays.at("f").size(), 6);
}

TEST(Npz, SameArraysMakeTheSameBytes) {
  const TempFolder folder;
  Npz npz;
  npz.set_f4("f", {3}, {1, 2, 3});
  npz.write(folder / "a.npz");
  npz.write(folder / "b.npz");
  EXPECT_EQ(read_text(folder / "a.npz"), read_text(folder / "b.npz"));
}

TEST(Npz, ReadsEveryNumericType) {
  const TempFolder folder;
  const auto read = [&](const std::string &type, const std::string &data) {
    const Npz npz =
        read_text_as_npz(folder, stored_npz("a.npy", "{'descr': '" + type + "', 'fortran_order': False, 'shape': (2,), }", data));
    return npz.values("a");
  };
  const std::vector<double> expected = {1, 100};
  EXPECT_EQ(read("<f4", raw<float>({1, 100})), expected);
  EXPECT_EQ(read("<f8", raw<double>({1, 100})), expected);
  EXPECT_EQ(read("|i1", raw<std::int8_t>({1, 100})), expected);
  EXPECT_EQ(read("|u1", raw<std::uint8_t>({1, 100})), expected);
  EXPECT_EQ(read("<i2", raw<std::int16_t>({1, 100})), expected);
  EXPECT_EQ(read("<u2", raw<std::uint16_t>({1, 100})), expected);
  EXPECT_EQ(read("<i4", raw<std::int32_t>({1, 100})), expected);
  EXPECT_EQ(read("<u4", raw<std::uint32_t>({1, 100})), expected);
  EXPECT_EQ(read("<i8", raw<std::int64_t>({1, 100})), expected);
  EXPECT_EQ(read("<u8", raw<std::uint64_t>({1, 100})), expected);
  EXPECT_EQ(read("|b1", raw<std::uint8_t>({1, 1})), (std::vector<double>{1, 1}));
}

TEST(Npz, TurnsFortranOrderIntoCOrderAndReadsWhatIsWanted) {
  const TempFolder folder;
  const std::string header = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }";
  const Npz npz = read_text_as_npz(folder, stored_npz("a.npy", header, raw<float>({1, 4, 2, 5, 3, 6})));
  EXPECT_EQ(npz.values("a"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  Npz two;
  two.set_f8("a", {1}, {1});
  two.set_f8("b", {1}, {2});
  two.write(folder / "two.npz");
  const Npz one = Npz::read(folder / "two.npz", {"b", "c"});
  EXPECT_FALSE(one.has("a"));
  EXPECT_TRUE(one.has("b"));
  EXPECT_FALSE(one.has("c"));
}

TEST(Npz, RefusesWhatItCannotMean) {
  const TempFolder folder;
  const auto error = [&](const std::string &dictionary, const std::string &data = std::string(48, 'x')) {
    return error_of([&] { read_text_as_npz(folder, stored_npz("a.npy", dictionary, data)); });
  };
  EXPECT_EQ(error("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }"), "");
  EXPECT_NE(error("{'descr': '<U1', 'fortran_order': True, 'shape': (2, 3), }").find("array 'a': expected C order"),
            std::string::npos);
  EXPECT_EQ(error("{'descr': '<f4', 'fortran_order': True, 'shape': (3,), }"), ""); // one dimension has one order
  EXPECT_NE(error("{'descr': '>f4', 'fortran_order': False, 'shape': (3,), }").find("little-endian"), std::string::npos);
  EXPECT_NE(error("{'descr': '|O', 'fortran_order': False, 'shape': (3,), }").find("Python objects"), std::string::npos);
  EXPECT_NE(error("{'descr': '<c16', 'fortran_order': False, 'shape': (3,), }").find("'<c16'"), std::string::npos);
  EXPECT_NE(error("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,), }").find("structured"), std::string::npos);
  EXPECT_NE(error("{'descr': '<f4', 'fortran_order': False, 'shape': (13,), }").find("48 bytes"), std::string::npos);
  EXPECT_NE(error("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999), }"), "");
  EXPECT_NE(error("{'descr': '<f4', 'fortran_order': False, 'shape': (-3,), }"), "");
  EXPECT_NE(error("{'descr': '<U0', 'fortran_order': False, 'shape': (999999999999,), }"), "");
  EXPECT_NE(error("{'descr': '<U999999999', 'fortran_order': False, 'shape': (1,), }"), "");
  EXPECT_NE(error("{'descr': '<U99999999999999999999', 'fortran_order': False, 'shape': (1,), }"), "");
  EXPECT_NE(error("{'descr': '', 'fortran_order': False, 'shape': (1,), }"), "");
  EXPECT_NE(error("{'descr': '", ""), "");
  EXPECT_NE(error(""), "");
  EXPECT_NE(error_of([&] { read_text_as_npz(folder, stored_npz("readme.txt", "", "")); }).find("'readme.txt'"),
            std::string::npos);
  EXPECT_THROW(Npz::read(folder / "none.npz"), FileNotFound);
  EXPECT_NE(error_of([&] { read_text_as_npz(folder, "not a zip"); }).find("x.npz: expected an .npz"), std::string::npos);
  EXPECT_NE(error_of([&] { Npz::read(folder.path()); }), "");
}

TEST(Npz, SurvivesTruncationAndDamageEverywhere) {
  const TempFolder folder;
  Npz npz;
  npz.set_f4("f", {4, 3}, std::vector<double>(12, 0.5));
  npz.set_text("t", {"a", "bc"});
  npz.write(folder / "whole.npz");
  const std::string whole = read_text(folder / "whole.npz");
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_THROW(read_text_as_npz(folder, whole.substr(0, n)), Error) << n;
  for (std::size_t n = 0; n < whole.size(); n += 2) { // a changed byte gives an error or an archive, never a crash
    std::string damaged = whole;
    damaged[n] = static_cast<char>(damaged[n] ^ 0x5A);
    error_of([&] { read_text_as_npz(folder, damaged); });
  }
}

TEST(Npz, NamesArrayExpectationAndFinding) {
  const TempFolder folder;
  Npz npz;
  npz.source = "actor.npz";
  npz.set_f4("f", {2, 3}, std::vector<double>(6, 0));
  npz.set_text("t", {"a"});
  EXPECT_EQ(error_of([&] { npz.matrix("g"); }), "actor.npz: expected an array 'g', found only: f, t");
  EXPECT_EQ(error_of([&] { npz.require_shape("f", {-1, 4}); }), "actor.npz: array 'f': expected shape (any, 4), found (2, 3)");
  EXPECT_NO_THROW(npz.require_shape("f", {-1, 3}));
  EXPECT_EQ(error_of([&] { npz.matrix("t"); }), "actor.npz: array 't': expected numbers, found type 'U1'");
  EXPECT_EQ(error_of([&] { npz.text("f"); }), "actor.npz: array 'f': expected text, found type 'f4'");
  EXPECT_EQ(error_of([&] { npz.integers("f"); }), "actor.npz: array 'f': expected integers, found type 'f4'");
  EXPECT_THROW(npz.set_f4("f", {2, 2}, {1, 2, 3}), std::invalid_argument);
  npz.arrays["big"] = {"i8", {1}, std::vector<std::uint8_t>(8, 0x11), {}};
  EXPECT_NE(error_of([&] { npz.integers("big"); }).find("32-bit"), std::string::npos);
  npz.arrays["huge"] = {"u8", {1}, std::vector<std::uint8_t>(8, 0xFF), {}};
  EXPECT_NE(error_of([&] { npz.integers("huge"); }).find("32-bit"), std::string::npos);
}

} // namespace doublet
